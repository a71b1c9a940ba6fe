"""Measures a tiny suite twice, and has the tools that results.json and the formats of `penumbra export-rows` are for read
them: Google Benchmark's compare.py, benchadapt, pandas, LNT, Apache Otava. What they read must be what was measured.

    .venv/bin/python scripts/check_formats.py [--program build/release/penumbra]     # exit 1 if a reader reads another value
"""

import argparse
import csv
import json
import logging
import math
import os
import pathlib
import re
import shutil
import sqlite3
import statistics
import subprocess
import sys
import tempfile

import pandas
from benchadapt.adapters import GoogleBenchmarkAdapter
from otava.config import load_config_from_parser_args
from otava.importer import CsvImporter
from otava.util import parse_datetime

import results_file

ROOT = pathlib.Path(__file__).resolve().parent.parent
COMPARE = "/usr/share/benchmark/compare.py"  # of Debian's libbenchmark-tools
REPETITIONS = 9
# A name with all that has to be quoted or escaped somewhere.
SCENE = """
name = 'tiny, 50% of_"a" & b'
[occluder]
mesh = "box"
fit = { height = 0.5, on_ground = true }
spheres = 2
[receivers]
plane = { half_extent = 1.0, resolution = 16 }
[light]
environment = "constant"
"""
SUITE = f"""
name = "formats"
scenes = ["scene.toml"]
repetitions = {REPETITIONS}
truth_noise = 0.05
[[technique]]
name = "constant"
parameters = {{ radiance = [0.25, 1.0] }}
[[technique]]
name = "ray-traced"
backend = "scalar"
parameters = {{ rays = 4 }}
[[technique]]
name = "pcss"
backend = "scalar"
"""


class Wrong(Exception):
    pass


def expect(condition, what) -> None:
    if not condition:
        raise Wrong(what)


def near(a, b) -> bool:
    return math.isclose(a, b, rel_tol=1e-12)


def run(*command, **options) -> str:
    result = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False, **options)
    expect(result.returncode == 0, f"{command}: exit code {result.returncode}: {result.stderr[-1000:]}")
    return result.stdout


class Run:
    """A folder of results, and what must be read from it."""

    def __init__(self, program, folder):
        self.program, self.folder, self.file = program, folder, folder / "results.json"
        self.document = json.loads(self.file.read_text())
        self.rows = results_file.read_rows(folder)
        self.good = [row for row in self.rows if row["status"] == "ok"]
        self.timed = [row for row in self.good if row["samples"]["frame_ms"]]

    def export(self, name) -> str:
        # As bytes: the line ends are part of a format.
        return subprocess.run([self.program, "export-rows", self.folder, "--format", name], capture_output=True,
                              check=True).stdout.decode()


def error_of(row):
    return row["errors"]["truth"]["rel_rmse"]


def measure(program, work) -> list[Run]:
    (work / "scene.toml").write_text(SCENE)
    (work / "suite.toml").write_text(SUITE)
    runs = []
    for name in ("base", "new"):
        run(program, "run", work / "suite.toml", "--out", work / name)
        image = next((work / name / "images").glob("*/truth.exr"))
        run(program, "score", work / "scene.toml", image, "--name", "theirs", "--noise", "0.05", "--out", work / name)
        runs.append(Run(program, work / name))
    expect([len(runs[0].document[name]) for name in ("rows", "untimed", "failed", "skipped")] == [3, 1, 0, 1],
           "three rows should be timed, one untimed and one skipped")
    expect(any("radiance:0.25" in row["name"] for row in runs[0].timed) and
           not any("radiance:1" in row["name"] for row in runs[0].timed), "a default stands in a name")
    return runs


def check_compare(base, new) -> str:
    report = base.folder / "compare.json"
    said = run(sys.executable, COMPARE, "--no-color", "-d", report, "benchmarks", base.file, new.file)
    expect(f"U Test, Repetitions: {REPETITIONS} vs {REPETITIONS}" in said, f"compare.py reports no U test: {said}")
    told = {entry["name"]: entry for entry in json.loads(report.read_text())}
    for old, now in zip(base.timed, new.timed, strict=True):
        entry = told[old["name"]]
        expect(entry["utest"]["nr_of_repetitions"] == REPETITIONS, entry)
        expect([m["real_time"] for m in entry["measurements"]] == old["samples"]["frame_ms"], entry)
        expect([m["real_time_other"] for m in entry["measurements"]] == now["samples"]["frame_ms"], entry)
        expect(told[old["name"] + "_median"]["measurements"][0]["real_time"] == old["frame_ms"], "the median")
        mean = statistics.fmean(old["samples"]["frame_ms"])
        expect(near(told[old["name"] + "_mean"]["measurements"][0]["real_time"], mean), "the mean")
        spread = statistics.stdev(old["samples"]["frame_ms"])
        expect(math.isclose(told[old["name"] + "_stddev"]["measurements"][0]["real_time"], spread, rel_tol=1e-9), "stddev")
        expect(math.isclose(told[old["name"] + "_cv"]["measurements"][0]["real_time"], spread / mean, rel_tol=1e-9), "cv")
    expect(not any("theirs" in name or "pcss" in name for name in told), "a row without a time is in benchmarks")
    return f"{said.count('U Test')} U tests"


def check_benchadapt(base) -> str:
    os.environ.update(CONBENCH_PROJECT_REPOSITORY="x/y", CONBENCH_PROJECT_COMMIT="0" * 40)  # else it looks for git's
    results = GoogleBenchmarkAdapter(command=["true"], result_file=base.file).run()
    told = {f"{r.tags['name']}/{r.tags['params']}": r.stats for r in results}
    expect(told.keys() == {row["name"] for row in base.timed}, f"other names: {told.keys()}")
    for row in base.timed:
        stats = told[row["name"]]
        expect(stats["data"] == row["samples"]["frame_ms"] and stats["unit"] == "ms", stats)
        expect(stats["iterations"] == REPETITIONS, stats)
    return f"{len(told)} cases"


def check_pandas(base) -> str:
    frame = pandas.DataFrame(base.document["rows"])
    expect(list(frame["frame_ms"]) == [statistics.median(row["samples"]["frame_ms"]) for row in base.timed], "medians")
    text = base.export("csv")
    (base.folder / "rows.csv").write_bytes(text.encode())
    table = pandas.read_csv(base.folder / "rows.csv").set_index("name")
    expect(len(table) == len(base.rows), "a line is missing")
    for row in base.rows:
        line = table.loc[row["name"]]
        expect(line["status"] == row["status"] and line["scene"] == row["scene"], line)
        for field in ("frame_ms", "update_ms", "shade_ms", "bytes"):
            expect(pandas.isna(line[field]) if row[field] is None else line[field] == row[field], f"{field}: {line}")
        for rung, errors in row["errors"].items():
            for name in ("rel_rmse", "flip", "noise"):
                expect(line[f"errors.{rung}.{name}"] == errors[name], f"{rung} {name}: {line}")
        for k, ms in enumerate(row["samples"]["frame_ms"]):
            expect(line[f"samples.frame_ms.{k}"] == ms, line)
    return f"{table.shape[0]} lines, {table.shape[1]} columns"


def check_lnt(base) -> str:
    report, instance = base.folder / "lnt.json", base.folder / "lnt"
    report.write_text(base.export("lnt"))
    lnt = pathlib.Path(sys.executable).parent / "lnt"
    expect("Validation succeeded" in run(lnt, "checkformat", report), "lnt checkformat")
    run(lnt, "create", instance)
    (instance / "schemas").mkdir(exist_ok=True)
    shutil.copy(ROOT / "scripts" / "lnt-penumbra.yaml", instance / "schemas" / "penumbra.yaml")
    run(lnt, "import", "-s", "penumbra", "--no-report", "--no-email", instance, report)
    with sqlite3.connect(instance / "data" / "lnt.db") as database:
        samples = database.execute('select t.Name, s.execution_time, s.error, s.mem_bytes from penumbra_Sample s '
                                   'join penumbra_Test t on s.TestID = t.ID order by s.ID').fetchall()
    for row in base.good:
        own = [sample[1:] for sample in samples if sample[0] == row["name"]]
        times = [seconds for seconds, _, _ in own if seconds is not None]
        expect(len(times) == len(row["samples"]["frame_ms"]) and
               all(near(1e3 * s, ms) for s, ms in zip(times, row["samples"]["frame_ms"])), f"times: {own}")
        expect(own[0][1] == error_of(row) and own[0][2] == row["bytes"], f"error, bytes: {own}")
    return f"{len(samples)} samples in its database"


def history(base, work, length=20) -> list[pathlib.Path]:
    """Runs of so many days; from the middle on, the first timed row takes half as long again."""
    folders = []
    for day in range(length):
        document = json.loads(base.file.read_text())
        document["context"]["date"] = f"2026-01-{day + 1:02}T12:00:00+00:00"
        slow = 1.5 if day >= length // 2 else 1.0
        for entry in document["benchmarks"]:
            if entry["family_index"] == base.timed[0]["index"]:
                entry["real_time"] *= slow * (1 + 1e-3 * (day % 3))
        folders.append(work / f"day{day}")
        folders[-1].mkdir()
        (folders[-1] / "results.json").write_text(json.dumps(document))
    return folders


def check_otava(base, work) -> str:
    folders, table, config = history(base, work), work / "otava.csv", work / "otava.yaml"
    run(base.program, "export-rows", *folders, "--format", "otava", "--out", table)
    first, error = base.timed[0]["name"] + " ms", base.timed[0]["name"] + " error"
    config.write_text("tests:\n  penumbra:\n" + json.dumps({
        "type": "csv", "file": str(table), "time_column": "time", "attributes": ["commit"],
        "metrics": {"ms": {"column": first, "direction": -1}, "error": {"column": error, "direction": -1}}}, indent=1
    ).replace("\n", "\n    ").replace("{", "    {", 1))
    test = load_config_from_parser_args(argparse.Namespace(config_file=str(config), **dict.fromkeys(OTAVA_OPTIONS)))
    series = CsvImporter().fetch_data(test.tests["penumbra"])
    expect(series.time[0] == int(parse_datetime("2026-01-01T12:00:00+00:00").timestamp()), "the first day")
    for folder, ms, wrong in zip(folders, series.data["ms"], series.data["error"], strict=True):
        row = results_file.read_rows(folder)[base.timed[0]["index"]]
        expect(ms == statistics.median(row["samples"]["frame_ms"]) and wrong == error_of(row), f"{folder}: {ms}, {wrong}")
    said = run(pathlib.Path(sys.executable).parent / "otava", "analyze", "penumbra", "--config-file", config,
               "--since", "2025-12-01")
    expect("2026-01-11 12:00:00" in said and "+50" in said.replace(".", ""), f"otava finds no change point: {said}")
    return f"{len(series.time)} runs, the planted change found"


OTAVA_OPTIONS = ["graphite_url", "grafana_url", "grafana_user", "grafana_password", "slack_token", "postgres_hostname",
                 "postgres_port", "postgres_username", "postgres_password", "postgres_database", "bigquery_project_id",
                 "bigquery_dataset", "bigquery_credentials"]


def check_bencher(base) -> str:
    told = json.loads(base.export("bmf"))
    expect(told.keys() == {row["name"] for row in base.good}, told.keys())
    for row in base.good:
        measures = told[row["name"]]
        expect(measures["error"]["value"] == error_of(row), measures)
        samples = row["samples"]["frame_ms"]
        if samples:
            latency = [measures["latency"][key] for key in ("lower_value", "value", "upper_value")]
            expect(all(map(near, latency, [1e6 * ms for ms in (min(samples), row["frame_ms"], max(samples))])), latency)
            expect(measures["bytes"]["value"] == row["bytes"], measures)
    expect(all(set(m) <= {"value", "lower_value", "upper_value"} and "value" in m and
               all(isinstance(v, (int, float)) for v in m.values()) for ms in told.values() for m in ms.values()), told)
    return f"{len(told)} benchmarks"


def check_github(base) -> str:
    figures = json.loads(base.export("github"))
    told = {figure["name"]: figure for figure in figures}
    expect(len(told) == len(figures), "a name stands twice")
    for row in base.timed:
        time, error, size = (told[f"{row['name']} {what}"] for what in ("time", "error", "size"))
        expect(time["value"] == row["frame_ms"] and time["unit"] == "ms", time)
        expect(near(error["value"], 100 * error_of(row)) and error["unit"].startswith("%"), error)
        expect(size["value"] == row["bytes"] and size["unit"] == "bytes", size)
        expect(near(float(re.fullmatch("± (.*)", time["range"])[1]), float(f"{row['frame_spread_ms']:.3g}")), time)
    expect(all(figure.keys() <= {"name", "unit", "value", "range", "extra"} for figure in figures), figures)
    return f"{len(figures)} figures"


def check_benchstat(base) -> str:
    """By the format's own words: name, count, then pairs of value and unit; settings are `key: value`."""
    text = base.export("benchstat")
    told = {}
    for line in text.splitlines():
        if not line.startswith("Benchmark"):
            expect(line == "" or re.fullmatch(r"[a-z][^ A-Z]*: .*|Unit \S+ \S+=\S+", line), line)
            continue
        name, count, *pairs = line.split()
        expect(int(count) > 0 and name[len("Benchmark")].isupper() and len(pairs) % 2 == 0, line)
        told.setdefault(name, []).append({unit: float(value) for value, unit in zip(pairs[::2], pairs[1::2])})
    for row in base.timed:
        own = told["BenchmarkPenumbra/" + row["name"].replace(":", "=").replace(" ", "-")]
        expect(len(own) == REPETITIONS, own)
        for line, ms in zip(own, row["samples"]["frame_ms"]):
            expect(near(line["ns/op"], 1e6 * ms) and line["error"] == error_of(row) and line["B"] == row["bytes"], line)
    if shutil.which("benchstat"):
        (base.folder / "benchstat.txt").write_text(text)
        expect(f"n={REPETITIONS}" in run("benchstat", base.folder / "benchstat.txt"), "benchstat")
    return f"{len(told)} benchmarks"


def check_latex(base) -> str:
    text = base.export("latex")
    lines = [line.removesuffix(r" \\") for line in text.splitlines() if line.endswith(r"\\")]
    cells = [[cell.strip() for cell in re.split(r"(?<!\\)&", line)] for line in lines]
    expect(all(len(line) == len(cells[0]) == 8 for line in cells), text)
    told = {(line[1], line[2], line[3]): line for line in cells[1:]}
    expect(len(told) == len(base.good), told)
    for row in base.timed:
        (line,) = [line for line in cells[1:] if line[1:3] == [row["technique"], row["backend"]] and
                   all(f"{k}={v:g}" in line[3] for k, v in row["parameters"].items() if row["technique"] == "constant")]
        expect(math.isclose(float(line[5]), row["frame_ms"], rel_tol=0.01), line)
        expect(math.isclose(float(line[6]), 100 * error_of(row), rel_tol=0.01), line)
        expect(line[0] == r'tiny, 50\% of\_"a" \& b', line)
    return f"{len(told)} lines"


def check_old_file(program, work) -> str:
    old = ROOT / "results" / "gpu" / "NVIDIA-H200" / "cuda.json"
    run(program, "export-rows", old, "--format", "csv", "--out", work / "old.csv")
    with open(work / "old.csv", newline="", encoding="utf-8") as file:
        lines = list(csv.DictReader(file))
    for line, row in zip(lines, json.loads(old.read_text())["benchmarks"], strict=True):
        expect(line["technique"] == row["technique"] and line["status"] == row["status"], line)
        for cell, value in ((line["frame_ms"], row["frame_ms"]), (line["bytes"], row["bytes"])):
            expect(cell == "" if value is None else float(cell) == value, line)
        if row["status"] == "ok":
            expect(float(line["errors.truth.rel_rmse"]) == error_of(row), line)
    return f"{len(lines)} rows"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "build" / "release" / "penumbra")
    program = parser.parse_args().program.resolve()
    logging.disable(logging.WARNING)
    wrong = 0
    with tempfile.TemporaryDirectory() as name:
        work = pathlib.Path(name)
        base, new = measure(program, work)
        checks = {"compare.py": lambda: check_compare(base, new), "benchadapt": lambda: check_benchadapt(base),
                  "pandas": lambda: check_pandas(base), "LNT": lambda: check_lnt(base),
                  "Otava": lambda: check_otava(base, work), "Bencher": lambda: check_bencher(base),
                  "github-action-benchmark": lambda: check_github(base), "benchstat": lambda: check_benchstat(base),
                  "LaTeX": lambda: check_latex(base), "a file of an older version": lambda: check_old_file(program, work)}
        for reader, check in checks.items():
            try:
                print(f"{reader}: {check()}")
            except (Wrong, KeyError, ValueError) as e:
                print(f"{reader}: WRONG: {type(e).__name__}: {str(e)[:2000]}")
                wrong += 1
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
