"""Published figures, laid out as in their papers: one table for each of the paper's, published, here and ratio in every cell."""

from load import listing, mapping, number
from rows import shortened

# Which key runs along the top, if a table has it.
ACROSS = ("spheres", "subject")


def variant_of(row: dict, keys: dict, with_scene: bool) -> str:
    """What measured a figure here, but for what the table's own keys tell."""
    told = [f"{k}={v}" for k, v in row["told"].items() if k not in keys]
    threads = f", {row['threads']:g} threads" if row["threads"] and row["threads"] > 1 else ""
    scene = f" on {shortened(row['scene'], 60)}" if with_scene else ""
    return shortened(" ".join([row["technique"], row["backend"], *told]), 120) + threads + scene


def lines_of(entry: dict, rows: dict) -> list[dict]:
    lines = []
    for line in map(mapping, listing(entry.get("lines"))):
        keys = {str(k): shortened(v, 80) for k, v in mapping(line.get("keys")).items() if v not in ("", None)}
        numbers = {key: number(line.get(key)) for key in ("published", "here", "ratio", "published_relative", "here_relative")}
        lines.append({"keys": keys, "device": shortened(line.get("device") or "", 60), "unit": shortened(line.get("unit") or "", 20),
                      "row": rows.get(line.get("row")), "stages": [shortened(s, 40) for s in listing(line.get("stages"))], **numbers})
    return lines


def body_of(lines: list[dict], across: str, down: list[str], columns: list[str]) -> list[dict]:
    """A line of the table for every group of keys and everything that measured some of them."""
    groups: dict[tuple, dict[str, dict]] = {}
    places = [(tuple(sorted(line["keys"].items())), line["device"], variant_of(line["row"], line["keys"], False)) for line in lines if line["row"]]
    with_scene = len(set(places)) < len(places)
    for line in lines:
        key = tuple(line["device"] if name == "device" else line["keys"].get(name, "") for name in down)
        variant = variant_of(line["row"], line["keys"], with_scene) if line["row"] else ""
        groups.setdefault(key, {}).setdefault(variant, {})[line["keys"].get(across, "")] = line
    body = []
    for key, variants in groups.items():
        known = {}  # what was published, whatever measured it here
        for cells in variants.values():
            known.update({column: {**line, "here": None, "ratio": None, "here_relative": None} for column, line in cells.items()})
        for variant, cells in variants.items():
            if variant or len(variants) == 1:
                body.append({"head": key, "variant": variant, "cells": [cells.get(column) or known.get(column) for column in columns]})
    return body


def laid_out(title: str, entry: dict, lines: list[dict]) -> dict:
    names = list(dict.fromkeys(name for line in lines for name in line["keys"] if name != "table"))
    across = next((name for name in ACROSS if name in names), names[-1] if names else "")
    down = [name for name in names if name != across]
    if len({line["device"] for line in lines}) > 1:
        down.append("device")
    columns = list(dict.fromkeys(line["keys"].get(across, "") for line in lines))
    figures = {(tuple(sorted(line["keys"].items())), line["device"]) for line in lines}
    measured = {(tuple(sorted(line["keys"].items())), line["device"]) for line in lines if line["here"] is not None}
    return {"title": title, "source": shortened(entry.get("source") or "", 80), "notes": [shortened(n, 400) for n in listing(entry.get("notes"))],
            "down": down, "across": across, "columns": columns, "unit": lines[0]["unit"],
            "stages": sorted({" + ".join(line["stages"]) for line in lines} - {""}), "measured": len(measured), "of": len(figures),
            "lines": body_of(lines, across, down, columns)}


def tables(figures: dict, rows: list[dict]) -> list[dict]:
    by_name = {row["name"]: row for row in rows}
    out = []
    for entry in map(mapping, listing(figures.get("published"))):
        by_table: dict[str, list[dict]] = {}
        for line in lines_of(entry, by_name):
            by_table.setdefault(line["keys"].get("table", ""), []).append(line)
        title = shortened(entry.get("title") or entry.get("source") or "published", 200)
        for name, lines in by_table.items():
            out.append(laid_out(f"{title}: table {name}" if name else title, entry, lines))
    return out


def points(figures: dict, rows: list[dict]) -> list[dict]:
    """Published times at the errors that the same rows have here."""
    by_name, place = {row["name"]: row for row in rows}, {row["name"]: k for k, row in enumerate(rows)}
    out = []
    for entry in map(mapping, listing(figures.get("published"))):
        for line in lines_of(entry, by_name):
            value = line["published"]
            # A time of some stages is not the time of a frame.
            if line["row"] is None or line["stages"] or not value or line["unit"] not in ("fps", "ms"):
                continue
            text = f"{shortened(entry.get('title') or '', 80)}: {line['device'] or 'published'}"
            out.append({"row": place[line["row"]["name"]], "ms": 1000 / value if line["unit"] == "fps" else value, "text": text})
    return out
