#!/usr/bin/env bash
# Two states of a renderer, each measured by a suite of its own ([[external]], docs/other-renderers.md): which rows got
# slower, which shadows wrong. Prints Markdown for a pull request; exit code of `penumbra compare`, or 2 (or the run's own,
# above 2) if a suite could not be measured: then nothing is compared.
#   scripts/compare_suites.sh BASE.toml NEW.toml OUT [options of compare]
# Both suites list scenes, techniques and externals of the same names. Results go to OUT/base and OUT/new, in place of older
# ones; pictures of changed rows to OUT/changed.
set -euo pipefail
if [ $# -lt 3 ]; then
  echo "usage: scripts/compare_suites.sh BASE.toml NEW.toml OUT [options of penumbra compare]" >&2
  exit 2
fi
penumbra="${PENUMBRA:-$(dirname "$0")/../build/release/penumbra}"
base="$1" new="$2" out="$3"
shift 3

measure() { # SUITE FOLDER
  local code=0
  "$penumbra" run "$1" --out "$2" >&2 || code=$?
  # 1: a row failed, which compare tells; or nothing was written.
  if [ $code -gt 1 ] || [ ! -s "$2/results.json" ]; then
    echo "compare_suites: $1 was not measured (exit code $code); nothing is compared" >&2
    exit $((code > 1 ? code : 2))
  fi
}

# What was measured earlier must not stand in for what cannot be measured now.
rm -f -- "$out/base/results.json" "$out/new/results.json" "$out/changed"/*.png
measure "$base" "$out/base"
measure "$new" "$out/new"
"$penumbra" compare "$out/base" "$out/new" --markdown --pictures "$out/changed" "$@"
