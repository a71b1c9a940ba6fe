#!/usr/bin/env bash
# The main job: sets up, builds, measures a suite (default: quick), prints the table and how long each step took.
# Results go to results/runs/latest/: results.json, table.md, images/. Further arguments go to `penumbra run`.
set -euo pipefail
cd "$(dirname "$0")/.."

took=""
step() { # NAME COMMAND...: runs it, exits with its code if it fails, and notes its seconds
  local name="$1" start=$SECONDS code=0
  shift
  "$@" || code=$?
  took+="${took:+, }$name $((SECONDS - start)) s"
  if ((code)); then
    echo "bench: $name failed ($took)" >&2
    exit "$code"
  fi
}

suite="${1:-quick}"
shift || true
step setup scripts/setup.sh
step build scripts/build.sh release -DPENUMBRA_TESTS=OFF
step run build/release/penumbra run "$suite" --out results/runs/latest "$@"
echo "bench: $took"
