#!/usr/bin/env bash
# Sets up, builds and runs every test.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/setup.sh
scripts/build.sh release -DPENUMBRA_TESTS=ON
.venv/bin/python scripts/check_metrics.py
.venv/bin/python scripts/check_formats.py
.venv/bin/python scripts/check_renderer_example.py
.venv/bin/python -m unittest discover tests/report
ctest --preset release --parallel "$(nproc)" --output-on-failure
