#!/usr/bin/env bash
# On a machine with an NVIDIA GPU: builds for it, runs the CUDA tests on it, then compute-sanitizer if present, measures
# the suites with CUDA rows, and every kernel against the device's peaks. Rows go to results/gpu/DEVICE/, to be committed.
# usage: scripts/gpu_check.sh [--quick] [--built]
#   --quick: tests alone
#   --built: build/cuda was made elsewhere, on a machine with the packages; the sheet of kernels is made there, too
set -euo pipefail
cd "$(dirname "$0")/.."

quick= built=
for word in "$@"; do
  case "$word" in
    --quick) quick=yes ;;
    --built) built=yes ;;
    *) echo "gpu_check: unknown option '$word'; known are --quick and --built" >&2; exit 2 ;;
  esac
done
export PATH="$PATH:/usr/local/cuda/bin"
need() {
  command -v "$1" >/dev/null || { echo "gpu_check: $1 is not on PATH: this needs an NVIDIA GPU${2:-}" >&2; exit 2; }
}
need nvidia-smi
[ -n "$built" ] || need nvcc " and the CUDA toolkit"
device="$(nvidia-smi -i 0 --query-gpu=name --format=csv,noheader | tr -c '[:alnum:]\n' '-')"
if [ -z "$built" ]; then
  architecture="$(nvidia-smi -i 0 --query-gpu=compute_cap --format=csv,noheader | tr -d .)"
  echo "== build for sm_$architecture ($device)"
  scripts/setup.sh
  scripts/build.sh release -DPENUMBRA_TESTS=OFF # kernel_counts, and the header that the sheet's compilation includes
  scripts/build.sh cuda -DPENUMBRA_TESTS=ON -DCMAKE_CUDA_ARCHITECTURES="$architecture"
fi

echo "== CUDA tests on the device"
build/cuda/penumbra list | grep '^cuda: available' # set -e: anything else ends here
tests='*__cuda*:Kernels*:Availability*:*HostExecution*:HostRuntime*'
build/cuda/tests/penumbra_tests --gtest_brief=1 --gtest_filter="$tests"
if command -v compute-sanitizer >/dev/null; then
  for tool in memcheck racecheck synccheck; do
    echo "== compute-sanitizer $tool"
    compute-sanitizer --tool "$tool" --error-exitcode 1 \
      build/cuda/tests/penumbra_tests --gtest_brief=1 --gtest_filter='Kernels/EveryKernel.TakesAnyNumberOfReceivers/*'
  done
else
  echo "compute-sanitizer is not installed: skipped"
fi
[ -z "$quick" ] || exit 0

out="results/gpu/$device"
mkdir -p "$out"
echo "== suites"
for suite in cuda paper-table2; do
  build/cuda/penumbra run "$suite" --out "results/runs/gpu-$suite"
  cp "results/runs/gpu-$suite/results.json" "$out/$suite.json"
  cp "results/runs/gpu-$suite/table.md" "$out/$suite.md"
done
echo "== kernels"
build/cuda/kernel_times "$out/kernel_times.json"
if [ -z "$built" ]; then
  cmake --build --preset release --target kernel_counts
  build/release/kernel_counts build/kernel_counts.json
  .venv/bin/python scripts/kernel_sheet.py --counts build/kernel_counts.json --times "$out/kernel_times.json" --out "$out"
fi
echo "commit $out"
