#!/usr/bin/env bash
# The main job: sets up, builds, measures a suite (default: quick), prints the table.
# Results go to results/runs/latest/: results.json, table.md, images/. Further arguments go to `penumbra run`.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/setup.sh
scripts/build.sh release -DPENUMBRA_TESTS=OFF
suite="${1:-quick}"
shift || true
build/release/penumbra run "$suite" --out results/runs/latest "$@"
