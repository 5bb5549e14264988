#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Compares a depth camera (headway-sim --rig rgbd) with a stereo camera (--rig robot) in the office floor:
# RMSE of the trajectory after alignment [m], of each seed and the medians. With real data, a Kinect turned fast and a
# RealSense in a static room, told to be of several rates, beside the reference workload (needs target bench_slam).
#   [HEADWAY_DATA=DATA] [SEEDS="1 2 3 4 5"] [WORLD=hall] tests/bench/depth_camera.sh [OUT]
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

[ -n "${HEADWAY_DATA:-}" ] || exit 0
# clip NAME IMPORT-ARGUMENTS...: a real recording of a depth camera, without and with detection
clip() {
  local name=$1 detector result
  shift
  $bin/headway-import "$@" -q -w -o "$out/$name.rawlog" 2>/dev/null
  for detector in none stereo_motion+shape; do
    result=$out/$name-$detector
    $bin/headway-replay -q -w -i "$out/$name.rawlog" -o "$result" --snapshots 0 --detector "$detector" \
      2>"$result.log"
    ate=$($bin/headway-eval trajectory --truth "$out/$name.rawlog" --estimate "$result/trajectory.tum" 2>/dev/null |
      awk '/ATE RMSE/ { print $5 }') || true
    python3 -c 'import json, sys
s = json.load(open(sys.argv[3] + "/summary.json"))
print("| {} | {} | {frames_lost} of {frames} | {} | {keyframes} | {frame_ms_p95:.0f} | {cpu_ms_per_frame:.0f} |"
      " {tracks_moving} |".format(sys.argv[1], sys.argv[2], sys.argv[4], **s))' \
      "$name" "$detector" "$result" "${ate:--}"
  done
  rm "$out/$name.rawlog"
}

$bin/headway-import kitti-odometry "$HEADWAY_DATA/kitti_odometry" --sequence 06 -q -w -o "$out/06.rawlog"
printf '\nReference workload: %s ms\n' \
  "$(build/release/tests/bench/slam/bench_slam -i "$out/06.rawlog" | awk '/^reference/ { print $3 }')"
rm "$out/06.rawlog"
echo "| clip | detector | lost | ATE RMSE m | keyframes | p95 ms | processor ms a frame | moving tracks |"
echo "| --- | --- | --- | --- | --- | --- | --- | --- |"
clip freiburg1_rpy tum-rgbd "$HEADWAY_DATA/rgbd/freiburg1_rpy"
robot=$HEADWAY_DATA/rgbd/realsense_robot
for rate in 5 10 15 30; do
  clip "realsense_$rate" images --left "$robot/rgb" --depth "$robot/depth" --calibration "$robot/calibration.yaml" \
    --rate $rate
done
