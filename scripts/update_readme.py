"""Puts the table of a run of the suite `quick` and an answer of `choose` into the README, the rows measured on devices
(results/gpu/, by scripts/gpu_check.sh) into docs/cuda.md, and draws the docs' figures.

    scripts/bench.sh && build/release/penumbra choose bunny --light city --error 2% && \\
        .venv/bin/python scripts/update_readme.py

A figure whose run is not there is left as it is; `penumbra run soft-shadows --out results/runs/soft-shadows` makes one.
"""

import argparse
import json
import pathlib
import subprocess

import results_file

ROOT = pathlib.Path(__file__).resolve().parent.parent
RUNS = ROOT / "results" / "runs"
RUN = RUNS / "latest"
SCENE = "bunny-city"
# Figure: run, scenes, rows in the order of the panels.
FIGURES = {
    "techniques": ("latest", [SCENE], ["/ray-traced/simd/.*/rays:16/", "/pixel-basis/simd.*visibility:table",
                                       "/pixel-basis/simd.*visibility:raster", "/sh-exponentiation/simd"]),
    "soft-shadows": ("soft-shadows", ["soft-random"], ["/pcss/", "/hqepcss/", "/fast-pcss/.*snap_place:corner",
                                                       "/pcss-rotated/.*pattern:vogel", "/moment-shadows/"]),
    "low-frequency": ("low-frequency", [SCENE, "bunny-softbox"],
                      ["spheres:64/.*sh-exponentiation.*hierarchy:on.*order:4", "spheres:64/.*sh-exponentiation.*hierarchy:off",
                       "spheres:64/.*sh-exponentiation.*order:6", "/sh-lighting/", "spheres:64/.*/wavelet/",
                       "spheres:64/.*/pixel-basis/", "/ray-traced/"]),
}


def figures(only) -> None:
    for name, (run, scenes, rows) in FIGURES.items():
        if (only and name not in only) or not (RUNS / run / "results.json").exists():
            continue
        command = [ROOT / "build/release/penumbra", "sheet", RUNS / run, "-o", ROOT / "docs" / f"{name}.png"]
        for scene in scenes:
            command += ["--scene", scene]
        for row in rows:
            command += ["--rows", row]
        subprocess.run(command, check=True)


COLUMNS = ["", "technique", "backend", "parameters", "threads", "frame ms", "truth %", "cube %", "spheres %", "FLIP"]


def table() -> str:
    """The rows of table.md, in fewer columns."""
    context = json.loads((RUN / "results.json").read_text())["context"]
    section = (RUN / "table.md").read_text().split(f"## {SCENE}: by frame time\n\n")[1].split("\n\n")[0]
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in section.splitlines()]
    chosen = [rows[0].index(name) for name in COLUMNS if name in rows[0]]
    lines = ["| " + " | ".join(row[k] for k in chosen) + " |" for row in rows]
    return f"`{SCENE}`, {context['num_cpus']} cores of one {context['cpu_name']}:\n\n" + "\n".join(lines)


def devices() -> str:
    """One table a device: every cuda row of the suite `cuda` beside the same technique on the host's threads."""
    texts = []
    for file in sorted((ROOT / "results/gpu").glob("*/cuda.json")):
        context = json.loads(file.read_text())["context"]
        rows = [row for row in results_file.read_rows(file) if row["status"] == "ok"]
        lines = [f"{context['cuda_device']} (driver {context['cuda_driver']}) beside {context['num_cpus']} cores of one "
                 f"{context['cpu_name']}, {context['date'][:10]}; all rows: "
                 f"[results/gpu/{file.parent.name}](../results/gpu/{file.parent.name}).", "",
                 "| scene | receivers | technique | parameters | cuda ms | host ms | host / cuda | error % |",
                 "|---|---|---|---|---|---|---|---|"]
        for row in rows:
            if row["backend"] != "cuda":
                continue
            host = [other for other in rows if other["backend"] == "simd" and
                    all(other[key] == row[key] for key in ("scene", "technique")) and
                    all(row["parameters"].get(name) == value for name, value in other["parameters"].items())]
            told = {k: v for k, v in row["parameters"].items() if v != row["defaults"].get(k) or k == "kernels"}
            text = " ".join(f"{k}={v}" for k, v in told.items())
            ms, beside = row["frame_ms"], host[0]["frame_ms"]
            lines.append(f"| {row['scene']} | {row['receivers']} | {row['technique']} | {text} | {ms:.3g} | {beside:.3g} | "
                         f"{beside / ms:.2g} | {100 * row['errors']['truth']['rel_rmse']:.3g} |")
        texts.append("\n".join(lines))
    return "\n\n".join(texts)


def replace_section(page: str, name: str, content: str) -> None:
    file = ROOT / page
    begin, end = f"<!-- {name}:begin -->\n", f"<!-- {name}:end -->"
    head, rest = file.read_text().split(begin)
    file.write_text(head + begin + content + "\n" + end + rest.split(end)[1])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--figures", action="append", choices=FIGURES, help="draw only this one; leave the table alone")
    only = parser.parse_args().figures
    figures(only)
    if only:
        return
    replace_section("docs/cuda.md", "devices", devices())
    if not RUN.exists():
        return
    replace_section("README.md", "table", table())
    screen = RUNS / "choose" / "choice.txt"
    if screen.exists():
        replace_section("README.md", "choose", f"```\n{screen.read_text().strip()}\n```")


if __name__ == "__main__":
    main()
