#!/usr/bin/env python3
"""Peak memory of a run with very many receivers, references and scoring included.

    tests/memory.py --program build/release/penumbra --resolution 4096 --limit 6

The scene is bare (a sphere under a lamp), so that rays cost little and receivers are what fills the memory. The truth
still takes 2048 rays a receiver: about ten minutes for 4096 x 4096 on two cores. Exit code 1 above the limit (GiB).
"""
import argparse
import os
import resource
import subprocess
import sys
import tempfile

SCENE = """name = "large"
[occluder]
mesh = "sphere"
[receivers]
plane = {{ half_extent = 2.0, resolution = {resolution}, y = -1.0 }}
[light]
area = {{ centre = [0, 4, 0], edge_u = [0.5, 0, 0], edge_v = [0, 0, 0.5] }}
"""
SUITE = """name = "memory"
scenes = ["scene.toml"]
truth_noise = 1.0
repetitions = 1
[[technique]]
name = "shadow-map"
backend = "simd"
[[technique]]
name = "pcss"
backend = "simd"
[[technique]]
name = "ray-traced"
backend = "simd"
parameters = { rays = 4 }
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--program", default="build/release/penumbra")
    parser.add_argument("--resolution", type=int, default=4096)
    parser.add_argument("--limit", type=float, default=6.0, help="GiB")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as place:
        for name, text in (("scene.toml", SCENE.format(resolution=options.resolution)), ("suite.toml", SUITE)):
            with open(os.path.join(place, name), "w", encoding="utf-8") as file:
                file.write(text)
        environment = dict(os.environ, PENUMBRA_CACHE=place + "/cache")
        code = subprocess.run(
            [options.program, "run", place + "/suite.toml", "--out", place + "/out"], env=environment, check=False
        ).returncode
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 2**20
    print(f"{options.resolution} x {options.resolution} receivers: exit code {code}, peak {peak:.2f} GiB", file=sys.stderr)
    sys.exit(1 if code or peak > options.limit else 0)


if __name__ == "__main__":
    main()
