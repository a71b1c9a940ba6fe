"""Puts the table of a run of the suite `quick` and an answer of `choose` into the README, and draws the docs' figures.

    scripts/bench.sh && build/release/penumbra choose bunny --light city --error 2% && \\
        .venv/bin/python scripts/update_readme.py

A figure whose run is not there is left as it is; `penumbra run soft-shadows --out results/runs/soft-shadows` makes one.
"""

import argparse
import json
import pathlib
import subprocess

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


def replace_section(name: str, content: str) -> None:
    readme = ROOT / "README.md"
    begin, end = f"<!-- {name}:begin -->\n", f"<!-- {name}:end -->"
    head, rest = readme.read_text().split(begin)
    readme.write_text(head + begin + content + "\n" + end + rest.split(end)[1])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--figures", action="append", choices=FIGURES, help="draw only this one; leave the table alone")
    only = parser.parse_args().figures
    figures(only)
    if only:
        return
    replace_section("table", table())
    screen = RUNS / "choose" / "choice.txt"
    if screen.exists():
        replace_section("choose", f"```\n{screen.read_text().strip()}\n```")


if __name__ == "__main__":
    main()
