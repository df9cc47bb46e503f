#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
# ./setup.sh demo   installs what is missing, builds, and relights a room: pictures, tables, GPU against reference
# ./setup.sh day    the same room from morning to night, in frames recorded on the device
# ./setup.sh test   installs what is missing, builds, and runs all tests; what follows the word are options of cmake
#
# Debian 12. Packages come from apt as root or with sudo; where that cannot be, the missing ones are printed and the exit status is 2.
# Everything lands in build/release and demo; a second run rebuilds only what changed.
set -euo pipefail
if [[ ${BASH_SOURCE[0]} == */* ]]; then cd "${BASH_SOURCE[0]%/*}"; fi

# package, or package:command where a command in PATH shows that it is there
packages=(
  build-essential:c++ cmake:cmake ninja-build:ninja glslang-tools:glslangValidator
  libembree-dev libtbb-dev libvulkan-dev mesa-vulkan-drivers vulkan-validationlayers
  libtinygltf-dev libmeshoptimizer-dev libstb-dev libtinyexr-dev zlib1g-dev
  libglm-dev libfmt-dev libexpected-dev libcli11-dev nlohmann-json3-dev libxxhash-dev
  libgtest-dev libgmock-dev libbenchmark-dev libeigen3-dev
)

installed() {
  local package=${1%%:*} command=${1#*:}
  if [[ $command != "$package" ]] && ! command -v "$command" >/dev/null; then return 1; fi
  command -v dpkg-query >/dev/null && [[ $(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null) == installed ]]
}

install_packages() {
  local entry missing=() privilege=()
  for entry in "${packages[@]}"; do
    installed "$entry" || missing+=("${entry%%:*}")
  done
  if ((${#missing[@]} == 0)); then return; fi
  if ((EUID != 0)); then privilege=(sudo); fi
  if ! command -v apt-get >/dev/null || { ((EUID != 0)) && ! command -v sudo >/dev/null; }; then
    echo "These packages are missing, and they cannot be installed here (no apt-get, or neither root nor sudo):" >&2
    printf '  %s\n' "${missing[@]}" >&2
    exit 2
  fi
  echo "Installing: ${missing[*]}"
  "${privilege[@]}" apt-get update -qq
  "${privilege[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}"
}

# build TARGET...
build() {
  mkdir -p build
  cmake --preset release "${cmake_options[@]}" >build/configure.log 2>&1 || { cat build/configure.log >&2; exit 1; }
  cmake --build --preset release --target "$@"
}

relume=build/release/src/tool/relume
cmake_options=("${@:2}")

make_room() {
  mkdir -p demo
  build/release/src/scene/relume-make-scene demo -o demo/room.glb
  "$relume" precompute demo/room.glb -o demo/room.relume
}

day() {
  build relume relume_make_scene relume_day
  make_room
  build/release/bench/relume-day demo/room.relume -o demo/hours
  echo "Pictures:"
  find "$PWD/demo/hours" -name '*.png' | sort | sed 's/^/  /'
}

demo() {
  build relume relume_make_scene
  make_room
  "$relume" solve demo/room.relume -o demo/day
  cat >demo/night.materials.json <<'END'
{ "materials": {
    "window":     { "emission": [1, 1.5, 3] },
    "lamp_panel": { "emission": [0, 0, 0] },
    "wall_back":  { "albedo": [0.16, 0.30, 0.55] } } }
END
  cat >demo/night.lights.json <<'END'
{ "lights": [
    { "type": "point", "color": [1, 0.72, 0.42], "intensity": 120, "position": [1.6, 1.9, 2.6] } ] }
END
  echo "By night, from the same precompute: a dark window, a blue wall, one warm lamp"
  "$relume" solve demo/room.relume -o demo/night --materials demo/night.materials.json --lights demo/night.lights.json
  "$relume" export demo/room.relume -o demo --debug clusters
  "$relume" compare demo/room.relume
  echo
  echo "Pictures:"
  find "$PWD/demo" -name '*.png' | sort | sed 's/^/  /'
}

run_tests() {
  build all
  ctest --preset release
}

case ${1-} in
  demo) install_packages; demo ;;
  day) install_packages; day ;;
  test) install_packages; run_tests ;;
  *) echo "usage: ./setup.sh demo|day|test" >&2; exit 2 ;;
esac
