#!/usr/bin/env python3
"""Counts the instructions and cache lines that every kernel takes, and compares them with results/baseline/counts.csv.

    scripts/instruction_counts.py                              count and compare (minutes)
    scripts/instruction_counts.py --renew --why "one line"     count and write the baseline
    scripts/instruction_counts.py --counts A.csv --baseline B.csv

Callgrind simulates one processor with fixed caches, so noise and the machine do not matter; docs/kernel-counts.md says what
is counted. Exit code 0: nothing grew beyond the tolerances, 1: a kernel did or is gone, 2: wrong input, or an output that
cannot be written, 3: the counts cannot be compared (another compiler, library or valgrind than the baseline's).
"""
import argparse
import collections
import csv
import json
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
import traceback
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
KEY = ["technique", "backend", "light", "way", "stage"]
COUNTS = ["instructions", "reads", "writes", "lines", "d1_misses"]
CONTEXT = ["compiler", "flags", "instruction set", "libraries", "valgrind", "caches"]
# Bytes, ways, bytes of a line. The last level is larger than what a stage touches: what misses it are the lines touched.
CACHES = {"I1": "32768,8,64", "D1": "32768,8,64", "LL": "268435456,16,64"}
# All memory from one heap that never shrinks: else an earlier allocation decides which pages a later one touches.
HEAP = "glibc.malloc.mmap_threshold=1073741824:glibc.malloc.trim_threshold=4294967296:glibc.malloc.top_pad=67108864"
SCENES = ["environment.toml", "area.toml"]
MOST_LINES = 20
FEWEST_COLUMNS = 20

Counted = collections.namedtuple("Counted", "context rows")  # rows: {key: {count: number}}
Change = collections.namedtuple("Change", "key count ratio")


class Stop(Exception):
    """Ends the program with an exit code and a message."""

    def __init__(self, code, message):
        super().__init__(message)
        self.code = code


def plain(text):
    """The text without what moves a terminal's cursor: such characters as they would be written in code."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


# --- counting --------------------------------------------------------------------------------------------------------


def built_program():
    """The program of this tree, up to date."""
    done = subprocess.run(["cmake", "--build", "--preset", "release", "--target", "instruction_counts"], cwd=ROOT,
                          capture_output=True, text=True)
    if done.returncode:
        raise Stop(2, f"instruction_counts does not build. Run scripts/setup.sh and `cmake --preset release "
                      f"-DPENUMBRA_TESTS=ON`.\n{(done.stdout + done.stderr)[-2000:]}")
    return ROOT / "build/release/instruction_counts"


def read_dump(path):
    """(variant, stage, {count: number}) of one of callgrind's files; None of one that no stage asked for."""
    trigger, events = None, None
    with open(path, encoding="utf-8", errors="replace") as file:
        for line in file:
            if match := re.match(r"desc: Trigger: Client Request: (\d+) (.*)", line):
                trigger = match[1], match[2].strip()
            elif line.startswith("events:"):
                events = line.split()[1:]
            elif line.startswith(("summary:", "totals:")) and trigger:
                e = dict(zip(events, map(int, line.split()[1:])))
                e = collections.defaultdict(int, e)  # the last ones are left out where they are 0
                return *trigger, {"instructions": e["Ir"], "reads": e["Dr"], "writes": e["Dw"],
                                  "lines": e["DLmr"] + e["DLmw"], "d1_misses": e["D1mr"] + e["D1mw"]}
    return None


def count(program, jobs, only=()):
    """Runs the program under callgrind, on all variants or those that have one of these texts in theirs."""
    if not shutil.which("valgrind"):
        raise Stop(3, "valgrind is not installed: nothing is counted")
    with tempfile.TemporaryDirectory(prefix="penumbra-counts-") as folder:
        caches = [f"--{cache}={geometry}" for cache, geometry in CACHES.items()]
        command = ["valgrind", "-q", "--tool=callgrind", "--instr-atstart=no", "--cache-sim=yes", *caches,
                   f"--callgrind-out-file={folder}/out.%p", program, "--jobs", str(jobs)]
        # Few variables, always the same: they lie on the stack, whose place decides what shares a cache line.
        done = subprocess.run([*command, *(word for text in only for word in ("--only", text)), *SCENES], cwd=ROOT / "tests/counts",
                              env={"PATH": "/usr/local/bin:/usr/bin:/bin", "LC_ALL": "C", "GLIBC_TUNABLES": HEAP},
                              capture_output=True, text=True)
        if done.returncode:
            raise Stop(3 if done.returncode == 3 else 2, f"the program ended with exit code {done.returncode}\n"
                       + done.stderr[-2000:])
        dumps = [dump for path in Path(folder).iterdir() if (dump := read_dump(path))]
    said, variants = read_said(program, done.stdout)
    valgrind = subprocess.run(["valgrind", "--version"], capture_output=True, text=True, check=True).stdout.strip()
    context = {**said, "valgrind": valgrind, "caches": " ".join(f"{c} {g}" for c, g in CACHES.items())}
    rows = {}
    for number, stage, counts in dumps:
        if number in variants:
            rows[tuple({**variants[number], "stage": stage}[k] for k in KEY)] = counts
    missing = len(variants) - len({key[:-1] for key in rows if key[-1] == "shade"})
    if missing or not rows:
        raise Stop(2, f"callgrind did not count {missing} of {len(variants)} variants")
    return Counted(context, dict(sorted(rows.items())))


def read_said(program, text):
    """Context and variants that the program printed. Stops with 2 where it is another program."""
    try:
        said = json.loads(text)
        context, variants = said["context"], said["variants"]
        if not set(CONTEXT) - {"valgrind", "caches"} <= context.keys() or \
           not all(set(KEY) - {"stage"} <= variant.keys() for variant in variants.values()):
            raise KeyError
    except (ValueError, KeyError, TypeError, AttributeError):
        raise Stop(2, f"{program} did not print what it counted; "
                      "--program must be instruction_counts of a build") from None
    return context, variants


# --- files -----------------------------------------------------------------------------------------------------------


def make_folder(path):
    """The folder of a file that is to be written, made if it alone is missing: a slip in a path must not make a tree, nor
    anything in the root of the file system. Asked before minutes are spent on counting."""
    folder = path.absolute().parent
    if not folder.exists() and (not folder.parent.is_dir() or folder.parent == Path(folder.anchor)):
        raise Stop(2, f"{path}: there is no folder {folder}")
    folder.mkdir(exist_ok=True)


def write(path, counted, why):
    make_folder(path)
    with open(path, "w", encoding="utf-8", newline="") as file:
        for name, value in {"why": why, **{name: counted.context[name] for name in CONTEXT}}.items():
            file.write(f"# {name}: {value}\n")
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(KEY + COUNTS)
        for key, counts in counted.rows.items():
            writer.writerow([*key, *(counts[name] for name in COUNTS)])


def read_row(line):
    """Key and counts of a line; no counts if it is wrong."""
    try:
        fields = next(csv.reader([line], strict=True), [])
    except csv.Error:
        fields = []
    key, numbers = tuple(fields[:len(KEY)]), fields[len(KEY):]
    good = len(numbers) == len(COUNTS) and all(re.fullmatch(r"[0-9]{1,18}", n) for n in numbers)
    return key, dict(zip(COUNTS, map(int, numbers))) if good else {}


def read(path):
    """Counts of a file. Stops with 2 where it is not one of ours, whole."""
    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise Stop(2, f"{path}: {error}") from error
    context = dict(re.findall(r"^# ([^:]+): (.*)$", text, re.MULTILINE))
    lines = enumerate(text.removesuffix("\n").split("\n"), 1)
    table = [(number, line) for number, line in lines if not line.startswith("#")]
    if not table or table[0][1] != ",".join(KEY + COUNTS) or not set(CONTEXT) <= set(context):
        raise Stop(2, f"{path}: no file of instruction counts; it would begin with # {CONTEXT[0]}: ... and have the "
                      f"columns {','.join(KEY + COUNTS)}")
    rows = {}
    for number, line in table[1:]:
        key, counts = read_row(line)
        if not counts or key in rows:
            what = "twice there" if counts else "wrong" if line else "empty"
            raise Stop(2, f"{path}, line {number}: {what}{': ' if line else ''}{line[:200]}")
        rows[key] = counts
    if not rows:
        raise Stop(2, f"{path}: no counts")
    return Counted({name: context[name] for name in CONTEXT}, rows)


# --- comparison ------------------------------------------------------------------------------------------------------


def worst_change(key, before, after, tolerances, few):
    """The count of a row that grew most beyond its tolerance, or else fell most; None if none did."""
    changes = []
    for name in COUNTS:
        old, new = before[name], after[name]
        # Where a tree is built, its memory decides about a thousand instructions.
        slack = few + (1200 if name == "instructions" and key[KEY.index("stage")] == "new shape" else 0)
        if abs(new - old) > tolerances[name] * old + slack:
            changes.append(Change(key, name, new / old if old else math.inf))
    grown = [change for change in changes if change.ratio > 1]
    return max(grown, key=lambda c: c.ratio) if grown else min(changes, key=lambda c: c.ratio, default=None)


def described(key):
    technique, backend, light, way, stage = key
    return plain(f"{technique} {backend}, {light}, {stage}" + (f", {way}" if way else ""))


def fitted(lines, columns):
    """At most MOST_LINES lines less one for the sum, none wider than the screen."""
    room = MOST_LINES - 1
    if len(lines) > room:
        lines = [*lines[:room - 1], f"... and {len(lines) - room + 1} more"]
    return [line if len(line) <= columns else line[:columns - 3] + "..." for line in lines]


def compare(base, new, tolerances, few):
    """Lines to print, worst first, and the exit code."""
    common = base.rows.keys() & new.rows.keys()
    if not common:
        raise Stop(2, "the two have no kernel in common")
    changes = [c for k in common if (c := worst_change(k, base.rows[k], new.rows[k], tolerances, few))]
    changes.sort(key=lambda c: (-c.ratio, c.key))
    grown, fallen = [c for c in changes if c.ratio > 1], [c for c in changes if c.ratio < 1]
    gone, added = sorted(base.rows.keys() - common), sorted(new.rows.keys() - common)
    show = [f"{f'{100 * (c.ratio - 1):+.2f} %':>10} {c.count:12} {described(c.key)}" for c in grown]
    show += [f"{'gone':>10} {'':12} {described(key)}" for key in gone]
    show += [f"{'new':>10} {'':12} {described(key)}" for key in added]
    show += [f"{f'{100 * (c.ratio - 1):+.2f} %':>10} {c.count:12} {described(c.key)}" for c in reversed(fallen)]
    columns = max(FEWEST_COLUMNS, shutil.get_terminal_size((80, 24)).columns)
    lines = fitted(show, columns)
    total = f"{len(common)} kernels: {len(grown)} grew, {len(fallen)} fell, {len(added)} new, {len(gone)} gone"
    if not grown and not gone and (fallen or added):
        total += "; --renew keeps it"
    return lines + fitted([total], columns), 1 if grown or gone else 0


def differences(base, new):
    """What the counts depend on and differs: they are then about something else."""
    return [f"  {name}: {base.context[name]} in the baseline, {new.context[name]} here" for name in CONTEXT
            if base.context[name] != new.context[name]]


# --- the command -----------------------------------------------------------------------------------------------------


def renew(options, new):
    write(options.baseline, new, options.why)
    shown = options.baseline.resolve()
    shown = shown.relative_to(ROOT) if shown.is_relative_to(ROOT) else shown
    print(f"{shown}: {len(new.rows)} kernels. Commit it with the reason:")
    quoted = options.why.replace("'", "'\\''")
    print(f"  git commit {shown} -m 'Counts of kernels renewed: {quoted}'")
    return 0


def percentage(text):
    value = float(text.rstrip("% "))
    if not 0 <= value < math.inf:
        raise argparse.ArgumentTypeError(f"{text}: give a percentage of 0 or more")
    return value / 100


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--baseline", type=Path, default=ROOT / "results/baseline/counts.csv", metavar="FILE")
    parser.add_argument("--counts", type=Path, metavar="FILE", help="compare these; count nothing")
    parser.add_argument("--save", type=Path, metavar="FILE", help="keep the new counts there")
    parser.add_argument("--program", type=Path, help="default: instruction_counts of build/release, brought up to date")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), metavar="N")
    parser.add_argument("--fail-instructions", type=percentage, default="0.5%", metavar="PERCENT")
    parser.add_argument("--fail-lines", type=percentage, default="2%", metavar="PERCENT",
                        help="of reads and writes")
    # Where data happen to lie moves these two: by 11 % and 30 % when the same code is linked with other data.
    parser.add_argument("--fail-touched", type=percentage, default="20%", metavar="PERCENT", help="of lines touched")
    parser.add_argument("--fail-d1", type=percentage, default="50%", metavar="PERCENT", help="of lines that D1 misses")
    parser.add_argument("--few", type=int, default=96, metavar="N", help="so many more are as good as none")
    parser.add_argument("--renew", action="store_true", help="write the baseline instead of comparing")
    parser.add_argument("--why", default="", help="what the baseline is renewed for: one line, for its file and commit")
    options = parser.parse_args()
    if options.renew and (not options.why.strip() or not options.why.isprintable()):
        parser.error("--renew needs --why \"one line\": what changed the counts")
    return options


def main():
    options = parse_arguments()
    for path in [options.save] * bool(options.save) + [options.baseline] * options.renew:
        make_folder(path)
    base = None if options.renew else read(options.baseline)
    if options.counts:
        new = read(options.counts)
    else:
        program = options.program.resolve() if options.program else built_program()
        new = count(program, options.jobs)
    if options.save:
        write(options.save, new, "not a baseline")
    if options.renew:
        return renew(options, new)
    if different := differences(base, new):
        raise Stop(3, "NOT COMPARED: these are not the counts of the baseline's compiler and libraries\n" +
                   "\n".join(different))
    tolerances = {name: options.fail_lines for name in COUNTS}
    tolerances |= {"instructions": options.fail_instructions, "lines": options.fail_touched, "d1_misses": options.fail_d1}
    lines, code = compare(base, new, tolerances, options.few)
    print("\n".join(lines))
    return code


def complain(message):
    try:
        print("instruction counts: " + "\n".join(map(plain, message.splitlines())), file=sys.stderr, flush=True)
    except OSError:
        pass  # the exit code is what is left


def exit_code():
    """Of the command. 1 is an answer, that a kernel grew, and so nothing else ends with it."""
    sys.stdout, sys.stderr = (stream or open(os.devnull, "w") for stream in (sys.stdout, sys.stderr))
    sys.stdout.reconfigure(errors="backslashreplace")
    try:
        code = main()
        sys.stdout.flush()
        return code
    except Stop as stop:
        complain(str(stop))
        return stop.code
    except OSError as error:
        complain(f"cannot read or write: {error}")
    except Exception as error:  # noqa: BLE001
        at = traceback.extract_tb(error.__traceback__)[-1]
        complain(f"a fault of this script: {type(error).__name__}: {error} ({Path(at.filename).name}, line {at.lineno})")
    return 2


if __name__ == "__main__":
    code = exit_code()
    # What is buffered for an output that takes nothing would fail once more at exit, with a code of Python's own.
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except OSError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
    sys.exit(code)
