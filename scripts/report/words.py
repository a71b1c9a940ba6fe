"""Sentences and numbers for people."""


def ms(value) -> str:
    if value is None:
        return "–"
    return f"{value:.3g} ms" if value < 1000 else f"{value / 1000:.3g} s"


def percent(value) -> str:
    return "–" if value is None else f"{100 * value:.3g} %"


def size(value) -> str:
    if value is None:
        return "–"
    for unit in ("B", "kB", "MB"):
        if value < 1000:
            return f"{value:.3g} {unit}"
        value /= 1000
    return f"{value:.3g} GB"


def factor(value) -> str:
    """Of a speed: 3.1 or 1/3.1."""
    if value is None:
        return "–"
    return f"{value:.2g}" if value >= 1 else f"{value:.2g}" if value > 0.1 else f"1/{1 / value:.2g}"


def figure(value) -> str:
    return "–" if value is None else f"{value:.3g}"


def source_of(row: dict) -> str:
    """Which part of a row's error is the largest."""
    parts = [(value, name) for name, value in row["parts"] if value]
    if row["tie"]:
        return "within the reference's noise"
    if not parts:
        return ""
    value, name = max(parts)
    return f"mostly {name} ({percent(value)})"


def speed_up_text(entry) -> str:
    if not entry:
        return ""
    if entry.get("factor") is not None:
        value, bound = entry["factor"], str(entry.get("bound") or "")
        opposite = {"at least": "at most", "at most": "at least"}.get(bound, bound)
        if value >= 1:
            return f"{bound} {value:.3g} times as fast as ray tracing at equal error".strip()
        return " ".join(f"ray tracing is {opposite} {1 / value:.3g} times as fast at equal error".split())
    return "no speed-up over ray tracing can be said: " + str(entry.get("refused", "not measured"))


def machine_warnings(context: dict) -> list[str]:
    said = []
    if context.get("busy"):
        said.append("The machine had other work while this was measured: times are those of a busy machine.")
    if str(context.get("dirty")).lower() == "true":
        said.append("The program had changes that no commit holds.")
    return said


def name_warnings(rows: list[dict], figures: dict) -> list[str]:
    """Figures name rows as this version does; a file of an older one may call them otherwise."""
    names = {row["name"] for row in rows}
    derived = [name for scene in figures.get("scenes") or [] for name in (scene.get("rows") or [])]
    lost = sum(name not in names for name in derived)
    return [] if not lost else [f"{lost} rows have names of another version of penumbra: frontiers, speed-ups and the table of the fastest "
                                "leave them out. `penumbra report --figures` prints these."]


def load_text(context: dict) -> str:
    load = context.get("load_avg")
    if not isinstance(load, list) or not load:
        return "not known"
    text = ", ".join(f"{x:.2f}" for x in load if isinstance(x, (int, float)))
    return f"{text} (over 1, 5, 15 minutes){'; busy' if context.get('busy') else ''}"
