#!/usr/bin/env python3
"""Runs the small inputs of tests/cases (or of a folder like it) and compares with what is right (expected.toml there).

usage: .venv/bin/python scripts/check_cases.py [--program build/release/penumbra] [--cases tests/cases] [--only REGEX]

Prints a line a case, and exits 1 if any is wrong. Cases that a folder does not hold are left out and counted.
"""
import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import tomllib

import numpy

import results_file

NOISE = 0.003  # of each truth: its standard error relative to its RMS
ROOT = pathlib.Path(__file__).resolve().parent.parent


class Wrong(Exception):
    pass


def run(program, *arguments):
    result = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, timeout=600)
    if result.returncode < 0:
        raise Wrong(f"died by signal {-result.returncode}")
    return result


def truth(program, scene, image):
    result = run(program, "reference", scene, "--noise", NOISE, "--fresh", "-o", image)
    if result.returncode != 0:
        raise Wrong(f"exit code {result.returncode}: {result.stderr.strip()}")
    mean = re.search(r"mean \(([^)]*)\)", result.stdout)
    if not mean:
        raise Wrong(f"no mean in: {result.stdout.strip()}")
    return numpy.array([float(value) for value in mean[1].split(",")]), result.stderr


def difference(a, b):
    """RMS difference of two images relative to the RMS of the second, by OpenImageIO."""
    def rms(*arguments):
        stats = subprocess.run(["oiiotool", *map(str, arguments), "--printstats"], capture_output=True, text=True, check=True)
        average = [float(x) for x in re.search(r"Stats Avg:([^(]*)", stats.stdout)[1].split()]
        spread = [float(x) for x in re.search(r"Stats StdDev:([^(]*)", stats.stdout)[1].split()]
        return numpy.sqrt(numpy.mean(numpy.square(average) + numpy.square(spread)))
    return rms(a, b, "--sub") / rms(b)


def check_scene(program, folder, case, work):
    if "refused" in case:
        return check_refused(run(program, "reference", folder / case["scene"]), case["refused"])
    image = work / "a.exr"
    mean, messages = truth(program, folder / case["scene"], image)
    said = "mean " + " ".join(f"{value:.4g}" for value in mean)
    if "mean" in case:
        right = numpy.broadcast_to(numpy.array(case["mean"], dtype=float), 3)
        if numpy.any(numpy.abs(mean - right) > case.get("tolerance", 0.005) * max(right.max(), 1e-30)):
            raise Wrong(f"{said}; right is {right}")
    if "like" in case:
        other = work / "b.exr"
        like = folder / case["like"]
        truth(program, like if like.exists() else ROOT / "tests/cases" / case["like"], other)
        found = difference(image, other)
        said += f", differs by {100 * found:.2g} %"
        if not found <= 3 * 2**0.5 * NOISE:
            raise Wrong(said)
    if "says" in case and not re.search(case["says"], messages):
        raise Wrong(f"{said}, but does not say {case['says']!r}: {messages.strip()!r}")
    return said


def check_refused(result, expected):
    line = result.stderr.strip().splitlines()[-1] if result.stderr.strip() else ""
    if result.returncode != 2 or not re.search(expected, line):
        raise Wrong(f"exit code {result.returncode}, not refused with {expected!r}: {line or result.stdout.strip()}")
    return "refused: " + line[-60:]


def monte_carlo(boxes, spheres, samples=2_000_000):
    """Volumes of the boxes' union, of each sphere outside it summed, of all outside it, and of it uncovered."""
    random = numpy.random.default_rng(1)
    boxes = numpy.array(boxes, dtype=float)
    low = numpy.minimum(boxes[:, 0].min(0), (spheres[:, :3] - spheres[:, 3:]).min(0))
    high = numpy.maximum(boxes[:, 1].max(0), (spheres[:, :3] + spheres[:, 3:]).max(0))
    points = random.uniform(low, high, (samples, 3))
    cell = numpy.prod(high - low) / samples
    solid = numpy.zeros(samples, dtype=bool)
    for a, b in boxes:
        solid |= numpy.all((points >= a) & (points <= b), axis=1)
    covered = numpy.zeros(samples, dtype=bool)
    outside = 0
    for x, y, z, radius in spheres:
        inside = numpy.square(points - (x, y, z)).sum(1) <= radius * radius
        covered |= inside
        outside += numpy.count_nonzero(inside & ~solid)
    count = numpy.count_nonzero
    return {"volume": count(solid) * cell, "outside, summed": outside * cell,
            "outside, of union": count(covered & ~solid) * cell, "uncovered": count(solid & ~covered) * cell}


def check_fit(program, folder, case, work):
    target = work / "fit.json"
    result = run(program, "fit", folder / case["mesh"], "--spheres", case["fit"], "--objective", "cover", "-o", target)
    if "refused" in case:
        return check_refused(result, case["refused"])
    if result.returncode != 0:
        raise Wrong(f"exit code {result.returncode}: {result.stderr.strip()}")
    spheres = numpy.array(json.loads(target.read_text())["spheres"])
    right = monte_carlo(case["boxes"], spheres)
    said = []
    for name, value in right.items():
        found = float(re.search(rf"{name}[a-z ]*\s+([0-9.e+-]+) m\^3", result.stdout)[1])
        said.append(f"{name} {found:.4g} ({value:.4g})")
        if abs(found - value) > 0.01 * right["volume"] + 0.01 * value:
            raise Wrong(f"{name} is {found:.5g}, Monte Carlo gives {value:.5g}")
    return ", ".join(said)


def check_run(program, folder, case, work):
    out = work / "run"
    result = run(program, "run", folder / case["run"], "--out", out)
    if "refused" in case:
        said = check_refused(result, case["refused"])
        if out.exists() and list(out.rglob("*.exr")):
            raise Wrong("refused, but images were written")
        return said
    if result.returncode != 0:
        raise Wrong(f"exit code {result.returncode}: {result.stderr.strip()[-300:]}")
    rows = results_file.read_rows(out)
    for row in rows:
        status = row["status"]
        if status.startswith("failed"):
            raise Wrong(f"{row['name']}: {status}")
        if status == "ok" and row["errors"]["truth"]["rel_rmse"] is not None:
            raise Wrong(f"{row['name']}: relative error {row['errors']['truth']['rel_rmse']} of a black truth")
    for line in (out / "table.md").read_text().splitlines():
        if line.startswith("| P "):
            raise Wrong(f"best of a black truth: {line}")
    return f"{len(rows)} rows, relative errors undefined"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "build/release/penumbra")
    parser.add_argument("--cases", type=pathlib.Path, default=ROOT / "tests/cases")
    parser.add_argument("--only", default="", help="regular expression searched in names of cases")
    arguments = parser.parse_args()
    expected = tomllib.loads((ROOT / "tests/cases/expected.toml").read_text())["case"]
    checks = {"scene": check_scene, "mesh": check_fit, "run": check_run}
    counts = {"right": 0, "wrong": 0, "left out": 0}
    for case in expected:
        kind = next(key for key in checks if key in case)
        name = case[kind]
        if not re.search(arguments.only, name):
            continue
        if not (arguments.cases / name).exists():
            counts["left out"] += 1
            continue
        with tempfile.TemporaryDirectory() as work:
            os.environ["PENUMBRA_CACHE"] = work + "/cache"
            try:
                verdict, said = "right", checks[kind](arguments.program, arguments.cases, case, pathlib.Path(work))
            except Wrong as wrong:
                verdict, said = "wrong", str(wrong)
            except subprocess.TimeoutExpired:
                verdict, said = "wrong", "no end"
        counts[verdict] += 1
        print(f"{verdict:6} {name:42} {said}", flush=True)
    print(", ".join(f"{count} {verdict}" for verdict, count in counts.items()))
    return 1 if counts["wrong"] or not counts["right"] else 0


if __name__ == "__main__":
    sys.exit(main())
