#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Measures the trajectory error of a simulated camera along two closed KITTI paths, without and with
# loop closing.
#   HEADWAY_DATA=DATA tests/bench/loops.sh [OUT]
# DATA contains kitti_poses/06.txt and 07.txt; OUT (default out/loops) contains rawlogs and results;
# existing rawlogs are reused.
set -euo pipefail
cd "$(dirname "$0")/../.."
data=${HEADWAY_DATA:?names no folder of real data}
out=${1:-out/loops}
bin=build/release/bin
mkdir -p "$out"

# ate RAWLOG RESULT: "ATE RMSE [m]  path [m]"
ate() {
  $bin/headway-eval trajectory --truth "${1%.rawlog}.truth/trajectory.tum" \
    --estimate "$2/trajectory.tum" | awk '/ATE RMSE/ { ate = $5 } /true path/ { path = $5 }
      END { print ate, path }'
}

echo "| path | frames | m | loop closing | loops | ATE RMSE m | % of the path | MB |"
echo "| --- | --- | --- | --- | --- | --- | --- | --- |"
while read -r name speed; do
  rawlog=$out/kitti_$name.rawlog
  [ -f "$rawlog" ] || $bin/headway-sim -q -c config/worlds/city-loop.ini \
    --set route.kind=kitti_poses --set "route.file=$data/kitti_poses/$name.txt" \
    --set route.speed_mps="$speed" --set traffic.vehicle_speed_mps="$speed" \
    --set route.lateral_acceleration_mps2=3 --set camera.colour=false --frames 2000 -o "$rawlog"
  for closing in false true; do
    result=$out/kitti_${name}_$closing
    $bin/headway-replay -i "$rawlog" -o "$result" -w --snapshots 0 \
      --set slam.loop_closing=$closing > "$result.log" 2>&1
    read -r error path < <(ate "$rawlog" "$result")
    awk -v name="$name" -v closing="$closing" -v error="$error" -v path="$path" -F '[:,]' '
      /"frames":/ { frames = $2 } /"loops":/ { loops = $2 } /"peak_memory_mb":/ { mb = $2 }
      END { printf "| %s | %d | %.0f | %s | %d | %.3f | %.3f | %.0f |\n", name, frames, path,
                   closing, loops, error, 100 * error / path, mb }' "$result/summary.json"
  done
done << 'PATHS'
06 13
07 8
PATHS
