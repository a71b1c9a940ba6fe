#!/usr/bin/env bash
# The main job: sets up, builds, measures a suite (default: quick), prints the table, makes a page of it, and says how long
# each step took and where the page is. Results go to results/runs/latest/: results.json, table.md, images/, report.html.
# Further arguments go to `penumbra run`.
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
page=""
if [[ " $* " != *" --dry-run "* ]]; then
  page=results/runs/latest/report.html
  step report build/release/penumbra report results/runs/latest --out "$page" >/dev/null
fi
echo "bench: $took${page:+; the page of this run:
$page}"
