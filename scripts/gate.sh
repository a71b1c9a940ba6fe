#!/usr/bin/env bash
# The gate of a pull request: this tree against the commit in results/baseline/COMMIT, side by side.
# Times have a generous bound, since this machine may be a noisy one; errors have a strict one, since they have no noise.
set -euo pipefail

case "${1:-}" in
  -h | --help)
    cat <<'HELP'
usage: scripts/gate.sh [other options of `penumbra compare --ab`]
       scripts/gate.sh --renew

Builds this tree and the commit in results/baseline/COMMIT, and measures suite `ci` of both side by side, with
--fail-slower 30% --fail-error 0.1% --budget 4 --out build/ab/results. --renew makes HEAD the baseline; say in the commit why.
Exit code: 0 no regression, or the baseline is not in this clone (which is said); 1 a regression; 2 wrong input.
HELP
    exit 0
    ;;
esac
cd "$(dirname "$0")/.."

if [ "${1:-}" = --renew ]; then
  git rev-parse HEAD >results/baseline/COMMIT
  echo "gate: commit results/baseline/COMMIT with a line that says why times or errors may change"
  exit 0
fi
commit="$(cat results/baseline/COMMIT)"
if ! git cat-file -e "$commit^{commit}" 2>/dev/null; then
  printf '%s\n' "gate: *** NOT CHECKED: the baseline $commit is not in this clone." \
    "gate: *** A shallow clone lacks it (git fetch --unshallow); a rewritten history needs scripts/gate.sh --renew." >&2
  exit 0
fi
code=0
scripts/ab.sh "$commit" ci --fail-slower 30% --fail-error 0.1% --budget 4 --out build/ab/results "$@" || code=$?
case $code in
  3) echo "gate: *** some rows are not certain, see above; no regression was found" >&2 ;;
  *) exit $code ;;
esac
