#!/usr/bin/env python3
"""Interrupts runs of a suite at random moments, and looks whether anything finished is lost.

First one undisturbed run. Then rounds, every other one with an empty cache (so that references and fits are interrupted,
too): a run is started, gets SIGINT or SIGTERM at a random moment, is resumed, gets another, until it ends by itself. Every time:
it ends within two seconds with exit code 130, results.json is whole, every row that was finished is still there to the
bit, and the last one has the rows of the undisturbed run with equal errors.

    tests/interrupts.py --program build/release/penumbra --moments 100
"""
import argparse
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "scripts"))
import results_file  # noqa: E402

MOST_SECONDS = 2.0


def rows_of(folder):
    """Finished rows by name; none if there is no file yet."""
    if not os.path.exists(os.path.join(folder, "results.json")):
        return {}
    rows = [row for row in results_file.read_rows(folder) if row["status"] == "ok"]
    for row in rows:
        del row["index"]  # its place among the others may change
    return {row["name"]: row for row in rows}


def start(options, place, resume):
    command = [options.program, "run", options.suite, "--out", place + "/out", "--repetitions", str(options.repetitions)]
    command += ["--filter", options.filter] + (["--resume"] if resume else [])
    environment = dict(os.environ, PENUMBRA_CACHE=place + "/cache")
    log = open(place + "/log", "a", encoding="utf-8")
    return subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=log)


def undisturbed(options, place):
    begin = time.monotonic()
    if start(options, place, False).wait() != 0:
        sys.exit("the undisturbed run failed:\n" + open(place + "/log", encoding="utf-8").read()[-2000:])
    return rows_of(place + "/out"), time.monotonic() - begin


def interrupt(process, options, chance):
    """Waits a random while, sends a signal; (exit code, seconds until the end), or None if it had ended by itself."""
    try:
        process.wait(timeout=chance.uniform(0.0, options.longest))
        return None
    except subprocess.TimeoutExpired:
        pass
    process.send_signal(chance.choice([signal.SIGINT, signal.SIGTERM]))
    begin = time.monotonic()
    return process.wait(), time.monotonic() - begin


def lost_rows(before, after):
    return [name for name, row in before.items() if after.get(name) != row]


def one_round(options, place, expected, chance, tally):
    resume = False
    while True:
        before = rows_of(place + "/out")
        process = start(options, place, resume)
        resume = True
        ended = interrupt(process, options, chance)
        after = rows_of(place + "/out")
        faults = [f"lost {name}" for name in lost_rows(before, after)]
        if ended is None:
            if process.returncode != 0:
                faults.append(f"the resumed run ended with {process.returncode}")
            if {k: v["errors"] for k, v in after.items()} != {k: v["errors"] for k, v in expected.items()}:
                faults.append("the rows are not those of the undisturbed run")
            return faults
        code, seconds = ended
        tally.append((seconds, len(before), len(after)))
        # Before the run watches for signals there is nothing to keep, and they end it as they end every program.
        if code not in (130, 0, -signal.SIGINT, -signal.SIGTERM):
            faults.append(f"exit code {code}")
        if seconds > MOST_SECONDS:
            faults.append(f"took {seconds:.2f} s to end")
        if faults or len(tally) >= options.moments:
            return faults


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--program", default="build/release/penumbra")
    parser.add_argument("--suite", default="quick")
    parser.add_argument("--filter", default=".*")
    parser.add_argument("--moments", type=int, default=100)
    parser.add_argument("--longest", type=float, default=25.0, help="seconds until a signal, at most")
    parser.add_argument("--repetitions", type=int, default=2)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    chance = random.Random(options.seed)
    signal.signal(signal.SIGINT, signal.default_int_handler)  # in the background it may be ignored, and inherited so
    tally, faults, rounds = [], [], 0
    place = tempfile.mkdtemp(prefix="penumbra-interrupts-")
    expected, seconds = undisturbed(options, place)
    print(f"undisturbed: {len(expected)} rows in {seconds:.1f} s", flush=True)
    while len(tally) < options.moments:
        shutil.rmtree(place + "/out")
        if rounds % 2 == 1:
            shutil.rmtree(place + "/cache")
        faults += one_round(options, place, expected, chance, tally)
        rounds += 1
        print(f"round {rounds}: {len(tally)} signals so far, {len(faults)} faults", flush=True)
    slowest = max(t[0] for t in tally)
    print(f"{len(tally)} signals in {rounds} rounds: slowest end {slowest:.2f} s, faults: {faults or 'none'}")
    shutil.rmtree(place)
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
