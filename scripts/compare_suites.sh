#!/usr/bin/env bash
# Two states of a renderer, each measured by a suite of its own ([[external]], docs/other-renderers.md): which rows got
# slower, which shadows wrong. Prints Markdown for a pull request; exit code of `penumbra compare`.
#   scripts/compare_suites.sh BASE.toml NEW.toml OUT [options of compare]
# Both suites list scenes, techniques and externals of the same names. Results go to OUT/base and OUT/new.
set -euo pipefail
if [ $# -lt 3 ]; then
  echo "usage: scripts/compare_suites.sh BASE.toml NEW.toml OUT [options of penumbra compare]" >&2
  exit 2
fi
penumbra="${PENUMBRA:-$(dirname "$0")/../build/release/penumbra}"
base="$1" new="$2" out="$3"
shift 3
for side in base new; do
  suite="${!side}"
  # A row that failed is told by compare; a run without any results is the end.
  "$penumbra" run "$suite" --out "$out/$side" >&2 || [ -s "$out/$side/results.json" ]
done
"$penumbra" compare "$out/base" "$out/new" --markdown --pictures "$out/changed" "$@"
