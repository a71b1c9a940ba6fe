"""Puts the picture and the table of a run of the suite `quick` into the README.

    scripts/bench.sh && .venv/bin/python scripts/update_readme.py
"""

import json
import pathlib

from PIL import Image, ImageDraw

ROOT = pathlib.Path(__file__).resolve().parent.parent
RUN = ROOT / "results" / "runs" / "latest"
SCENE = "bunny-city"
PANELS = [
    ("truth", None),
    ("16 rays", "ray-traced-simd-rays-16-threads-2"),
    ("sphere table", "pixel-basis-simd-threads-2"),
    ("exact spheres", "pixel-basis-simd-visibility-raster-threads-2"),
    ("sh-exponentiation", "sh-exponentiation-simd-threads-2"),
]


def picture() -> None:
    folder = RUN / "images" / f"{SCENE}-64-spheres-shadow"
    size, title, gap = 256, 22, 6
    sheet = Image.new("RGB", (len(PANELS) * (size + gap) - gap, title + 2 * size + gap), "white")
    draw = ImageDraw.Draw(sheet)
    for column, (label, name) in enumerate(PANELS):
        x = column * (size + gap)
        draw.text((x + 4, 5), label, fill="black")
        files = [f"{name or 'truth'}.png"] + ([f"{name}.error.png"] if name else [])
        for row, file in enumerate(files):
            panel = Image.open(folder / file).convert("RGB").resize((size, size), Image.NEAREST)
            sheet.paste(panel, (x, title + row * (size + gap)))
    sheet.save(ROOT / "docs" / "techniques.png", optimize=True)


COLUMNS = ["", "technique", "backend", "parameters", "threads", "frame ms", "truth %", "cube %", "spheres %", "FLIP"]


def table() -> str:
    """The rows of table.md, in fewer columns."""
    context = json.loads((RUN / "results.json").read_text())["context"]
    section = (RUN / "table.md").read_text().split(f"## {SCENE}: by frame time\n\n")[1].split("\n\n")[0]
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in section.splitlines()]
    chosen = [rows[0].index(name) for name in COLUMNS]
    lines = ["| " + " | ".join(row[k] for k in chosen) + " |" for row in rows]
    return f"`{SCENE}`, {context['num_cpus']} cores of one {context['cpu_name']}:\n\n" + "\n".join(lines)


def main() -> None:
    picture()
    readme = ROOT / "README.md"
    text = readme.read_text()
    begin, end = "<!-- table:begin -->\n", "<!-- table:end -->"
    head, rest = text.split(begin)
    readme.write_text(head + begin + table() + "\n" + end + rest.split(end)[1])


if __name__ == "__main__":
    main()
