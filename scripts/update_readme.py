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
    ("16 rays", "ray-traced-simd-estimator-ratio-occluder-mesh-rays-16-seed-1-threads-2"),
    ("sphere table", "pixel-basis-simd-bins-angle-resolution-32-visibility-table-threads-2"),
    ("exact spheres", "pixel-basis-simd-bins-angle-resolution-32-visibility-raster-threads-2"),
    ("sh-exponentiation", "sh-exponentiation-simd-*"),
]


def picture() -> None:
    folder = RUN / "images" / f"{SCENE}-64-spheres-shadow"
    size, title, gap = 256, 22, 6
    sheet = Image.new("RGB", (len(PANELS) * (size + gap) - gap, title + 2 * size + gap), "white")
    draw = ImageDraw.Draw(sheet)
    for column, (label, name) in enumerate(PANELS):
        x = column * (size + gap)
        draw.text((x + 4, 5), label, fill="black")
        if name and "*" in name:
            name = next(folder.glob(name + ".exr")).name.removesuffix(".exr")
        files = [f"{name or 'truth'}.png"] + ([f"{name}.error.png"] if name else [])
        for row, file in enumerate(files):
            panel = Image.open(folder / file).convert("RGB").resize((size, size), Image.NEAREST)
            sheet.paste(panel, (x, title + row * (size + gap)))
    sheet.save(ROOT / "docs" / "techniques.png", optimize=True)


def percent(row: dict, rung: str) -> str:
    errors = row["errors"].get(rung)
    if not errors:
        return ""
    return "undefined" if errors["rel_rmse"] is None else f"{100 * errors['rel_rmse']:.3g}"


def table() -> str:
    results = json.loads((RUN / "results.json").read_text())
    rows = [r for r in results["benchmarks"] if r["scene"] == SCENE and r["status"] == "ok"]
    rows.sort(key=lambda r: r["frame_ms"])
    lines = [
        f"`{SCENE}`, {rows[0]['receivers']} receivers, {results['context']['num_cpus']} cores of one "
        f"{results['context']['cpu_name']}:", "",
        "| | technique | backend | parameters | threads | frame ms | truth % | cube % | spheres % | FLIP |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for r in rows:
        error, time = r["errors"]["truth"]["rel_rmse"], r["frame_ms"]
        others = [(o["frame_ms"], o["errors"]["truth"]["rel_rmse"]) for o in rows if o is not r]
        beaten = error is None or any(  # a black truth has no relative errors, and no row is best
            e is not None and t <= time and e <= error and (t, e) != (time, error) for t, e in others)
        shown = {k: v for k, v in r["parameters"].items() if k in ("rays", "visibility", "order")}
        parameters = " ".join(f"{k}={v}" for k, v in shown.items())
        lines.append(
            f"| {'' if beaten else 'P'} | {r['technique']} | {r['backend']} | {parameters} | {r['threads']} | {time:.2f} "
            f"| {percent(r, 'truth')} | {percent(r, 'cube')} | {percent(r, 'spheres')} "
            f"| {r['errors']['truth']['flip']:.4f} |")
    return "\n".join(lines)


def main() -> None:
    picture()
    readme = ROOT / "README.md"
    text = readme.read_text()
    begin, end = "<!-- table:begin -->\n", "<!-- table:end -->"
    head, rest = text.split(begin)
    readme.write_text(head + begin + table() + "\n" + end + rest.split(end)[1])


if __name__ == "__main__":
    main()
