"""Made-up runs for tests and measurements of the report: a folder like one that `penumbra run` writes, and the figures that
`penumbra report` derives from it, by a plain second writing of their rules.

    .venv/bin/python tests/report/made_results.py OUT --rows 1000 --images 200
"""

import argparse
import json
import math
import pathlib
import random
import statistics

import numpy
import OpenEXR

LIMITS = [0.01, 0.02, 0.03, 0.1]
NOISE = 0.002
EXPOSURE = 0.8
TECHNIQUES = [  # name, backends, parameter, values, ms at the first value, ms power, error at the first value, error power
    ("ray-traced", ["simd", "scalar"], "rays", [4, 16, 64, 256], 1.0, 1.0, 0.14, -0.5),
    ("pixel-basis", ["simd", "scalar"], "visibility", ["table", "raster"], 3.0, 0.8, 0.031, -0.4),
    ("wavelet", ["simd"], "terms", [50, 100, 200, 400], 2.0, 0.4, 0.11, -0.7),
    ("sh-lighting", ["simd"], "order", [3, 4, 6], 0.08, 0.5, 0.09, -0.8),
    ("pcss", ["simd", "cuda"], "samples", [16, 64], 0.4, 0.9, 0.05, -0.2),
]


def write_exr(path: pathlib.Path, pixels: numpy.ndarray) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    channels = {"RGB": numpy.ascontiguousarray(pixels, numpy.float32)}
    OpenEXR.File({"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}, channels).write(str(path))


def shadow(size: int, softness: float, rng: numpy.random.Generator, noise: float) -> numpy.ndarray:
    """A soft disc of shadow on a tinted plane."""
    y, x = numpy.mgrid[0:size, 0:size] / size - 0.5
    light = 1 / (1 + numpy.exp(-(numpy.hypot(x, y * 1.3) - 0.25) / softness))
    plane = (0.15 + 0.85 * light)[..., None] * numpy.array([1.0, 0.95, 0.85]) * (1 + 0.1 * x[..., None])
    return (plane * (1 + noise * rng.standard_normal((size, size, 1)))).astype(numpy.float32)


def errors_of(error: float, receivers: int) -> dict:
    region = lambda share, factor: {"receivers": int(receivers * share), "rmse": error * factor, "rel_rmse": error * factor,
                                    "psnr": 30.0, "max": error * 4, "mean_signed": 0.1 * error, "negative": 0, "ssim": 0.99,
                                    "flip": error / 2}
    whole = region(1.0, 1.0)
    whole.update(noise=NOISE, rel_noise=NOISE, tie=error < NOISE * math.sqrt(2),
                 regions={"umbra": region(0.1, 1.6), "penumbra": region(0.3, 1.2), "lit": region(0.6, 0.7)})
    return whole


class Made:
    """Rows and images as they grow; write() puts them into a folder."""

    def __init__(self, seed: int = 1):
        self.random = random.Random(seed)
        self.rng = numpy.random.default_rng(seed)
        self.lists = {"rows": [], "untimed": [], "failed": [], "skipped": []}
        self.benchmarks = []
        self.images: dict[str, numpy.ndarray] = {}
        self.index = 0
        self.context = {"cpu_name": "Made-up CPU", "num_cpus": 2, "commit": "0123456789abcdef", "dirty": "false",
                        "date": "2026-11-27T10:00:00+00:00", "suite": "made", "load_avg": [0.1, 0.2, 0.3], "busy": False,
                        "compiler": "GNU 12.2.0", "flags": "-O3", "build_type": "Release", "instruction_sets": "AVX3 AVX2"}

    def row(self, scene: str, technique: str, backend: str, parameters: dict, ms, error, spheres: int = 64, threads: int = 2,
            status: str = "ok", moves: bool = False, image: int = 0) -> dict:
        text = "".join(f"/{k}:{v}" for k, v in parameters.items())
        name = f"{scene}/spheres:{spheres}/objective:shadow/{technique}/{backend}{text}/threads:{threads}"
        samples = [] if ms is None else [ms * (1 + 0.01 * self.random.gauss(0, 1)) for _ in range(5)]
        quartiles = statistics.quantiles(samples, n=4) if samples else [0, 0, 0]
        receivers = 16384
        row = {"name": name, "index": self.index, "scene": scene, "spheres": spheres, "reads_spheres": technique != "ray-traced",
               "objective": "shadow", "receivers": receivers, "technique": technique, "backend": backend,
               "parameters": parameters, "defaults": {}, "threads": threads, "repetitions": len(samples), "iterations": 3,
               "frame_ms": statistics.median(samples) if samples else None, "prepare_ms": self.random.uniform(1, 2000),
               "update_ms": 0.1 * ms if ms else None, "shade_ms": 0.9 * ms if ms else None,
               "frame_spread_ms": (quartiles[2] - quartiles[0]) / 2 if samples else None,
               "stages": [{"name": "project", "ms": 0.3 * ms, "samples": []}, {"name": "filter", "ms": 0.6 * ms, "samples": []}]
               if ms and technique == "pcss" else [],
               "view_ms": None, "command_ms": None, "parity_rel_rmse": 1e-7, "geometry_rel_rmse": 0.015,
               "errors": {} if error is None else {"truth": errors_of(error, receivers), "cube": errors_of(error * 0.9, receivers),
                                                   "spheres": errors_of(error * 0.5, receivers)},
               "scene_key": scene, "key": name, "instruction_set": "AVX3", "bytes": self.random.randint(10_000, 150_000_000),
               "footprint": {"tables": 10_000, "per_scene": 2_000, "per_frame": 500}, "counters": {"non_finite": 0},
               "status": status}
        if technique == "wavelet" and error:
            row["steps"] = [{"name": "terms", "rel_rmse": error * 0.8, "share": 0.9}, {"name": "table", "rel_rmse": error * 0.3, "share": 0.1}]
        if moves:
            row["sequence"] = {"rel_rmse": [error, error], "flicker": [0.01], "coverage": [], "rel_noise": NOISE, "carry_ms": 0.1}
        if image and error is not None:
            row["image"] = f"images/{scene}/row-{self.index}"
            self.images[row["image"]] = shadow(image, 0.03 * (1 + error), self.rng, error)
            self.images.setdefault(f"images/{scene}/truth", shadow(image, 0.03, self.rng, NOISE / 4))
        kind = "skipped" if status.startswith("skipped") else "failed" if status != "ok" else "rows" if samples else "untimed"
        self.lists[kind].append(row)
        for k, sample in enumerate(samples if kind == "rows" else []):
            self.benchmarks.append({"name": name, "run_name": name, "run_type": "iteration", "repetition_index": k,
                                    "repetitions": len(samples), "family_index": self.index, "threads": threads, "iterations": 3,
                                    "real_time": sample, "cpu_time": sample, "time_unit": "ms", "update_ms": 0.1 * sample,
                                    "shade_ms": 0.9 * sample})
        self.index += 1
        return row

    def scene(self, name: str, rows: int, image: int = 0, images: int = 0, moves: bool = False) -> None:
        """So many rows of every technique in turn, the first `images` of them with one."""
        made = 0
        for round_ in range(10_000):
            for technique, backends, parameter, values, ms, ms_power, error, error_power in TECHNIQUES:
                for backend in backends:
                    if made == rows:
                        return
                    at = round_ % len(values)
                    step = 4.0 ** at if isinstance(values[0], str) else values[at] / values[0]
                    spheres = [64, 128, 32, 96][round_ // len(values) % 4]
                    parameters = {parameter: values[at]}
                    if round_ >= 4 * len(values):
                        parameters["seed"] = round_
                    slower = {"scalar": 6.0, "cuda": 0.15, "simd": 1.0}[backend] * self.random.uniform(0.9, 1.1)
                    self.row(name, technique, backend, parameters, ms * slower * step ** ms_power * (spheres / 64) ** 0.8,
                             error * step ** error_power * self.random.uniform(0.9, 1.1) + 0.001, spheres, moves=moves,
                             image=image if made < images else 0)
                    made += 1

    def document(self) -> dict:
        return {"format_version": 2, "context": self.context, **self.lists, "benchmarks": self.benchmarks}

    def write(self, folder) -> pathlib.Path:
        folder = pathlib.Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "results.json").write_text(json.dumps(self.document()))
        (folder / "figures.json").write_text(json.dumps(figures(self.lists["rows"])))
        for stem, pixels in self.images.items():
            write_exr(folder / f"{stem}.exr", pixels)
        return folder


def error_of(row: dict):
    return row.get("errors", {}).get("truth", {}).get("rel_rmse")


def floor_of(row: dict) -> float:
    return math.sqrt(2) * (row["errors"]["truth"].get("rel_noise") or 0)


def faster(a: dict, b: dict) -> bool:
    return a["frame_ms"] + a["frame_spread_ms"] + b["frame_spread_ms"] < b["frame_ms"]


def nearer(a: dict, b: dict) -> bool:
    return max(error_of(a), floor_of(a)) < max(error_of(b), floor_of(a))


def cheapest(rows: list[dict], limit: float):
    within = [r for r in rows if error_of(r) <= limit or r["errors"]["truth"]["tie"]]
    if not within:
        return None
    fastest = min(within, key=lambda r: r["frame_ms"])
    best = fastest
    for r in within:
        if not faster(fastest, r) and nearer(r, best):
            best = r
    return best["name"]


def beaten(a: dict, rows: list[dict]) -> bool:
    return any(b is not a and ((faster(b, a) and not nearer(a, b)) or (nearer(b, a) and not faster(a, b))) for b in rows)


def figures(rows: list[dict]) -> dict:
    scenes = []
    for scene in dict.fromkeys(row["scene"] for row in rows):
        timed = sorted((r for r in rows if r["scene"] == scene and error_of(r) is not None and r["frame_ms"]),
                       key=lambda r: r["frame_ms"])
        front = [r["name"] for r in timed if not beaten(r, timed)]
        named = {limit: cheapest(timed, limit) for limit in LIMITS}
        traced = [r["name"] for r in timed if r["technique"] == "ray-traced" and r["backend"] == "simd" and r["spheres"] == 64]
        wavelets = [r for r in timed if r["technique"] == "wavelet" and r["parameters"].get("terms") == 50]
        scenes.append({
            "scene": scene, "rows": [r["name"] for r in timed], "truth_noise": NOISE, "floor": NOISE * math.sqrt(2), "pareto": front,
            "cheapest": [{"limit": limit, "row": name} for limit, name in named.items()], "ray_traced": traced,
            "speed_up": [{"row": name, "error": 0.02, "factor": 3.1} if k % 2 == 0 else
                         {"row": name, "error": 0.3, "refused": "its error is outside of what ray tracing was measured at"}
                         for k, name in enumerate(front)],
            "families": [{"technique": "wavelet", "backend": "simd", "rows": [r["name"] for r in wavelets],
                          "time_at_error": [{"error": 0.01, "refused": "1 % is below <b>"}, {"error": 0.1, "ms": 2.5}],
                          "error_at_time": [{"ms": 1.0, "refused": "above"}, {"ms": 100.0, "error": 0.02}]}],
            "scaling": [{"axis": "spheres", "technique": "wavelet", "backend": "simd", "fixed": "terms=50, 2 threads",
                         "rows": [r["name"] for r in wavelets],
                         "points": sorted([r["spheres"], r["frame_ms"]] for r in wavelets), "slope": 0.8, "low": 0.7, "high": 0.9},
                        {"axis": "threads", "technique": "wavelet", "backend": "simd", "fixed": "terms=50", "rows": [],
                         "points": [[1, 2.0], [2, 1.1]], "refused": "two points are too few for a slope"}] if wavelets else [],
            "break_even": [{"axis": "spheres", "first": "wavelet simd", "second": "pixel-basis simd", "at": 57.0,
                            "faster_below": "wavelet simd"}]})
    first = rows[0]["name"] if rows else None
    lines = [{"keys": {"terms": t, "spheres": s}, "device": d, "row": first if t == 50 else None, "published": 10.0 + s / 32, "unit": "fps",
              "here": 170.0 if t == 50 else None, "ratio": 170.0 / (10 + s / 32) if t == 50 else None}
             for t in (50, 200) for s in (32, 64, 96, 128) for d in ("cpu", "gpu-1")]
    return {"format_version": 1, "limits": LIMITS, "scenes": scenes, "receivers_scaling": [],
            "published": [{"title": "Zhao & Che 2011, Table 2", "source": "zhao-che-2011-table2", "columns": ["terms", "spheres"],
                           "lines": lines}] if rows else []}


def large(rows: int, images: int, scenes: int = 10) -> Made:
    """The images of the first scene are 256 x 256, all others 128 x 128."""
    made = Made()
    for k in range(scenes):
        of_scene = max(1, images // scenes - 1)  # and its truth
        made.scene(f"scene-{k}", rows // scenes, 256 if k == 0 else 128, of_scene, moves=k == 1)
    return made


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out")
    parser.add_argument("--rows", type=int, default=1000)
    parser.add_argument("--images", type=int, default=200)
    options = parser.parse_args()
    print(large(options.rows, options.images).write(options.out))


if __name__ == "__main__":
    main()
