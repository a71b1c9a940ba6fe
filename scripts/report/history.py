"""Medians of rows over the runs of one machine; runs of others are listed, and in no plot."""

from load import Run
from rows import shortened


def about(run: Run) -> dict:
    return {"date": run.date[:19], "commit": run.commit, "machine": shortened(run.machine_text, 160),
            "rows": len(run.rows), "busy": bool(run.context.get("busy")), "file": shortened(run.path.parent.name, 80)}


def view(run: Run, rows: list[dict], runs: list[Run]) -> dict:
    files = {r.path.resolve(): r for r in [*runs, run]}
    same = sorted((r for r in files.values() if r.machine == run.machine), key=lambda r: r.date)
    others = [r for r in files.values() if r.machine != run.machine]
    known = {row["name"]: k for k, row in enumerate(rows)}
    series: dict[int, list] = {}
    for place, one in enumerate(same):
        for row in one.rows:
            if row["name"] in known and row["status"] == "ok" and row.get("frame_ms"):
                series.setdefault(known[row["name"]], []).append([place, row["frame_ms"], row.get("frame_spread_ms") or 0])
    return {"runs": [about(r) for r in same], "others": [about(r) for r in sorted(others, key=lambda r: r.date)],
            "series": series, "gone": sorted({shortened(row["name"], 200) for r in same for row in r.rows if row["name"] not in known})}
