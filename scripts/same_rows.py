#!/usr/bin/env python3
"""Compares the rows of two runs: are their errors equal to the bit, and how do their times relate?

    scripts/same_rows.py BASE_FOLDER NEW_FOLDER [NEW_FOLDER ...]

Of several new folders (interleaved runs) and several base folders (--base), medians are compared. Exit code 1 if errors
of a row differ, or a row is missing.
"""
import argparse
import statistics
import sys

import results_file

NEW_FIELDS = {"tie"}  # that files of older programs lack


def rows_of(folder):
    return {row["name"]: row for row in results_file.read_rows(folder) if row["status"] == "ok"}


def errors_of(row):
    return {rung: {k: v for k, v in errors.items() if k not in NEW_FIELDS} for rung, errors in row["errors"].items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("base")
    parser.add_argument("new", nargs="+")
    parser.add_argument("--base", dest="more_bases", action="append", default=[])
    options = parser.parse_args()
    bases = [rows_of(f) for f in [options.base] + options.more_bases]
    news = [rows_of(f) for f in options.new]
    missing = sorted(bases[0].keys() - news[0].keys())
    different = [n for n in bases[0].keys() & news[0].keys() if errors_of(bases[0][n]) != errors_of(news[0][n])]
    ratios = []
    for name in sorted(bases[0].keys() & news[0].keys()):
        if not all(rows[name]["samples"]["frame_ms"] for rows in bases + news):
            continue  # not timed
        before = statistics.median(s for rows in bases for s in rows[name]["samples"]["frame_ms"])
        after = statistics.median(s for rows in news for s in rows[name]["samples"]["frame_ms"])
        ratios.append(after / before)
    for name in missing:
        print("missing:", name)
    for name in different:
        print("different errors:", name)
    print(f"{len(ratios)} rows in both, {len(different)} with different errors, {len(missing)} missing")
    if ratios:
        quartiles = statistics.quantiles(ratios, n=4) if len(ratios) > 1 else ratios * 3
        print(f"frame time new / base: median {quartiles[1]:.3f}, middle half {quartiles[0]:.3f} to {quartiles[2]:.3f},"
              f" all {min(ratios):.3f} to {max(ratios):.3f}")
    sys.exit(1 if different or missing else 0)


if __name__ == "__main__":
    main()
