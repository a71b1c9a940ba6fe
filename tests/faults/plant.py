#!/usr/bin/env python3
"""Plants faults in a copy of the tree, one at a time, and asks whether a test notices.

usage: python3 tests/faults/plant.py [--check] [--only REGEX] [--build DIR] [--jobs N] [--list FILE]

The list (faults.toml beside this file) says for each fault where it goes, the exact text it replaces, and which tests
should fail. The copy lives in DIR and is built there as the release preset says; it stays, so that the next run builds only what
changed.
A line a fault:
  caught            a test failed
  survived          all tests passed: write one that fails
  does not compile  the compiler caught it, or the fault is written wrongly
  stale             its text is not in its file exactly once: the code changed, bring the list up to date
Exits 1 unless every fault was caught. --check only looks for the texts, in this tree, and takes no time.
"""
import argparse
import fcntl
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
LONGEST = 3600  # s, of the tests: a fault may loop for ever


def read_faults(path):
    """The faults of a list, and what is wrong with it."""
    faults, wrong, seen = tomllib.loads(path.read_text())["fault"], [], set()
    for fault in faults:
        name = fault.get("name", "?")
        if set(fault) != {"name", "file", "find", "replace", "tests"}:
            wrong.append(f"{name}: keys are {', '.join(sorted(fault))}; must be name, file, find, replace, tests")
        elif fault["find"] == fault["replace"]:
            wrong.append(f"{name}: changes nothing")
        if name in seen:
            wrong.append(f"{name}: two faults of this name")
        seen.add(name)
    return faults, wrong


def stale(fault, tree):
    """What is wrong with the fault's text, or nothing."""
    path = tree / fault["file"]
    count = path.read_text().count(fault["find"]) if path.is_file() else 0
    return "" if count == 1 else f"its text occurs {count} times in {fault['file']}; must be once"


def copy_tree(tree):
    """Brings the copy up to date; files that are equal keep their times, so that little is built anew."""
    listed = subprocess.run(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], cwd=ROOT,
                            capture_output=True, check=True).stdout.decode().split("\0")
    wanted = {name for name in listed if name and (ROOT / name).is_file()}
    for name in wanted:
        source, target = ROOT / name, tree / name
        if target.is_file() and target.read_bytes() == source.read_bytes():
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(source, target)
    for path in tree.rglob("*"):
        name = path.relative_to(tree)
        if name.parts[0] != "build" and path.is_file() and str(name) not in wanted:
            path.unlink()


class Copy:
    """The copy of the tree, its build and its tests."""

    def __init__(self, folder, jobs):
        self.tree, self.jobs = folder, jobs
        (self.tree / "build").mkdir(parents=True, exist_ok=True)
        self.lock = open(self.tree / "build/lock", "w")
        try:
            fcntl.flock(self.lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            sys.exit(f"{folder}: faults are being planted there already; name another folder with --build")
        copy_tree(self.tree)
        self._run("cmake", "--preset", "release", "-DPENUMBRA_TESTS=ON", must=True)
        if not self.build():
            sys.exit("the tree does not build as it is")
        shutil.rmtree(self.tree / "build/fits", ignore_errors=True)  # of this tree, not of the last one
        (self.tree / "build/fits").mkdir()

    def _run(self, *command, must=False, seconds=None, **environment):
        result = subprocess.run([str(word) for word in command], cwd=self.tree, capture_output=True, text=True,
                                timeout=seconds, env={**os.environ, **environment})
        if must and result.returncode != 0:
            sys.exit(f"{' '.join(map(str, command))}: {result.stdout[-2000:]}{result.stderr[-2000:]}")
        return result

    def build(self):
        return self._run("cmake", "--build", "--preset", "release", "--target", "penumbra_tests",
                         "-j", self.jobs).returncode == 0

    def failing_tests(self, tests, planted=""):
        """Names of the tests that fail with a fault in the file `planted`; [what happened] if they do not end."""
        # A cache of its own: what was computed before would hide the fault, what the fault computes would outlive it.
        # Spheres that were fitted without any fault may serve where no part of a fit is wrong: fits take long.
        fits = self.tree / "build/fits"
        with tempfile.TemporaryDirectory() as cache:
            if not planted.startswith("scenes/"):
                shutil.copytree(fits, cache, dirs_exist_ok=True)
            try:
                result = self._run("build/release/tests/penumbra_tests", "--gtest_brief=1",
                                   f"--gtest_filter={tests or '*'}", seconds=LONGEST, PENUMBRA_CACHE=cache)
            except subprocess.TimeoutExpired:
                return [f"not done after {LONGEST} s"]
            if not planted:
                for fit in pathlib.Path(cache).glob("fit-*.json"):
                    shutil.copy(fit, fits)
        if re.search(r"\] 0 tests from", result.stdout):
            sys.exit(f"no test is named '{tests}'")
        if result.returncode not in (0, 1):
            return [f"exit code {result.returncode}"]
        return sorted(set(re.findall(r"FAILED  \] ([^\s,]+)", result.stdout)))

    def planted(self, fault):
        """Verdict and details of one fault; the copy is whole again afterwards."""
        if message := stale(fault, self.tree):
            return "stale", message
        path = self.tree / fault["file"]
        whole = path.read_text()
        try:
            path.write_text(whole.replace(fault["find"], fault["replace"]))
            if not self.build():
                return "does not compile", ""
            failed = self.failing_tests(fault["tests"], fault["file"])
            return ("caught" if failed else "survived"), ", ".join(failed[:3]) + (", ..." if len(failed) > 3 else "")
        finally:
            path.write_text(whole)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="only look whether every text occurs exactly once")
    parser.add_argument("--only", default="", metavar="REGEX", help="faults whose name matches")
    parser.add_argument("--build", default=ROOT / "build/faults", type=pathlib.Path, metavar="DIR")
    parser.add_argument("--jobs", default=os.cpu_count(), type=int, metavar="N")
    parser.add_argument("--list", default=HERE / "faults.toml", type=pathlib.Path, metavar="FILE")
    options = parser.parse_args()
    faults, wrong = read_faults(options.list)
    chosen = [fault for fault in faults if re.search(options.only, fault["name"])]
    if options.check:
        wrong += [f"{fault['name']}: {message}" for fault in chosen if (message := stale(fault, ROOT))]
    for message in wrong:
        print(f"faults: {message}", file=sys.stderr)
    if options.check or wrong:
        return bool(wrong)

    copy = Copy(options.build.resolve(), options.jobs)
    if broken := copy.failing_tests(":".join(sorted({fault["tests"] for fault in chosen if fault["tests"]}))):
        sys.exit(f"tests fail without any fault: {', '.join(broken)}")
    caught = 0
    for fault in chosen:
        start = time.monotonic()
        verdict, details = copy.planted(fault)
        caught += verdict == "caught"
        print(f"{verdict:16}  {fault['name']} ({time.monotonic() - start:.0f} s) {details}", flush=True)
    print(f"{caught} of {len(chosen)} caught")
    return caught != len(chosen)


if __name__ == "__main__":
    sys.exit(main())
