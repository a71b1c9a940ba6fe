"""Rows as the page holds them: short keys, numbers or null, texts that fit on a screen."""

from load import Run, listing, mapping, number

LONGEST_TEXT = 300  # characters of anything that people named; the whole is in the file to download
REGIONS = ("umbra", "penumbra", "lit")


def shortened(text, longest=LONGEST_TEXT) -> str:
    text = str(text)
    return text if len(text) <= longest else text[:longest - 1] + "…"


def told(row: dict) -> dict:
    """Parameters that are not at their defaults."""
    defaults = mapping(row.get("defaults"))
    return {name: value for name, value in mapping(row.get("parameters")).items() if value != defaults.get(name)}


def value_text(value) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def spheres_text(row: dict) -> str:
    if not row.get("reads_spheres") or not row.get("spheres"):
        return ""
    return f"{row['spheres']} {row.get('objective') or ''}".strip()


def labels(rows: list[dict]) -> list[str]:
    """What tells rows of one scene apart: technique, parameters, and whatever else differs."""
    texts = [shortened(" ".join([row["technique"]] + [f"{k}={value_text(v)}" for k, v in told(row).items()]), 160)
             for row in rows]
    threads: dict[tuple, set] = {}
    for row in rows:
        threads.setdefault((row["technique"], row["backend"]), set()).add(row.get("threads"))
    sphere_counts = {spheres_text(row) for row in rows} - {""}
    for k, row in enumerate(rows):
        texts[k] += f" · {shortened(row['backend'], 40)}"
        if len(sphere_counts) > 1 and spheres_text(row):
            texts[k] += f" · {spheres_text(row)} spheres"
        if len(threads[row["technique"], row["backend"]]) > 1:
            texts[k] += f" · {row.get('threads')} threads"
    return texts


def errors_of(report: dict) -> dict:
    keys = ("receivers", "rmse", "rel_rmse", "psnr", "ssim", "flip", "max", "mean_signed", "negative", "rel_noise")
    return {key: number(report.get(key)) for key in keys if key in report}


def parts_of(row: dict) -> list[list]:
    """What a row's error is made of, as far as its rungs tell: cutting light and visibility into texels, spheres in place of
    the mesh, and what the technique adds itself, each relative to the truth."""
    rungs = {name: errors.get("rel_rmse") for name, errors in row["rungs"].items()}
    truth, cube, spheres = (rungs.get(name) for name in ("truth", "cube", "spheres"))
    if truth is None:
        return []
    parts = []
    if cube is not None and cube < truth:
        parts.append(["texels", (truth - cube) ** 0.5 * (truth + cube) ** 0.5])
    on_spheres = row["reads_spheres"] and row["backend"] != "external" and spheres is not None  # of an image alone nobody knows
    if on_spheres and row["geometry"] is not None:
        parts.append(["spheres in place of the mesh", row["geometry"]])
    own = spheres if on_spheres else cube if cube is not None and cube < truth else truth
    steps = [(share or 0, name) for name, _, share in row["steps"]]
    return parts + [["the technique's " + max(steps)[1] if steps else "the technique itself", own]]


def page_row(row: dict, label: str) -> dict:
    out = fields_of(row, label)
    out["parts"] = parts_of(out)
    return out


def fields_of(row: dict, label: str) -> dict:
    errors = mapping(row.get("errors"))
    truth = mapping(errors.get("truth"))
    noise = number(truth.get("rel_noise"))
    samples = [s for s in map(number, listing(mapping(row.get("samples")).get("frame_ms"))) if s]
    return {
        "name": row["name"], "label": label, "scene": row["scene"], "technique": row["technique"],
        "backend": row["backend"], "status": shortened(row["status"], 600), "threads": number(row.get("threads")),
        "set": shortened(row.get("instruction_set") or "", 40),
        "parameters": {shortened(k, 60): v if number(v) is not None else shortened(v, 60)
                       for k, v in mapping(row.get("parameters")).items()},
        "told": {shortened(k, 60): shortened(value_text(v), 60) for k, v in told(row).items()},
        "spheres": number(row.get("spheres")), "reads_spheres": bool(row.get("reads_spheres")),
        "objective": shortened(row.get("objective") or "", 40), "receivers": number(row.get("receivers")),
        "frame": number(row.get("frame_ms")), "spread": number(row.get("frame_spread_ms")) or 0,
        "least": min(samples, default=None), "greatest": max(samples, default=None),
        "repetitions": number(row.get("repetitions")),
        "prepare": number(row.get("prepare_ms")), "update": number(row.get("update_ms")), "shade": number(row.get("shade_ms")),
        "view": number(row.get("view_ms")), "moves": bool(row.get("sequence")),
        "stages": [[shortened(s.get("name"), 60), number(s.get("ms"))] for s in map(mapping, listing(row.get("stages")))],
        "bytes": number(row.get("bytes")),
        "footprint": {k: number(v) for k, v in mapping(row.get("footprint")).items()},
        "error": number(truth.get("rel_rmse")), "noise": noise, "floor": (noise or 0) * 2 ** 0.5, "tie": bool(truth.get("tie")),
        "rungs": {shortened(k, 40): errors_of(mapping(v)) for k, v in errors.items()},
        "regions": {k: errors_of(mapping(mapping(truth.get("regions")).get(k))) for k in REGIONS},
        "steps": [[shortened(s.get("name"), 60), number(s.get("rel_rmse")), number(s.get("share"))]
                  for s in map(mapping, listing(row.get("steps")))],
        "geometry": number(row.get("geometry_rel_rmse")), "parity": number(row.get("parity_rel_rmse")),
        "counters": {shortened(k, 40): number(v) for k, v in mapping(row.get("counters")).items()},
        "image": None, "missing": "",
    }


def page_rows(run: Run) -> list[dict]:
    by_scene: dict[str, list[dict]] = {}
    for row in run.rows:
        by_scene.setdefault(row["scene"], []).append(row)
    label = {}
    for rows in by_scene.values():
        label.update({row["name"]: text for row, text in zip(rows, labels(rows))})
    return [page_row(row, label[row["name"]]) for row in run.rows]
