#!/usr/bin/env bash
# Configures and builds a preset (default: release). Remaining arguments go to CMake.
set -euo pipefail
cd "$(dirname "$0")/.."
preset="${1:-release}"
shift || true
cmake --preset "$preset" "$@" >/dev/null
cmake --build --preset "$preset"
