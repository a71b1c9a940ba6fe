#!/usr/bin/env bash
# Builds a commit beside the working tree, and measures both side by side: time and error of every row.
#   scripts/ab.sh REF [SUITE] [options of `penumbra compare --ab`]     the suite is `ci` if none is named
# Exit code: that of compare (0 fine, 1 a regression, 2 wrong input, 3 not all is known). The commit's tree stays in
# build/ab/, so that the next call builds nothing; the compiler's cache serves both.
set -euo pipefail
cd "$(dirname "$0")/.."

if [ $# -eq 0 ] || [[ "$1" == -* ]]; then
  echo "usage: scripts/ab.sh REF [SUITE] [options of penumbra compare --ab]" >&2
  exit 2
fi
commit="$(git rev-parse --verify --quiet "$1^{commit}")" || {
  echo "ab: '$1' is no commit of this clone (a shallow clone lacks most: git fetch --unshallow)" >&2
  exit 2
}
shift
suite=ci
if [ $# -gt 0 ] && [[ "$1" != -* ]]; then
  suite="$1"
  shift
fi

tree="build/ab/$commit"
if [ ! -e "$tree/CMakeLists.txt" ]; then
  git worktree prune
  git worktree add --quiet --force --detach "$tree" "$commit"
fi
for folder in "$tree" .; do
  (cd "$folder" && cmake --preset release >/dev/null && cmake --build --preset release --target penumbra) || {
    echo "ab: $folder does not build" >&2
    exit 2 # 1 would be a regression
  }
done
build/release/penumbra compare --ab "$tree/build/release/penumbra" build/release/penumbra "$suite" "$@"
