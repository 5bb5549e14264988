#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Compares a simulated world without moving objects with real recordings: visual odometry errors,
# corner counts and disparity errors.
#   HEADWAY_DATA=DATA tests/bench/worlds_against_real.sh [OUT] [HEADWAY-SIM ARGUMENTS...]
# DATA contains kitti_odometry/ (sequences 06 and 01, frames 0-50: about 60 m each, so the errors are
# KITTI's over segments of 10 ... 50 m). OUT (default out/realism) contains rawlogs and results.
set -euo pipefail
cd "$(dirname "$0")/../.."
data=${HEADWAY_DATA:?names no folder of real data}
out=${1:-out/realism}
shift || true
bin=build/release/bin
mkdir -p "$out"

for sequence in 06 01; do
  [ -f "$out/kitti_$sequence.rawlog" ] || $bin/headway-import kitti-odometry \
    "$data/kitti_odometry" --sequence $sequence -q -o "$out/kitti_$sequence.rawlog"
done
still=(--set traffic.vehicles=0 --set traffic.cyclists=0 --set traffic.pedestrians=0)
pieces=()
for first in 0 300 600; do  # a straight with its corner, each 60 m long
  pieces+=("city-loop_$first")
  $bin/headway-sim -c config/worlds/city-loop.ini "${still[@]}" --frames 95 --depth -q -w \
    --set recording.first_frame=$first "$@" -o "$out/city-loop_$first.rawlog"
done

echo "| recording | path m | KITTI translation % | rotation °/m | RPE mm a frame | path ratio |"
echo "| --- | --- | --- | --- | --- | --- |"
for name in kitti_06 kitti_01 "${pieces[@]}"; do
  $bin/headway-replay -i "$out/$name.rawlog" -o "$out/$name" -w -q --snapshots 0 --detector none
  $bin/headway-eval trajectory --truth "$out/$name.rawlog" \
    --estimate "$out/$name/trajectory.tum" --segments 10,20,30,40,50 -q \
    --json "$out/$name.json" -w
  key() { grep -o "\"$1\": [-0-9.e]*" "$out/$name.json" | head -1 | cut -d' ' -f2; }
  printf '| %s | %.1f | %.3f | %.4f | %.1f | %.5f |\n' "$name" "$(key path_m)" \
    "$(key kitti_trans_percent)" "$(key kitti_rot_deg_per_m)" \
    "$(awk "BEGIN { print 1000 * $(key rpe_trans_rmse_m) }")" "$(key path_ratio)"
done
echo
rawlogs=("$out/kitti_06.rawlog" "$out/kitti_01.rawlog")
for name in "${pieces[@]}"; do rawlogs+=("$out/$name.rawlog"); done
find build/release -name bench_images -type f -exec {} "${rawlogs[@]}" \;
