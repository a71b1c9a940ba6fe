"""How good and how fast `penumbra choose` is: the search beside an exhaustive grid.

    .venv/bin/python tests/choose_grid.py                 # searches: seconds and answers, without cached references
    .venv/bin/python tests/choose_grid.py --grid          # and the grid's best, timed beside the answer (hours)
    .venv/bin/python tests/choose_grid.py --only horse --out results/runs/choose-grid

Meshes: bunny, horse, torus-knot and a blob of 50,000 triangles that is made here. Lights: an environment with a city, one
with a studio, a square lamp. Bounds: 2 % and 5 %. Prints one line a case, and is the source of the table in docs/choose.md.
"""

import argparse
import json
import os
import pathlib
import shutil
import subprocess
import time

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAM = ROOT / "build" / "release" / "penumbra"
MESHES = ["bunny", "horse", "torus-knot", "blob"]
LIGHTS = {"city": ["--light", "city"], "studio": ["--light", "studio"], "lamp": None}
BOUNDS = ["2%", "5%"]


def blob(path: pathlib.Path) -> None:
    """A ball with bumps: 158 x 160 vertices and two poles, 50,240 triangles, closed."""
    rows, columns = 157, 160
    theta = np.pi * (np.arange(rows) + 1) / (rows + 1)
    phi = 2 * np.pi * np.arange(columns) / columns
    t, p = np.meshgrid(theta, phi, indexing="ij")
    r = 1 + 0.18 * np.sin(3 * t) * np.cos(4 * p) + 0.1 * np.sin(9 * t + 2) * np.sin(7 * p) * np.sin(t)
    points = np.stack([r * np.sin(t) * np.cos(p), r * np.cos(t), r * np.sin(t) * np.sin(p)], -1).reshape(-1, 3)
    north, south = len(points) + 1, len(points) + 2
    with path.open("w") as out:
        for x, y, z in [*points, (0, r[0].mean(), 0), (0, -r[-1].mean(), 0)]:
            out.write(f"v {x:.6f} {y:.6f} {z:.6f}\n")
        for j in range(columns):
            k = (j + 1) % columns
            out.write(f"f {north} {k + 1} {j + 1}\n")
            out.write(f"f {south} {(rows - 1) * columns + j + 1} {(rows - 1) * columns + k + 1}\n")
            for i in range(rows - 1):
                a, b, c, d = (i * columns + j, i * columns + k, (i + 1) * columns + k, (i + 1) * columns + j)
                out.write(f"f {a + 1} {b + 1} {c + 1}\nf {a + 1} {c + 1} {d + 1}\n")


def choose(arguments: list[str], out: pathlib.Path, cache: pathlib.Path) -> tuple[dict, float]:
    start = time.monotonic()
    result = subprocess.run(
        [PROGRAM, "choose", *arguments, "--json", "--out", out],
        env={**os.environ, "PENUMBRA_CACHE": str(cache)},
        capture_output=True,
        text=True,
        check=True,
    )
    return json.loads(result.stdout), time.monotonic() - start


def figures(option: dict | None) -> str:
    if option is None:
        return "none"
    return f"{option['label']}, {option['frame_ms']:.3g} ms, {100 * option['rel_rmse']:.3g} %"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--grid", action="store_true")
    parser.add_argument("--only", default="", help="part of a case's name, e.g. horse or bunny/city/2%%")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "results" / "runs" / "choose-grid")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    blob(options.out / "blob.obj")
    print("| case | s | looks | answer | grid's best | answer / best |\n|---|---|---|---|---|---|", flush=True)
    for mesh in MESHES:
        for light, arguments in LIGHTS.items():
            for bound in BOUNDS:
                case = f"{mesh}/{light}/{bound}"
                if options.only not in case:
                    continue
                name = str(options.out / "blob.obj") if mesh == "blob" else mesh
                given = [name, *(arguments or ["--lamp", "0.5x0.5@1,3,1"]), "--height", "1.5", "--error", bound]
                folder = options.out / case.replace("/", "-").replace("%", "")
                fresh = options.out / "fresh-cache"
                shutil.rmtree(fresh, ignore_errors=True)
                answer, seconds = choose(given, folder, fresh)
                best, ratio = "", ""
                if options.grid:
                    grid, _ = choose([*given, "--exhaustive"], folder, options.out / "cache")
                    best = figures(grid["answer"])
                    if grid["answer"]:
                        ratio = f"{grid['searched']['frame_ms'] / grid['answer']['frame_ms']:.3f}"
                        answer = {**answer, "answer": grid["searched"]}  # of the same run, timed side by side
                row = [case, f"{seconds:.0f}", str(answer["looks"]), figures(answer["answer"]), best, ratio]
                print("| " + " | ".join(row) + " |", flush=True)


if __name__ == "__main__":
    main()
