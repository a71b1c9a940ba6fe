"""Published figures, laid out as in their papers: one table for each of the paper's, published, here and ratio in every cell."""

from load import listing, mapping, number
from rows import shortened

# Which key runs along the top, if a table has it.
ACROSS = ("spheres", "subject")


def lines_of(entry: dict, rows: set) -> list[dict]:
    lines = []
    for line in map(mapping, listing(entry.get("lines"))):
        keys = {str(k): shortened(v, 80) for k, v in mapping(line.get("keys")).items() if v not in ("", None)}
        lines.append({"keys": keys, "device": shortened(line.get("device") or "", 60), "published": number(line.get("published")),
                      "unit": shortened(line.get("unit") or "", 20), "here": number(line.get("here")),
                      "ratio": number(line.get("ratio")), "row": line.get("row") if line.get("row") in rows else None})
    return lines


def laid_out(title: str, source: str, lines: list[dict]) -> dict:
    names = list(dict.fromkeys(name for line in lines for name in line["keys"] if name != "table"))
    across = next((name for name in ACROSS if name in names), names[-1] if names else "")
    down = [name for name in names if name != across]
    if len({line["device"] for line in lines}) > 1:
        down.append("device")
    columns = list(dict.fromkeys(line["keys"].get(across, "") for line in lines))
    body: dict[tuple, dict] = {}
    for line in lines:
        key = tuple(line["device"] if name == "device" else line["keys"].get(name, "") for name in down)
        body.setdefault(key, {}).setdefault(line["keys"].get(across, ""), line)
    return {"title": title, "source": source, "down": down, "across": across, "columns": columns, "unit": lines[0]["unit"],
            "lines": [{"head": key, "cells": [cells.get(column) for column in columns]} for key, cells in body.items()],
            "measured": sum(line["here"] is not None for line in lines), "of": len(lines)}


def tables(figures: dict, rows: list[dict]) -> list[dict]:
    names = {row["name"] for row in rows}
    out = []
    for entry in map(mapping, listing(figures.get("published"))):
        by_table: dict[str, list[dict]] = {}
        for line in lines_of(entry, names):
            by_table.setdefault(line["keys"].get("table", ""), []).append(line)
        title = shortened(entry.get("title") or entry.get("source") or "published", 200)
        for number_, lines in by_table.items():
            out.append(laid_out(f"{title}: table {number_}" if number_ else title, shortened(entry.get("source") or "", 80), lines))
    return out


def points(figures: dict, rows: list[dict]) -> list[dict]:
    """Published times at the errors that the same rows have here."""
    place = {row["name"]: k for k, row in enumerate(rows)}
    out = []
    for entry in map(mapping, listing(figures.get("published"))):
        for line in lines_of(entry, set(place)):
            value = line["published"]
            if line["row"] is None or not value or line["unit"] not in ("fps", "ms"):
                continue
            text = f"{shortened(entry.get('title') or '', 80)}: {line['device'] or 'published'}"
            out.append({"row": place[line["row"]], "ms": 1000 / value if line["unit"] == "fps" else value, "text": text})
    return out
