#!/usr/bin/env python3
"""How often does the gate find what it should, and what is not there?

usage: .venv/bin/python scripts/gate_trial.py [--equals N] [--slowdowns N] [--errors N] [--budget S] [--row-budget S]

Equals are N comparisons of suite `ci` between two builds of this tree. Slowdowns are planted in one kernel (pixel-basis, simd):
it shades 5 % or 2 % of its receivers twice; N comparisons each of its row on ci-city. Errors are planted by making its
image too bright. Builds lie in build/trial, and cost little where the compiler has a cache. Every comparison has its own
seed, its number. Prints a table; details of every comparison go to build/trial/trials.json, which is read again: trials that
are there are not made again.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests/faults"))
from plant import copy_tree  # noqa: E402

FILE = "techniques/sh_exponentiation/sh_exponentiation.cpp"
BEGIN = "  void shade(View<vec3> radiance) override {\n    begin_frame(radiance);\n    tbb::parallel_for("
SLOW = """
    struct Slow {
      std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
      ~Slow() {
        const auto end = std::chrono::steady_clock::now();
        while (std::chrono::steady_clock::now() - end < (end - start) * PERCENT / 100) {}
      }
    } slow;"""
BRIGHT = """
    struct Bright {
      View<vec3> image;
      ~Bright() { for (std::size_t i = 0; i < image.size(); ++i) image[i] *= 1.03f; }
    } bright{radiance};"""
ROW = "^ci-city/.*sh-exponentiation/simd/threads:1$"
PLANTS = {
    "equal": "",
    "slower-5": SLOW.replace("PERCENT", "5"),
    "slower-2": SLOW.replace("PERCENT", "2"),
    "brighter": BRIGHT,
}


def build(name, folder):
    """The program with a plant; built in one tree, kept outside of it."""
    program = folder / name
    tree = folder / "tree"
    copy_tree(tree)
    source = tree / FILE
    whole = source.read_text()
    if whole.count(BEGIN) != 1:
        sys.exit(f"gate trial: {FILE} has the begin of shade() not once; bring {__file__} up to date")
    first, rest = BEGIN.split("\n", 1)
    planted = whole.replace(BEGIN, f"{first}{PLANTS[name]}\n{rest}")
    source.write_text(planted.replace("#include <", "#include <chrono>\n#include <", 1))
    for command in (["cmake", "--preset", "release"], ["cmake", "--build", "--preset", "release", "--target", "penumbra"]):
        subprocess.run(command, cwd=tree, check=True, stdout=subprocess.DEVNULL)
    program.unlink(missing_ok=True)
    program.write_bytes((tree / "build/release/penumbra").read_bytes())
    program.chmod(0o755)
    return program


def compare(base, new, seed, *options):
    """The comparison as JSON, and the seconds that it took."""
    start = time.monotonic()
    command = [ROOT / "build/release/penumbra", "compare", "--ab", base, new, "ci", "--json", "--seed", str(seed), "--out", ROOT / "build/trial/out",
               *options]
    result = subprocess.run([str(word) for word in command], capture_output=True, text=True,
                            env={**os.environ, "PENUMBRA_DATA": str(ROOT / "scenes")})
    if not result.stdout:
        sys.exit(f"gate trial: {' '.join(map(str, command))}: {result.stderr[-1000:]}")
    return json.loads(result.stdout), time.monotonic() - start


class Trials:
    """What has been tried so far, on disk after every comparison."""

    def __init__(self, file):
        self.file = file
        self.made = json.loads(file.read_text()) if file.is_file() else []

    def need(self, kind, count, make):
        for seed in range(1, count + 1):
            if any(trial["kind"] == kind and trial["seed"] == seed for trial in self.made):
                continue
            found, seconds = make(seed)
            self.made.append({"kind": kind, "seed": seed, "seconds": seconds, "load": os.getloadavg()[0], "found": found})
            self.file.write_text(json.dumps(self.made))
            print(f"{kind} {seed}: {seconds:.0f} s, {found['verdict']}", file=sys.stderr, flush=True)

    def of(self, kind):
        return [trial for trial in self.made if trial["kind"] == kind]


def verdicts(trial, what, *words):
    return [row for row in trial["found"]["rows"] if row.get(what, {}).get("verdict") in words]


def table(trials):
    lines = ["| trial | comparisons | found | what was measured | s each | load |", "|---|---|---|---|---|---|"]

    def line(kind, found, measured):
        of = trials.of(kind)
        if not of:
            return
        middle = sorted(trial["seconds"] for trial in of)[len(of) // 2]
        load = sorted(trial["load"] for trial in of)[len(of) // 2]
        lines.append(f"| {kind} | {len(of)} | {sum(map(found, of))} | {measured(of)} | {middle:.0f} | {load:.1f} |")

    def ratios(of):
        all_ratios = sorted(row["time"]["ratio"] for trial in of for row in trial["found"]["rows"])
        return f"ratio {all_ratios[0]:.3f} to {all_ratios[-1]:.3f}, median {all_ratios[len(all_ratios) // 2]:.3f}"

    def errors(of):
        return of[0]["found"]["rows"][0].get("status") or "error"

    def rows(of):
        count = sum(len(verdicts(trial, "time", "same")) for trial in of)
        return f"{ratios(of)}; {count} of {sum(len(trial['found']['rows']) for trial in of)} rows 'same'"

    line("equal", lambda t: bool(verdicts(t, "time", "slower", "faster") or verdicts(t, "error", "worse", "better")), rows)
    for kind in ("slower-5", "slower-2"):
        line(kind, lambda t: bool(verdicts(t, "time", "slower")), ratios)
    line("brighter", lambda t: t["found"]["exit_code"] == 1, errors)
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--equals", type=int, default=40, metavar="N")
    parser.add_argument("--slowdowns", type=int, default=20, metavar="N")
    parser.add_argument("--errors", type=int, default=3, metavar="N")
    parser.add_argument("--budget", default="4", metavar="S", help="of a row, comparing equals (default 4 s)")
    parser.add_argument("--row-budget", default="40", metavar="S", help="of the row with a plant (default 40 s)")
    options = parser.parse_args()
    folder = ROOT / "build/trial"
    folder.mkdir(parents=True, exist_ok=True)
    programs = {name: build(name, folder) for name in PLANTS}
    trials = Trials(folder / "trials.json")
    one_row = ("--filter", ROW, "--budget", options.row_budget, "--fail-slower", "1%")
    for kind in ("slower-5", "slower-2"):
        trials.need(kind, options.slowdowns, lambda seed: compare(programs["equal"], programs[kind], seed, *one_row))
    trials.need("brighter", options.errors, lambda seed: compare(
        programs["equal"], programs["brighter"], seed, "--filter", ROW, "--budget", "1"))
    trials.need("equal", options.equals,
                lambda seed: compare(programs["equal"], programs["equal"], seed, "--budget", options.budget))
    print(table(trials))


if __name__ == "__main__":
    main()
