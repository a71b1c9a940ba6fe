"""Reads results.json of every version (docs/results.md).

    rows = results_file.read_rows("results/runs/latest")       # dictionaries, in the order of the run
"""

import json
import pathlib

LISTS = ("rows", "untimed", "failed", "skipped")


def rows_of(document: dict) -> list[dict]:
    """All rows, whatever became of them, each with `samples`: times of its repetitions in ms."""
    if "format_version" not in document:
        return document["benchmarks"]
    rows = sorted((row for name in LISTS for row in document[name]), key=lambda row: row["index"])
    by_name = {row["name"]: row for row in rows}
    for row in document["rows"]:
        row["samples"] = {"frame_ms": [], "update_ms": [], "shade_ms": []}
    for entry in document["benchmarks"]:
        if entry["run_type"] != "iteration":
            continue
        samples = by_name[entry["run_name"]]["samples"]
        samples["frame_ms"].append(entry["real_time"])
        for name in ("update_ms", "shade_ms"):
            if name in entry:
                samples[name].append(entry[name])
    return rows


def read_rows(file_or_folder) -> list[dict]:
    """The rows of a file, or of the results.json in a folder."""
    path = pathlib.Path(file_or_folder)
    return rows_of(json.loads((path / "results.json" if path.is_dir() else path).read_text(encoding="utf-8")))
