#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Drives a simulated loop ten times and starts a camera again at random in its first lap; prints
# the figures of doc/lab/slam.md.
#   tests/bench/slam/long_run.sh [OUT]
# OUT (default out/long_run) keeps the recordings (0.4 GB), which are drawn once.
set -euo pipefail
cd "$(dirname "$0")/../../.."
out=${1:-out/long_run}
bin=build/release/bin
bench=build/release/tests/bench/slam
mkdir -p "$out"

# draw NAME OPTIONS...: the yard, seen by a small grey camera
draw() {
  local name=$1
  shift
  [ -f "$out/$name.rawlog" ] || $bin/headway-sim -c config/worlds/yard-loop.ini \
    -o "$out/$name.rawlog" --set camera.width=480 --set camera.height=304 \
    --set camera.focal_px=292 --set camera.colour=false "$@"
}
draw yard --set route.laps=11 --set route.speed_mps=4.2 --frames 6200
draw elsewhere --seed 208 --frames 150

$bench/bench_memory -i "$out/yard.rawlog" --lap 157.6
$bench/bench_relocalisation --map "$out/yard.rawlog" --map-to 700 \
  --restart "$out/yard.rawlog" --restart-from 750 --elsewhere "$out/elsewhere.rawlog"
