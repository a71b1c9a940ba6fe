"""SSIM and FLIP of the shipped test images by scikit-image and flip-evaluator, against the numbers that the C++ tests use.

    .venv/bin/python scripts/check_metrics.py           # compares, exit 1 on a difference
    .venv/bin/python scripts/check_metrics.py --write   # writes tests/data/expected.json anew
"""

import json
import math
import pathlib
import sys

import flip_evaluator
import numpy
from skimage.metrics import structural_similarity

DATA = pathlib.Path(__file__).resolve().parent.parent / "tests" / "data"
EXPOSURE = 2.0


def display_luminance(image: numpy.ndarray) -> numpy.ndarray:
    linear = numpy.clip(EXPOSURE * (image @ numpy.array([0.2126, 0.7152, 0.0722])), 0.0, 1.0)
    return numpy.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def measure() -> dict[str, float]:
    clean = flip_evaluator.load(str(DATA / "clean.exr")).astype(numpy.float64)
    noisy = flip_evaluator.load(str(DATA / "noisy.exr")).astype(numpy.float64)
    ssim = structural_similarity(
        display_luminance(clean), display_luminance(noisy),
        gaussian_weights=True, sigma=1.5, use_sample_covariance=False, data_range=1.0)
    stop = math.log2(EXPOSURE)
    _, flip, _ = flip_evaluator.evaluate(
        clean.astype(numpy.float32), noisy.astype(numpy.float32), "HDR", applyMagma=False,
        parameters={"startExposure": stop, "stopExposure": stop, "numExposures": 2, "tonemapper": "aces"})
    return {"exposure": EXPOSURE, "ssim": float(ssim), "flip": float(flip)}


def main() -> int:
    file = DATA / "expected.json"
    measured = measure()
    if "--write" in sys.argv:
        file.write_text(json.dumps(measured, indent=1) + "\n")
        return 0
    expected = json.loads(file.read_text())
    wrong = [key for key in measured if abs(measured[key] - expected[key]) > 1e-5]
    for key in measured:
        print(f"{key}: {measured[key]:.6f}, tests expect {expected[key]:.6f}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
