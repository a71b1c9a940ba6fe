#!/usr/bin/env bash
# Format and lint: clang-format on every source, clang-tidy on those given (default: all), shell and Python syntax.
set -euo pipefail
cd "$(dirname "$0")/.."
mapfile -t sources < <(git ls-files '*.h' '*.cpp' '*.cu')
clang-format-14 --dry-run --Werror "${sources[@]}"
if git grep -nE '__CUDACC__|__CUDA_ARCH__' -- scenes techniques harness tests ':!scenes/host_device.h'; then
  echo "lint: only cuda/ and scenes/host_device.h may know whether CUDA is there" >&2
  exit 1
fi
for script in scripts/*.sh .ci/run; do bash -n "$script"; done
python3 -m py_compile scripts/*.py scripts/report/*.py tests/*.py tests/counts/*.py tests/report/*.py tests/faults/*.py
python3 tests/faults/plant.py --check
python3 scripts/gate_trial.py --check
cmake --preset lint >/dev/null
cmake --build --preset lint --target spherical_harmonics_code >/dev/null # a header that sources include
# Highway's kernels include themselves once per instruction set; read once, for the baseline, clang-tidy can follow. The
# generated sources hold one .cu file each, as C++ for the host.
mapfile -t tidy < <(git ls-files 'scenes/*.cpp' 'techniques/*.cpp' 'harness/*.cpp' 'cuda/*.cpp'; ls build/lint/cuda/host/*.cpp)
printf '%s\n' "${tidy[@]}" | xargs -P "$(nproc)" -n 4 clang-tidy-14 -p build/lint --quiet \
  --extra-arg=-Wno-unknown-warning-option --extra-arg=-DHWY_COMPILE_ONLY_STATIC 2>/dev/null
