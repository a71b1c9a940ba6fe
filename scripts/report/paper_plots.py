"""The page's plots for a paper: matplotlib, SVG and PDF, black on white, the same bytes for the same run."""

import pathlib

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot, ticker

PALETTE = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8a8a8a", "#b8a800"]
MARKERS = "osD^vPX*hp<>"
MOST_BARS = 20
# Names are no mathematics; and no date or random name goes into a file.
matplotlib.rcParams.update({"text.parse_math": False, "svg.hashsalt": "penumbra", "pdf.fonttype": 42, "font.size": 8,
                            "axes.spines.top": False, "axes.spines.right": False, "svg.fonttype": "path"})


def save(figure, path: pathlib.Path) -> None:
    for ending, date in ((".svg", "Date"), (".pdf", "CreationDate")):
        figure.savefig(path.with_name(path.name + ending), bbox_inches="tight", metadata={date: None})
    pyplot.close(figure)


def logarithmic(axes) -> None:
    """Ticks at 1, 2 and 5, or 1 alone over many decades, as plain numbers."""
    axes.set(xscale="log", yscale="log")
    for axis in (axes.xaxis, axes.yaxis):
        low, high = axis.get_view_interval()
        parts = (1.0,) if high / low > 3000 else (1.0, 2.0, 5.0)
        axis.set_major_locator(ticker.LogLocator(subs=parts, numticks=20))
        axis.set_minor_locator(ticker.NullLocator())
        axis.set_major_formatter(ticker.FuncFormatter(lambda x, _: f"{x:g}"))


def style(techniques: list[str], technique: str, backend: str) -> dict:
    k = techniques.index(technique)
    colour = PALETTE[k % len(PALETTE)]
    return {"color": colour, "marker": MARKERS[k % len(MARKERS)], "markerfacecolor": colour if backend == "simd" else "white"}


def time_against_error(scene: dict, rows: list[dict], points: list[dict], techniques: list[str], path: pathlib.Path) -> None:
    shown = [rows[k] for k in scene["rows"] if rows[k]["status"] == "ok" and rows[k]["frame"] and rows[k]["error"]]
    if not shown:
        return
    figure, axes = pyplot.subplots(figsize=(5.5, 3.4))
    families: dict[tuple, list] = {}
    for row in shown:
        families.setdefault((row["technique"], row["backend"]), []).append(row)
    for (technique, backend), of in sorted(families.items()):
        axes.errorbar([r["frame"] for r in of], [100 * r["error"] for r in of], xerr=[r["spread"] for r in of], linestyle="none",
                      markersize=5, elinewidth=0.8, label=f"{technique} {backend}"[:60], **style(techniques, technique, backend))
    front = sorted((rows[k] for k in scene["pareto"] if rows[k]["frame"] and rows[k]["error"]), key=lambda r: r["frame"])
    axes.plot([r["frame"] for r in front], [100 * r["error"] for r in front], ":", color="0.4", linewidth=1, label="frontier", zorder=0)
    here = [p for p in points if rows[p["row"]]["scene"] == scene["name"] and rows[p["row"]]["error"]]
    if here:
        axes.plot([p["ms"] for p in here], [100 * rows[p["row"]]["error"] for p in here], linestyle="none", marker="x", color="0.3",
                  label="published time")
    logarithmic(axes)
    axes.set(xlabel="ms a frame", ylabel="error, % of truth")
    if scene["floor"]:
        low = min(axes.get_ylim()[0], 70 * scene["floor"])
        axes.axhspan(low, 100 * scene["floor"], color="0.9", zorder=-1)
        axes.set_ylim(bottom=low)
    axes.legend(fontsize=6, loc="upper left", bbox_to_anchor=(1.01, 1), frameon=False)
    save(figure, path)


def scaling(entries: list[dict], name: str, techniques: list[str], path: pathlib.Path) -> None:
    figure, axes = pyplot.subplots(figsize=(4.2, 3))
    before: dict[str, int] = {}  # lines of one technique differ by their dashes
    for entry in entries:
        nth = before[entry["technique"]] = before.get(entry["technique"], -1) + 1
        points = sorted((x, ms) for x, ms in entry["points"] if x > 0 and ms > 0)
        slope = entry.get("slope")
        label = f"{entry['technique']} {entry['backend']} ({entry.get('fixed') or ''})"[:90]
        if slope is not None:
            label += f": {slope:.2f}" + (f" ({entry['low']:.2f} to {entry['high']:.2f})" if entry.get("low") is not None else "")
        known = techniques if entry["technique"] in techniques else [*techniques, entry["technique"]]
        axes.plot([x for x, _ in points], [ms for _, ms in points], markersize=4, linewidth=1, label=label,
                  linestyle=["-", "--", ":", "-.", (0, (6, 1))][nth % 5], **style(known, entry["technique"], entry["backend"]))
    logarithmic(axes)
    axes.set(xlabel=name[:60], ylabel="ms a frame")
    axes.legend(fontsize=6, loc="upper left", bbox_to_anchor=(1.01, 1), frameon=False)
    save(figure, path)


def bars(rows: list[dict], series: list[tuple], label: str, path: pathlib.Path, stacked: bool) -> None:
    """`series`: a name, and the value of a row."""
    if not rows:
        return
    rows = sorted(rows, key=lambda r: r["frame"] or 0)[:MOST_BARS][::-1]
    figure, axes = pyplot.subplots(figsize=(5.5, 0.6 + 0.26 * len(rows)))
    left = [0.0] * len(rows)
    height = 0.7 if stacked else 0.8 / len(series)
    for n, (name, value) in enumerate(series):
        values = [value(row) or 0.0 for row in rows]
        y = [k if stacked else k + 0.4 - height * (n + 0.5) for k in range(len(rows))]
        axes.barh(y, values, height, left=left if stacked else None, color=PALETTE[n % len(PALETTE)],
                  hatch=["", "//", "..", "xx"][n % 4], edgecolor="white", linewidth=0.4, label=name[:60])
        left = [a + b for a, b in zip(left, values)]
    axes.set_yticks(range(len(rows)), [row["label"][:60] for row in rows], fontsize=6)
    axes.set_xlabel(label)
    axes.legend(fontsize=6, frameon=False, loc="upper left", bbox_to_anchor=(1.01, 1))
    save(figure, path)
