#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Measures headway-live as a node of ROS 2 beside a robot of another implementation of DDS: transport, image to
# obstacles, trajectory against a replay's, memory. Needs the targets bench_ros2, headway-live, -replay, -sim, -eval.
#   [MINUTES=30] [FRAMES=300] tests/bench/ros2.sh [OUT]
# OUT (default out/ros2) contains rawlogs and results; existing rawlogs are reused.
set -euo pipefail
cd "$(dirname "$0")/../.."
out=${1:-out/ros2}
bin=build/release/bin
bench=build/release/tests/ros2/bench_ros2
export ROS_DOMAIN_ID=${ROS_DOMAIN_ID:-77}
mkdir -p "$out"

recorded() {
  local rawlog=$out/$1.rawlog
  shift
  [ -f "$rawlog" ] || $bin/headway-sim -q --frames "${FRAMES:-300}" -o "$rawlog" \
    --set recording.storage=embedded "$@"
}
recorded stereo -c config/worlds/hall.ini --rig robot --seed 61 --set camera.imu=true --set camera.odometry=true
recorded rgbd -c config/worlds/hall.ini --rig rgbd --seed 61 --set camera.imu=true --set camera.odometry=true
recorded raw -c config/worlds/hall.ini --seed 61  # 1280x720 at 15 Hz

echo "== transport"
for rig in stereo rgbd raw; do
  $bench "$out/$rig.rawlog" "-$ROS_DOMAIN_ID" 1 1
done
for rig in stereo raw; do
  $bench "$out/$rig.rawlog" "-$ROS_DOMAIN_ID" 1 1 compressed
done

# live NAME LOOPS: headway-live beside the robot; its memory at the start and at the end
live() {
  $bin/headway-live --ros2 --ros2-interface lo -q -w -o "$out/live-$1" &
  local program=$!
  $bench "$out/$1.rawlog" "$ROS_DOMAIN_ID" 1 "$2" &
  local robot=$!
  sleep 60
  echo "memory after 1 min: $(awk '/VmRSS/ { print $2 }' /proc/$program/status) kB"
  wait $robot
  echo "memory at the end: $(awk '/VmRSS/ { print $2 }' /proc/$program/status) kB"
  kill -TERM $program
  wait $program
}
for rig in stereo rgbd; do
  echo "== $rig"
  $bin/headway-replay -q -w -i "$out/$rig.rawlog" -o "$out/replay-$rig"
  live $rig 1
  for run in replay live; do
    $bin/headway-eval trajectory --truth "$out/$rig.truth/trajectory.tum" --align se3 \
      --estimate "$out/$run-$rig/trajectory_online.tum" | grep -i "ate" | sed "s/^/$run: /"
  done
done
echo "== memory over ${MINUTES:-30} minutes"
live stereo $((${MINUTES:-30} * 60 / 31))
