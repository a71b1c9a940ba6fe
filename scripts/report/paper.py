"""Plots and tables of a run for a paper: SVG, PDF, and LaTeX for \\usepackage{booktabs}, with what they cite.

    time-error-SCENE.svg, .pdf    scaling-SCENE-AXIS   parts-SCENE   stages-SCENE
    rows-SCENE.tex, answers.tex, published-N.tex       \\input them; citations.bib holds what they cite
"""

import pathlib
import re

import pandas

import paper_plots
import published
import words
from load import Run, listing, mapping
from rows import page_rows, shortened

SPECIAL = {"\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "<": r"\textless{}", ">": r"\textgreater{}",
           "|": r"\textbar{}", '"': "''", **{c: "\\" + c for c in "&%$#_{}"}}


def tex(text) -> str:
    """Text that LaTeX prints as it is; no command can be in it."""
    plain = "".join(c if c.isprintable() else " " for c in str(text))
    guard = "{}" if plain[:1] in ("[", "*") else ""  # LaTeX's line break would take them
    return guard + "".join(SPECIAL.get(c, c) for c in plain).replace("±", r"$\pm$").replace("–", "--").replace("·", r"$\cdot$").replace("…", r"\dots{}") \
        .replace("×", r"$\times$").replace("≤", r"$\le$").replace("°", r"$^\circ$")


def slug(text: str, taken: set) -> str:
    """A file's name; two texts never get one."""
    name = base = re.sub(r"[^A-Za-z0-9]+", "-", text).strip("-")[:60] or "unnamed"
    k = 2
    while name.lower() in taken:
        name, k = f"{base}-{k}", k + 1
    taken.add(name.lower())
    return name


class Citations:
    """Keys of what is cited, and the file that explains them."""

    def __init__(self, figures: dict):
        self.texts = {str(k): str(v) for k, v in mapping(figures.get("citations")).items() if v and not str(v).startswith("none")}
        self.keys: dict[str, str] = {}
        self.taken: set = set()

    def key(self, text: str) -> str:
        if text not in self.keys:
            words_ = re.findall(r"[A-Za-z]+|\d{4}", text)
            year = next((w for w in words_ if w.isdigit()), "")
            self.keys[text] = slug((words_[0].lower() if words_ else "source") + year, self.taken)
        return self.keys[text]

    def cite(self, technique: str) -> str:
        """A LaTeX command, or nothing for what is nobody's."""
        return rf" \cite{{{self.key(self.texts[technique])}}}" if technique in self.texts else ""

    def bib(self) -> str:
        return "".join(f"@misc{{{key},\n  title = {{{{{tex(text)}}}}}\n}}\n" for text, key in self.keys.items())


def latex(frame: pandas.DataFrame, right: set) -> str:
    """A booktabs table; the cells are LaTeX already."""
    columns = "".join("r" if name in right else "l" for name in frame.columns)
    return frame.style.hide(axis="index").to_latex(hrules=True, column_format=columns)


def rows_table(rows: list[dict], citations: Citations) -> str:
    lines = []
    for row in sorted(rows, key=lambda r: (r["frame"] is None, r["frame"] or 0)):
        told = row["label"][len(row["technique"]):] if row["label"].startswith(row["technique"]) else " " + row["label"]
        lines.append({"technique": tex(shortened(row["technique"], 60)) + citations.cite(row["technique"]), "parameters": tex(told.strip(" ·")),
                      "ms": tex(f"{row['frame']:.3g} ± {row['spread']:.2g}") if row["frame"] is not None else "--",
                      r"error \%": tex("tie" if row["tie"] else f"{100 * row['error']:.3g}") if row["error"] is not None else "--",
                      "FLIP": tex(words.figure(mapping(row["rungs"].get("truth")).get("flip"))), "memory": tex(words.size(row["bytes"]))})
    return latex(pandas.DataFrame(lines), {"ms", r"error \%", "FLIP", "memory"})


def answers_table(scenes: list[dict], rows: list[dict], limits: list[float], citations: Citations) -> str:
    lines = []
    for scene in scenes:
        line = {"scene": tex(scene["title"])}
        for limit in limits:
            k = scene["cheapest"].get(str(limit))
            line[rf"$\le {100 * limit:g}$\,\%"] = "--" if k is None else \
                tex(f"{rows[k]['label']}, {words.ms(rows[k]['frame'])}") + citations.cite(rows[k]["technique"])
        lines.append(line)
    return latex(pandas.DataFrame(lines), set())


def published_table(table: dict, citations: Citations) -> str:
    lines = []
    for line in table["lines"]:
        cells = {("", tex(name)): tex(value) for name, value in zip(table["down"], line["head"])}
        cells["", "measured here"] = tex(line["variant"] or "–")
        for column, cell in zip(table["columns"], line["cells"]):
            head = tex(f"{column} {table['across']}" if table["across"] == "spheres" else column or "figure")
            for name in ("published", "here", "ratio"):
                cells[head, name] = tex(words.figure(cell[name])) if cell else "--"
        lines.append(cells)
    frame = pandas.DataFrame(lines)
    frame.columns = pandas.MultiIndex.from_tuples(frame.columns)
    text = frame.style.hide(axis="index").to_latex(hrules=True, multicol_align="c", column_format="l" * (len(table["down"]) + 1) + "r" * (
        len(frame.columns) - len(table["down"]) - 1))
    source = rf"\multicolumn{{{len(frame.columns)}}}{{l}}{{{tex(table['title'])}, {tex(table['unit'])} \cite{{{citations.key(table['title'])}}}}} \\"
    return text.replace("\\bottomrule", f"\\midrule\n{source}\n\\bottomrule")


def write(run: Run, figures: dict, folder: pathlib.Path) -> None:
    from page import scenes_of
    folder.mkdir(parents=True, exist_ok=True)
    rows = page_rows(run)
    scenes, citations, taken = scenes_of(rows, figures, {}), Citations(figures), set()
    points, techniques = published.points(figures, rows), sorted({row["technique"] for row in rows})
    save = lambda name, text: (folder / name).write_text(text, encoding="utf-8")
    for scene in scenes:
        name, of = slug(scene["name"], taken), [rows[k] for k in scene["rows"] if rows[k]["status"] == "ok"]
        if not of:
            continue
        save(f"rows-{name}.tex", rows_table(of, citations))
        paper_plots.time_against_error(scene, rows, points, techniques, folder / f"time-error-{name}")
        axes: dict[str, list] = {}
        for entry in scene["scaling"]:
            if listing(entry.get("points")):
                axes.setdefault(str(entry.get("axis")), []).append(entry)
        for axis, entries in axes.items():
            paper_plots.scaling(entries, axis, techniques, folder / f"scaling-{name}-{slug(axis, set())}")
        part = lambda n: lambda row: 100 * (dict(row["parts"]).get(n) or 0)
        own = lambda row: 100 * (row["parts"][-1][1] or 0)
        paper_plots.bars([r for r in of if r["parts"]], [("texels", part("texels")), ("spheres", part("spheres in place of the mesh")),
                                                         ("technique", own)], "error that each part has alone, %", folder / f"parts-{name}", False)
        stages = lambda row: dict(map(tuple, row["stages"] or [["update", row["update"]], ["shade", row["shade"]]]))
        names = list(dict.fromkeys(n for row in of for n in stages(row)))
        paper_plots.bars([r for r in of if r["frame"]], [(n, lambda row, n=n: stages(row).get(n)) for n in names], "ms of a frame",
                         folder / f"stages-{name}", True)
    receivers = [e for e in map(mapping, listing(figures.get("receivers_scaling"))) if listing(e.get("points"))]
    if receivers:
        paper_plots.scaling(receivers, "receivers", techniques, folder / "scaling-receivers")
    limits = sorted({float(limit) for scene in scenes for limit in scene["cheapest"]})
    save("answers.tex", answers_table(scenes, rows, limits, citations))
    for k, table in enumerate(published.tables(figures, rows), 1):
        save(f"published-{k}.tex", published_table(table, citations))
    save("citations.bib", citations.bib())
