#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Counts how often a lost camera is found again in a stored map, and how often in a wrong place: with people before the
# camera, furniture moved, another gamma, and in worlds that the map is not of, identical racks included.
#   [SEEDS="701 702"] [PLACES=20] tests/bench/relocalise.sh [OUT]
# OUT (default out/relocalise) contains rawlogs; existing ones are reused.
set -euo pipefail
cd "$(dirname "$0")/../.."
out=${1:-out/relocalise}
seeds=${SEEDS:-701 702}
places=${PLACES:-20}
bin=build/release/bin
bench=build/release/tests/bench/slam/bench_relocalisation
mkdir -p "$out"

# recorded NAME WORLD SEED OPTIONS...: the recording NAME in OUT, of a tour
recorded() {
  local rawlog=$out/$1.rawlog world=$2 seed=$3
  shift 3
  [ -f "$rawlog" ] || $bin/headway-sim -q -c "config/worlds/$world.ini" --rig small --seed "$seed" -o "$rawlog" \
    --set camera.rate_hz=10 --set robot.tour_stops=5 --set recording.storage=external_jpeg "$@"
}

# tried NAME WORLD SEED SPEED OPTIONS...: all starts in the map of one world; others are as slow on the same way
tried() {
  local name=$1 world=$2 seed=$3 speed=$4 again=() elsewhere=()
  shift 4
  recorded "$name" "$world" "$seed" --frames 400 "$@"
  for change in traffic.cover=0 traffic.cover=0.3 traffic.cover=0.6 world.moved_ratio=0.3 camera.gamma=0.5 \
    camera.gamma=2; do
    recorded "$name-$change" "$world" "$seed" --frames 240 --set "route.speed_mps=$speed" --set $change "$@"
    again+=(--restart "$out/$name-$change.rawlog")
  done
  for other in hall warehouse; do
    recorded "$other-$((seed + 100))" $other $((seed + 100)) --frames 240
    elsewhere+=(--elsewhere "$out/$other-$((seed + 100)).rawlog")
  done
  recorded "racks-$((seed + 100))" warehouse $((seed + 100)) --frames 240 --set world.identical_racks=true
  elsewhere+=(--elsewhere "$out/racks-$((seed + 100)).rawlog")
  echo "== $name"
  $bench --map "$out/$name.rawlog" "${again[@]}" --places "$places" | grep -v '^  frame'
  # No second of another world is this one.
  $bench --map "$out/$name.rawlog" "${elsewhere[@]}" --places $((3 * places)) | grep -v '^  frame'
  # Starts in a part that is not mapped.
  $bench --map "$out/$name.rawlog" --map-to 150 --restart "$out/$name.rawlog" --restart-from 200 \
    --places $((3 * places)) | grep -v '^  frame'
}

for seed in $seeds; do
  tried "hall-$seed" hall "$seed" 0.65
  tried "warehouse-$seed" warehouse "$seed" 0.9
  tried "racks-$seed" warehouse "$seed" 0.9 --set world.identical_racks=true
done
