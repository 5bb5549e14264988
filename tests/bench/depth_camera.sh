#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Compares a depth camera (headway-sim --rig rgbd) with a stereo camera (--rig robot) in the office floor:
# RMSE of the trajectory after alignment [m], of each seed and the medians.
#   [SEEDS="1 2 3 4 5"] [WORLD=hall] tests/bench/depth_camera.sh [OUT]
# OUT (default out/depth_camera) contains results; rawlogs are deleted.
set -euo pipefail
cd "$(dirname "$0")/../.."
out=${1:-out/depth_camera}
seeds=${SEEDS:-1 2 3 4 5}
world=${WORLD:-hall}
bin=build/release/bin
mkdir -p "$out"

# ate RIG SEED: the RMSE [m]
ate() {
  local name=$out/$world-$1-$2
  $bin/headway-sim -q -w -c "config/worlds/$world.ini" --rig "$1" --seed "$2" -o "$name.rawlog"
  $bin/headway-replay -q -w -i "$name.rawlog" -o "$name" --snapshots 0 --detector none
  $bin/headway-eval trajectory -q -w --truth "$name.truth/trajectory.tum" \
    --estimate "$name/trajectory.tum" --json "$name.json" >"$name.txt"
  rm "$name.rawlog"
  python3 -c "import json, sys; print(json.load(open(sys.argv[1]))['ate_rmse_m'])" "$name.json"
}

echo "| seed | robot | rgbd |"
echo "| ---: | ---: | ---: |"
for seed in $seeds; do
  robot=$(ate robot "$seed")
  rgbd=$(ate rgbd "$seed")
  echo "$robot" >>"$out/robot.tmp"
  echo "$rgbd" >>"$out/rgbd.tmp"
  printf '| %s | %.4f | %.4f |\n' "$seed" "$robot" "$rgbd"
done
median() {
  sort -g "$1" | awk '{ v[NR] = $1 } END { print NR % 2 ? v[(NR + 1) / 2] : (v[NR / 2] + v[NR / 2 + 1]) / 2 }'
}
printf '| median | %.4f | %.4f |\n' "$(median "$out/robot.tmp")" "$(median "$out/rgbd.tmp")"
rm "$out"/*.tmp
