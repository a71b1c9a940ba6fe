#!/usr/bin/env python3
"""How often does the gate find what it should, and what is not there?

usage: python3 scripts/gate_trial.py [--check] [--equals N] [--slowdowns N] [--errors N] [--budget S] [--row-budget S]

Equals are N comparisons of suite `ci` between two builds of this tree. Slowdowns are planted in one kernel (sh-exponentiation,
simd): when it has shaded, it waits for another 5 % or 2 % of that time; N comparisons each of its row on ci-city. Errors
are planted in what its scalar and simd code share, so that the row does not fail beside its scalar twin: the image becomes
darker by twice the floor of the row's noise (brighter is nearer to the truth here). Builds lie in build/trial, and cost
little where the compiler has a cache. Every comparison has its own seed, its number. Prints a table, and exits 1 if an
error was not called WORSE; details of every comparison go to build/trial/trials.json, which is read again: trials that
are there are not made again. --check only looks for the texts that plants replace, in this tree, and takes no time.
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
from plant import copy_tree, stale  # noqa: E402

SHADE = {"file": "techniques/sh_exponentiation/sh_exponentiation.cpp",
         "find": "  void shade(View<vec3> radiance) override {\n    begin_frame(radiance);\n    tbb::parallel_for("}
CLOCK = {"file": SHADE["file"], "find": "#include <tbb/parallel_for.h>\n",
         "replace": "#include <tbb/parallel_for.h>\n\n#include <chrono>\n"}
SLOW = """
    struct Slow {
      std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
      ~Slow() {
        const auto end = std::chrono::steady_clock::now();
        while (std::chrono::steady_clock::now() - end < (end - start) * PERCENT / 100) {}
      }
    } slow;"""
# Scalar and simd code write every channel through this. The truth of suite `ci` has a noise of 0.005, and errors a floor of
# sqrt(2) times that.
DARK = {"file": "techniques/sh_exponentiation/kernel.h", "find": "  return within;\n", "replace": "  return within * 0.986f;\n"}
ROW = "^ci-city/.*sh-exponentiation/simd/threads:1$"


def slow(percent):
    first, rest = SHADE["find"].split("\n", 1)
    return [CLOCK, {**SHADE, "replace": f"{first}{SLOW.replace('PERCENT', str(percent))}\n{rest}"}]


PLANTS = {"equal": [], "slower-5": slow(5), "slower-2": slow(2), "darker": [DARK]}


def check():
    """Is a plant's text not in this tree exactly once? Says which."""
    wrong = [f"{name}: {message}" for name, plants in PLANTS.items() for plant in plants if (message := stale(plant, ROOT))]
    for message in wrong:
        print(f"gate trial: {message}; bring {pathlib.Path(__file__).name} up to date", file=sys.stderr)
    return bool(wrong)


def plant_in(tree, name):
    for plant in PLANTS[name]:
        path = tree / plant["file"]
        path.write_text(path.read_text().replace(plant["find"], plant["replace"]))


def build(name, folder):
    """The program with a plant; built in one tree, kept outside of it."""
    program = folder / name
    tree = folder / "tree"
    copy_tree(tree)
    plant_in(tree, name)
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


def called_worse(trial):
    """Is every row a regression of its error? One that fails has no such verdict."""
    rows = trial["found"]["rows"]
    return bool(rows) and all("status" not in row and row.get("error", {}).get("verdict") == "worse" and row["error"]["regressed"]
                              for row in rows)


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
        row = of[0]["found"]["rows"][0]
        error = row.get("error")
        if "status" in row or not error:
            return row.get("status", "no error")
        return f"{error['verdict']}, {error['base']} to {error['new']} of {error['rung']}"

    def rows(of):
        count = sum(len(verdicts(trial, "time", "same")) for trial in of)
        return f"{ratios(of)}; {count} of {sum(len(trial['found']['rows']) for trial in of)} rows 'same'"

    line("equal", lambda t: bool(verdicts(t, "time", "slower", "faster") or verdicts(t, "error", "worse", "better")), rows)
    for kind in ("slower-5", "slower-2"):
        line(kind, lambda t: bool(verdicts(t, "time", "slower")), ratios)
    line("darker", called_worse, errors)
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="only look whether plants have a place")
    parser.add_argument("--equals", type=int, default=40, metavar="N")
    parser.add_argument("--slowdowns", type=int, default=20, metavar="N")
    parser.add_argument("--errors", type=int, default=3, metavar="N")
    parser.add_argument("--budget", default="4", metavar="S", help="of a row, comparing equals (default 4 s)")
    parser.add_argument("--row-budget", default="40", metavar="S", help="of the row with a plant (default 40 s)")
    options = parser.parse_args()
    stale_plants = check()
    if stale_plants or options.check:
        return stale_plants
    folder = ROOT / "build/trial"
    folder.mkdir(parents=True, exist_ok=True)
    programs = {name: build(name, folder) for name in PLANTS}
    trials = Trials(folder / "trials.json")
    one_row = ("--filter", ROW, "--budget", options.row_budget, "--fail-slower", "1%")
    for kind in ("slower-5", "slower-2"):
        trials.need(kind, options.slowdowns, lambda seed: compare(programs["equal"], programs[kind], seed, *one_row))
    trials.need("darker", options.errors, lambda seed: compare(
        programs["equal"], programs["darker"], seed, "--filter", ROW, "--budget", "1", "--fail-error", "0.1%"))
    trials.need("equal", options.equals,
                lambda seed: compare(programs["equal"], programs["equal"], seed, "--budget", options.budget))
    print(table(trials))
    missed = [trial["seed"] for trial in trials.of("darker") if not called_worse(trial)]
    if missed:
        print(f"gate trial: an error was planted and not called WORSE in comparisons {missed}", file=sys.stderr)
    return bool(missed)


if __name__ == "__main__":
    sys.exit(main())
