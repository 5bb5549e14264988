#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Drives a small robot's rounds in a yard with and without loop closing, and compares what lives in the odometry frame,
# which no loop may move: prints a row for each seed.
#   tests/bench/odometry.sh [SEEDS] [OUT]
# SEEDS (default "1 2 3"); OUT (default out/odometry) contains rawlogs and results; existing rawlogs are reused.
set -euo pipefail
cd "$(dirname "$0")/../.."
seeds=${1:-1 2 3}
out=${2:-out/odometry}
bin=build/release/bin
mkdir -p "$out"

# figure KEY COMMAND...: a figure of headway-eval's JSON
figure() {
  local key=$1
  shift
  "$@" -q -w --json "$out/figure.json"
  grep -o "\"$key\": [0-9.]*" "$out/figure.json" | head -1 | cut -d' ' -f2
}
# same NAME A B: whether two results have the same bytes in a file
same() { cmp -s "$2/$1" "$3/$1" && echo same || echo differ; }

echo "| seed | loops | trajectory_odom.tum | tracks_odom.csv | ATE m: map | odometry | RPE mm: online map | odometry | \
predictions' ADE m: loops | none |"
echo "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"
for seed in $seeds; do
  world=$out/yard_$seed
  [ -f "$world.rawlog" ] || $bin/headway-sim -q -c config/worlds/yard-loop.ini --seed "$seed" --frames 1200 \
    -o "$world.rawlog"
  for closing in true false; do
    $bin/headway-replay -i "$world.rawlog" -o "${world}_$closing" -w -q --snapshots 0 --set slam.loop_closing=$closing
  done
  trajectory=("$bin/headway-eval" trajectory --truth "$world.truth/trajectory.tum" --align se3 --estimate)
  ade() {
    figure ade_m "$bin/headway-eval" predictions --truth "$world.truth/label_02.txt" --poses \
      "$world.truth/poses_kitti.txt" --extrinsic "$world.truth/calibration.yaml" --estimate "$1/predictions.csv"
  }
  closed=${world}_true
  open=${world}_false
  printf '| %s | %s | %s | %s | %.3f | %.3f | %.2f | %.2f | %s | %s |\n' "$seed" \
    "$(grep -o '"loops": [0-9]*' "$closed/summary.json" | cut -d' ' -f2)" \
    "$(same trajectory_odom.tum "$closed" "$open")" "$(same tracks_odom.csv "$closed" "$open")" \
    "$(figure ate_rmse_m "${trajectory[@]}" "$closed/trajectory.tum")" \
    "$(figure ate_rmse_m "${trajectory[@]}" "$closed/trajectory_odom.tum")" \
    "$(figure rpe_trans_rmse_m "${trajectory[@]}" "$closed/trajectory_online.tum" | awk '{ print 1000 * $1 }')" \
    "$(figure rpe_trans_rmse_m "${trajectory[@]}" "$closed/trajectory_odom.tum" | awk '{ print 1000 * $1 }')" \
    "$(ade "$closed")" "$(ade "$open")"
done
