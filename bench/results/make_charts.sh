#!/bin/sh
# Makes the charts of this folder anew: make_charts.sh RELUME MAKE_SCENE SCENES [option of relume chart ...]
# RELUME and MAKE_SCENE are the two programs, SCENES is a folder with the shared scenes. Without an option it is meant to take
# less than 15 minutes a scene on two quiet cores, with --quick one or two.
set -eu
[ $# -ge 3 ] || { echo "usage: $0 RELUME MAKE_SCENE SCENES [option of relume chart ...]" >&2; exit 2; }
relume=$1 make_scene=$2 scenes=$3
shift 3
here=$(cd "$(dirname "$0")" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
"$make_scene" demo -o "$scratch/demo.glb"
cp "$scenes/living_room.glb" "$scenes/babylon_cornellBox.glb" "$scratch"
for name in demo living_room babylon_cornellBox; do
  "$relume" chart "$scratch/$name.glb" -o "$here/$name" "$@"
done
