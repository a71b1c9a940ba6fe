"""Puts the page together: data, templates, scripts and styles become one file that asks no network for anything."""

import base64
import gzip
import json
import pathlib

import jinja2
from plotly.offline import get_plotlyjs

import compare
import history
import published
import words
from images import Picture, exposure_of, fit, read_exr
from load import Run, listing, mapping, number, within
from rows import page_rows, shortened

HERE = pathlib.Path(__file__).resolve().parent
# The order in which scripts know each other.
SCRIPTS = ["util", "codec", "colours", "flip", "choice", "state", "controls", "answer", "tables", "plots", "pointer", "figures",
           "viewer", "panels", "history", "main"]
STYLES = ["page", "parts", "viewer"]
IMAGE_BUDGET = 18 << 20  # bytes on the page; with tables, plotly.js and raw data it stays below 25 MB


def json_for_html(value) -> str:
    """JSON that may stand within <script>: nothing in it ends the element or a line of it."""
    text = json.dumps(value, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    for character in "<>&\u2028\u2029":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return text.encode("utf-8", "replace").decode("utf-8")


def squeezed(data: bytes) -> str:
    return base64.b64encode(gzip.compress(data, 9, mtime=0)).decode()


class Gallery:
    """The images that the page needs, each once, in the order of their numbers."""

    def __init__(self):
        self.pictures: list[Picture] = []
        self.known: dict[pathlib.Path, tuple] = {}  # number and reason
        self.exposures: dict[pathlib.Path, float] = {}

    def exposure(self, folder: pathlib.Path) -> float:
        if folder not in self.exposures:
            try:
                self.exposures[folder] = exposure_of(read_exr(folder / "truth.exr"), folder / "truth.png")
            except Exception:
                self.exposures[folder] = 0.0
        return self.exposures[folder]

    def add(self, stem: pathlib.Path):
        """The number of an image and "", or None and why there is none."""
        if stem not in self.known:
            self.known[stem] = self._read(stem)
        return self.known[stem]

    def _read(self, stem: pathlib.Path):
        file = stem.parent / f"{stem.name}.exr"
        try:
            there = file.exists()
        except OSError as e:  # a name that is too long
            return None, f"its image {shortened(file.name, 120)} cannot be looked for ({e.strerror})"
        if not there:
            return None, f"its image {shortened(file.name, 120)} is missing"
        try:
            pixels = read_exr(file)
        except Exception as e:
            return None, f"its image {shortened(file.name, 120)} cannot be read ({type(e).__name__})"
        if min(pixels.shape[:2]) < 2:
            return None, "its receivers are vertices: there is no picture"
        exposure = self.exposure(stem.parent) or exposure_of(pixels, pathlib.Path())
        self.pictures.append(Picture(pixels, exposure))
        return len(self.pictures) - 1, ""


def add_images(run: Run, rows: list[dict], gallery: Gallery) -> dict:
    """Gives rows the numbers of their images. Returns those of the truths, by scene and spheres' folder."""
    truths = {}
    for row, raw in zip(rows, run.rows):
        if not raw.get("image"):
            row["missing"] = "no image was kept"
            continue
        stem = within(run.folder, raw["image"])
        if stem is None:
            row["missing"] = "its image lies outside of the folder of results"
            continue
        truth, _ = gallery.add(stem.parent / "truth")
        row["image"], row["missing"] = gallery.add(stem)
        row["truth"] = truth
        if truth is not None:
            truths.setdefault(row["scene"], truth)
    return truths


def scenes_of(rows: list[dict], figures: dict, truths: dict) -> list[dict]:
    derived = {f.get("scene"): f for f in map(mapping, listing(figures.get("scenes")))}
    place = {row["name"]: k for k, row in enumerate(rows)}
    scenes = []
    for name in dict.fromkeys(row["scene"] for row in rows):
        f = mapping(derived.get(name))
        numbers = lambda names: [place[n] for n in listing(names) if n in place]
        entries = [e for e in map(mapping, listing(f.get("speed_up"))) if e.get("row") in place]
        scenes.append({
            "name": name, "title": shortened(name, 80), "rows": [k for k, r in enumerate(rows) if r["scene"] == name],
            "noise": number(f.get("truth_noise")), "floor": number(f.get("floor")), "pareto": numbers(f.get("pareto")),
            "ray_traced": numbers(f.get("ray_traced")), "truth": truths.get(name),
            "cheapest": {str(e["limit"]): place.get(e.get("row")) for e in map(mapping, listing(f.get("cheapest"))) if "limit" in e},
            "speed_up": {place[e["row"]]: words.speed_up_text(e) for e in entries
                         if e["row"] not in listing(f.get("ray_traced"))},
            "families": [mapping(x) for x in listing(f.get("families"))],
            "scaling": [mapping(s) for s in listing(f.get("scaling"))],
            "break_even": [mapping(s) for s in listing(f.get("break_even"))]})
    return scenes


def answers(rows: list[dict], scenes: list[dict], limits: list[float]) -> list[dict]:
    """The verdict: per scene the fastest row within every limit."""
    out = []
    for scene in scenes:
        cells = []
        for limit in limits:
            k = scene["cheapest"].get(str(limit))
            cells.append(None if k is None else
                         {"row": rows[k], "speed": scene["speed_up"].get(k, ""), "source": words.source_of(rows[k])})
        out.append({"scene": scene, "cells": cells})
    return out


def build(run: Run, figures: dict, base: Run | None, comparison: dict | None, runs: list[Run], budget: int = IMAGE_BUDGET) -> str:
    rows = page_rows(run)
    gallery = Gallery()
    truths = add_images(run, rows, gallery)
    scenes = scenes_of(rows, figures, truths)
    limits = [x for x in map(number, listing(figures.get("limits"))) if x] or [0.01, 0.02, 0.03, 0.1]
    changes = compare.view(run, rows, base, comparison, gallery) if comparison is not None else None
    past = history.view(run, rows, runs) if runs else None
    halved = fit(gallery.pictures, budget)

    for row in rows:
        row["source"] = words.source_of(row)
    data = {"rows": rows, "scenes": scenes, "limits": limits, "images": [p.about() for p in gallery.pictures],
            "extra": changes["pictures"] if changes else [], "history": past, "suite": str(run.context.get("suite", "run")),
            "receivers_scaling": [mapping(s) for s in listing(figures.get("receivers_scaling"))]}
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(HERE / "templates"), autoescape=True,
                                     undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    environment.filters.update(ms=words.ms, percent=words.percent, size=words.size, figure=words.figure, short=shortened)
    tables = published.tables(figures, rows)
    data["published_points"] = published.points(figures, rows)
    raw = run.path.read_bytes()
    return environment.get_template("page.html").render(
        run=run, context=run.context, rows=rows, scenes=scenes, limits=limits, answers=answers(rows, scenes, limits),
        unmeasured=[row for row in rows if row["status"] != "ok"], changes=changes, past=past, published=tables,
        warnings=words.machine_warnings(run.context) + words.name_warnings(rows, figures), load=words.load_text(run.context), halved=halved,
        figures_missing=not figures, missing=[r for r in rows if r["status"] == "ok" and r["image"] is None],
        techniques=sorted({r["technique"] for r in rows}), backends=sorted({r["backend"] for r in rows}),
        style="\n".join((HERE / "css" / f"{name}.css").read_text() for name in STYLES),
        script="\n".join((HERE / "js" / f"{name}.js").read_text() for name in SCRIPTS),
        data=json_for_html(data), images=[base64.b64encode(p.data).decode() for p in gallery.pictures],
        raw=squeezed(raw), plotly=squeezed(get_plotlyjs().encode()))
