#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Measures the trajectory error in streets where moving objects cover a given ratio of the image from
# the first frame on, and in the same streets without moving objects.
#   [SEEDS="1 2 3 4 5"] tests/bench/dynamic_scenes.sh [OUT]
# Figures are medians over the seeds, ATE RMSE, with slam.dynamic_rejection none and both. OUT
# (default out/dynamic_scenes) contains rawlogs and results; existing rawlogs are reused.
set -euo pipefail
cd "$(dirname "$0")/../.."
out=${1:-out/dynamic_scenes}
seeds=${SEEDS:-1 2 3 4 5}
frames=150
bin=build/release/bin
mkdir -p "$out"

# record SHARE SEED: a street, once
record() {
  local rawlog=$out/share_$1_$2.rawlog
  local traffic=(--set traffic.image_share="$1")
  [ "$1" != 0 ] ||
    traffic=(--set traffic.vehicles=0 --set traffic.cyclists=0 --set traffic.pedestrians=0)
  [ -f "$rawlog" ] || $bin/headway-sim -q --seed "$2" --frames $frames \
    --set "route.shape=straight 40, left 60 35, straight 30, right 50 40, straight 100" \
    --set recording.storage=external_jpeg --set camera.colour=false "${traffic[@]}" -o "$rawlog"
}

# error SHARE SEED MODE: ATE RMSE [m]
error() {
  local name=share_$1_$2
  $bin/headway-replay -q -w -i "$out/$name.rawlog" -o "$out/${name}_$3" --snapshots 0 \
    --set slam.dynamic_rejection="$3"
  $bin/headway-eval trajectory --truth "$out/$name.truth/trajectory.tum" \
    --estimate "$out/${name}_$3/trajectory.tum" | awk '/ATE RMSE/ { print $5 }'
}

# median SHARE MODE: over the seeds
median() {
  for seed in $seeds; do error "$1" "$seed" "$2"; done | sort -g |
    awk '{ value[NR] = $1 } END { print value[int((NR + 1) / 2)] }'
}

for seed in $seeds; do for share in 0 0.1 0.3 0.5; do record $share "$seed"; done; done
echo "| moving objects cover | none, m | both, m | both, ratio to that without |"
echo "| --- | --- | --- | --- |"
still=$(median 0 both)
for share in 0 0.1 0.3 0.5; do
  none=$(median $share none) both=$(median $share both)
  awk -v share=$share -v none="$none" -v both="$both" -v still="$still" \
    'BEGIN { printf "| %d %% | %.4f | %.4f | %.2f |\n", 100 * share, none, both, both / still }'
done
