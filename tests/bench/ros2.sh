#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Measures headway-live as a node of ROS 2 beside a robot of another implementation of DDS, on the loopback: transport,
# image to obstacles, trajectory against a replay's, memory. Needs the targets bench_ros2, headway-live, -replay, -sim
# and -eval.
#   [RUNS=5] [MINUTES=30] tests/bench/ros2.sh [OUT]
# OUT (default out/ros2) contains rawlogs and results; existing rawlogs are reused. An hour; RUNS=1 MINUTES=2: ten
# minutes.
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
  [ -f "$rawlog" ] || $bin/headway-sim -q -o "$rawlog" -c config/worlds/hall.ini --seed 61 \
    --set recording.storage=embedded "$@"
}
# A tour that comes back to its start: from frame 70 to 486 one lap.
recorded stereo --rig robot --frames 500 --set camera.width=752 --set camera.height=480 --set camera.focal_px=411 \
  --set camera.rate_hz=10 --set camera.imu=true --set camera.odometry=true --set laser.enabled=true \
  --set robot.tour_stops=2 --set robot.sudden_stop_rate_hz=0
recorded rgbd --rig rgbd --frames 450 --set camera.width=640 --set camera.height=480 --set camera.focal_px=320 \
  --set camera.rate_hz=30 --set camera.imu=true --set camera.odometry=true
recorded raw --rig robot --frames 150  # 1280x720 at 15 Hz

echo "== transport; receive buffers of at most $(cat /proc/sys/net/core/rmem_max) bytes"
for rig in stereo rgbd raw; do
  $bench -i "$out/$rig.rawlog" --domain "$ROS_DOMAIN_ID" --alone | sed "s/^/$rig: /"
done
for rig in stereo raw; do
  $bench -i "$out/$rig.rawlog" --domain "$ROS_DOMAIN_ID" --alone --compressed | sed "s/^/$rig, compressed: /"
done

# start NAME OPTIONS...: headway-live as $program
start() {
  local name=$1
  shift
  $bin/headway-live --ros2 "$@" --ros2-interface lo -q -w -o "$out/$name" &
  program=$!
}
stop() {
  kill -TERM $program
  wait $program
}
# ate NAME RIG: root mean square error of the poses as they were published [m]
ate() {
  $bin/headway-eval trajectory -q -w --truth "$out/$2.truth/trajectory.tum" --json "$out/$1.json" \
    --estimate "$out/$1/trajectory_online.tum"
  python3 -c "import json, sys; print('%.4f' % json.load(open(sys.argv[1]))['ate_rmse_m'])" "$out/$1.json"
}
for rig in stereo rgbd; do
  echo "== $rig beside a robot"
  # The recording has boxes, which a live run does not have.
  $bin/headway-replay -q -w -i "$out/$rig.rawlog" -o "$out/replay-$rig" --detector stereo_motion+shape
  echo "replay: ATE $(ate replay-$rig $rig) m"
  for run in $(seq "${RUNS:-5}"); do
    start live-$rig-$run
    $bench -i "$out/$rig.rawlog" --domain "$ROS_DOMAIN_ID"
    stop
    echo "live $run: ATE $(ate live-$rig-$run $rig) m"
  done
done

echo "== memory over ${MINUTES:-30} minutes of laps"
printf '[ros2]\nodometry = none\n' >"$out/laps.ini"  # which jumps back to the start of each lap
start laps "$out/laps.ini"
$bench -i "$out/stereo.rawlog" --domain "$ROS_DOMAIN_ID" --laps $((${MINUTES:-30} * 60 * 10 / 417)) --first 70 --end 487 &
robot=$!
for ((minute = 1; ; ++minute)); do
  sleep 60
  kill -0 $robot 2>/dev/null || break
  awk -v minute=$minute '/RssAnon/ { printf "%d min: %.1f MB\n", minute, $2 / 1024 }' /proc/$program/status
done
stop
