"""What `penumbra compare` found, worst first, with pictures of rows whose error changed."""

import math

import numpy

from images import LUMINANCE, read_exr, thumbnail
from load import Run, listing, mapping, number, within
from rows import page_rows, shortened
import words

MOST_PICTURES = 40
RANGE = 0.25  # of white, where a signed error has its full colour


def signed_error(image: numpy.ndarray, reference: numpy.ndarray, exposure: float) -> numpy.ndarray:
    """Red where the image is brighter, blue where it is darker."""
    e = numpy.clip((numpy.nan_to_num(image) - numpy.nan_to_num(reference)) @ LUMINANCE * exposure / RANGE, -1, 1)
    fade = 1 - numpy.abs(e)
    return numpy.stack([numpy.where(e >= 0, 1, fade), fade, numpy.where(e >= 0, fade, 1)], axis=-1)


def severity(row: dict) -> tuple:
    """Larger is worse: regressions, then what is slower or has more error, by how much."""
    time, error = mapping(row.get("time")), mapping(row.get("error"))
    broken = bool(row.get("status"))
    rise = math.log(number(time.get("ratio")) or 1) if time.get("verdict") in ("slower", "faster") else 0
    grown = math.log(number(error.get("factor")) or 1) if error.get("verdict") in ("worse", "better") else 0
    unknown = "unknown" in (time.get("verdict"), error.get("verdict"))
    return (broken, bool(row.get("regressed")), max(rise, grown, 0), unknown, max(abs(rise), abs(grown)))


def line_of(row: dict, label: dict) -> dict:
    time, error = mapping(row.get("time")), mapping(row.get("error"))
    interval = [number(x) for x in listing(time.get("interval"))]
    name = str(row.get("name"))
    verdicts = [shortened(v, 40) for v in (time.get("verdict"), error.get("verdict")) if v]
    return {"name": name, "label": label.get(name, shortened(name)), "regressed": bool(row.get("regressed")),
            "broken": shortened(row.get("status") or "", 300), "time": shortened(time.get("verdict") or "", 40),
            "error": shortened(error.get("verdict") or "", 40), "base_ms": number(time.get("base_ms")), "new_ms": number(time.get("new_ms")),
            "ratio": number(time.get("ratio")) if time.get("verdict") != "not comparable" else None,
            "interval": interval if len(interval) == 2 and None not in interval else None,
            "rung": shortened(error.get("rung") or "", 40), "base_error": number(error.get("base")), "new_error": number(error.get("new")),
            "why": shortened(time.get("why") or error.get("why") or "", 300),
            "changed": bool(row.get("status")) or any(v not in ("same", "not comparable") for v in verdicts), "pictures": None}


def view(run: Run, rows: list[dict], base: Run | None, comparison: dict, gallery) -> dict:
    label = {row["name"]: f"{shortened(row['scene'], 60)}: {row['label']}" for row in rows}
    ordered = sorted(map(mapping, listing(comparison.get("rows"))), key=severity, reverse=True)
    lines = [line_of(row, label) for row in ordered]
    pictures = add_pictures(run, rows, base, lines, gallery) if base else []
    return {"verdict": shortened(comparison.get("verdict") or "no verdict", 400), "exit_code": comparison.get("exit_code"),
            "notes": [shortened(n, 400) for n in listing(comparison.get("notes"))],
            "added": [shortened(n, 200) for n in listing(comparison.get("added"))],
            "removed": [shortened(n, 200) for n in listing(comparison.get("removed"))],
            "lines": [line for line in lines if line["changed"]], "same": [line for line in lines if not line["changed"]],
            "pictures": pictures, "base": base, "other_machine": bool(base and base.machine != run.machine)}


def add_pictures(run: Run, rows: list[dict], base: Run, lines: list[dict], gallery) -> list[dict]:
    """Base, new and difference of rows whose error changed. Returns the base's images for the viewer."""
    now = {row["name"]: row for row in rows}
    then = {row["name"]: raw for row, raw in zip(page_rows(base), base.rows)}
    extra = []
    for line in lines:
        if line["error"] not in ("worse", "better") or line["name"] not in now or len(extra) == MOST_PICTURES:
            continue
        stems = [within(folder, raw.get("image")) if raw.get("image") else None
                 for folder, raw in ((base.folder, mapping(then.get(line["name"]))),
                                     (run.folder, next(r for r in run.rows if r["name"] == line["name"])))]
        if None in stems:
            continue
        numbers = [gallery.add(stem)[0] for stem in stems]
        if None in numbers or gallery.pictures[numbers[0]].pixels.shape != gallery.pictures[numbers[1]].pixels.shape:
            continue
        before, after = (read_exr(stem.parent / f"{stem.name}.exr") for stem in stems)
        exposure = gallery.pictures[numbers[1]].exposure
        row = now[line["name"]]
        extra.append({"scene": row["scene"], "title": f"base: {row['label']}", "image": numbers[0], "row": rows.index(row)})
        line["pictures"] = {"base": gallery.pictures[numbers[0]].thumbnail, "new": gallery.pictures[numbers[1]].thumbnail,
                            "difference": thumbnail(signed_error(after, before, exposure), 1.0), "extra": len(extra) - 1}
    return extra
