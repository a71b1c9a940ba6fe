#!/usr/bin/env bash
# Installs what penumbra needs on Debian 12 or Ubuntu 24.04: packages with apt, Python packages into .venv.
# Does nothing that is already done; sudo only when not root.
set -euo pipefail
cd "$(dirname "$0")/.."

packages=(
  g++ cmake ninja-build ccache git
  libbenchmark-dev libbenchmark-tools libgtest-dev libgmock-dev
  libembree-dev libtbb-dev libhwy-dev libglm-dev libboost-context-dev libassimp-dev libnlopt-dev libnlopt-cxx-dev libeigen3-dev
  libopenimageio-dev openimageio-tools libopencv-core-dev # OpenImageIO's CMake files name the last two
  fonts-dejavu-core # labels of pictures
  libcli11-dev libtomlplusplus-dev nlohmann-json3-dev libsimdjson-dev libfmt-dev libspdlog-dev
  glmark2-data blender-data # bunny, horse, cat; eight environments
  libcgal-demo # armadillo, elephant
  clang-14 libclang-rt-14-dev clang-format-14 clang-tidy-14
  python3 python3-venv
  valgrind # counts instructions of kernels
)
# Opens the report in its tests; Ubuntu's package of that name is a snap, and its CI machines have a Chrome.
if grep -q '^ID=debian' /etc/os-release; then packages+=(chromium); fi

missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
done
if ((${#missing[@]})); then
  echo "setup: installing ${missing[*]}"
  sudo=""
  [ "$(id -u)" -eq 0 ] || sudo="sudo"
  $sudo apt-get update -qq
  $sudo env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
fi

if ! cmp -s scripts/requirements.txt .venv/requirements.txt; then
  echo "setup: Python packages into .venv"
  rm -rf .venv
  /usr/bin/python3 -m venv .venv
  .venv/bin/pip install --quiet --disable-pip-version-check -r scripts/requirements.txt
  cp scripts/requirements.txt .venv/requirements.txt
fi
