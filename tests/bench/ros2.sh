#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Measures headway-live as a node of ROS 2 beside a robot of another implementation of DDS, on the loopback: transport,
# image to obstacles, trajectory against a replay's, memory. Ends with the bars that are missed, and fails then. Needs
# the targets bench_ros2, headway-live, -replay, -sim and -eval.
#   [RUNS=5] [MINUTES=30] tests/bench/ros2.sh [--check] [OUT]
# OUT (default out/ros2) contains rawlogs and results; existing rawlogs are reused. An hour; RUNS=1 MINUTES=2: ten
# minutes. --check measures nothing: it compares OUT/measured.txt with the bars.
set -euo pipefail
cd "$(dirname "$0")/../.."
source tests/bench/bars.sh
begin out/ros2 "$@"
bin=build/release/bin
bench=build/release/tests/ros2/bench_ros2
export ROS_DOMAIN_ID=${ROS_DOMAIN_ID:-77}

recorded() {
  local rawlog=$out/$1.rawlog
  shift
  [ -f "$rawlog" ] || $bin/headway-sim -q -o "$rawlog" -c config/worlds/hall.ini --seed 61 \
    --set recording.storage=embedded "$@"
}

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

measure() {
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
  $bench -i "$out/stereo.rawlog" --domain "$ROS_DOMAIN_ID" --laps $((${MINUTES:-30} * 60 * 10 / 417)) --first 70 \
    --end 487 &
  robot=$!
  for ((minute = 1; ; ++minute)); do
    sleep 60
    kill -0 $robot 2>/dev/null || break
    awk -v minute=$minute '/RssAnon/ { printf "%d min: %.1f MB\n", minute, $2 / 1024 }' /proc/$program/status
  done
  stop
}

# missed FILE: the bars that what measure() printed misses, one a line
missed() {
  python3 - "$1" <<'PYTHON'
import re
import sys

missed, ate, memory, seen, rig, limit = [], {}, [], set(), "", 0


def require(holds: bool, bar: str) -> None:
    if not holds:
        missed.append(bar)


for line in open(sys.argv[1]):
    if match := re.match(r"== transport; receive buffers of at most (\d+)", line):
        limit = int(match[1])
    elif match := re.match(r"== (\w+) beside a robot", line):
        rig = match[1]
    elif match := re.match(r"(.+): image to node: (\d+) of (\d+) images, p50 (\S+) ms", line):
        name, got, sent, p50 = match[1], int(match[2]), int(match[3]), float(match[4])
        seen.add("transport of " + name)
        # 1280x720 without compression needs buffers that the system may not allow.
        if name != "raw" or limit >= 1 << 24:
            require(got == sent > 0, f"{name}: {got} of {sent} images received")
        if name == "stereo":
            require(p50 <= 5.0, f"{name}: transport p50 {p50} ms, must be 5")
    elif match := re.match(r"image to obstacles: .* p99 (\S+) ms", line):
        seen.add("obstacles of " + rig)
        if rig == "stereo":
            require(float(match[1]) <= 120.0, f"{rig}: image to obstacles p99 {match[1]} ms, must be 120")
    elif match := re.match(r"(replay|live \d+): ATE (\S+) m", line):
        error = float(match[2])
        if match[1] == "replay":
            ate[rig] = error
            continue
        seen.add("ATE of " + rig)
        require(error <= 1.1 * ate[rig], f"{rig}, {match[1]}: ATE {error} m, must be 1.1 of the replay's {ate[rig]}")
    elif match := re.match(r"\d+ min: (\S+) MB", line):
        memory.append(float(match[1]))

for what in ("transport of stereo", "transport of rgbd", "transport of raw", "transport of stereo, compressed",
             "transport of raw, compressed", "obstacles of stereo", "obstacles of rgbd", "ATE of stereo", "ATE of rgbd"):
    require(what in seen, what + ": not measured")
require(len(memory) >= 2, "memory: not measured")
if len(memory) >= 2:
    half = memory[(len(memory) - 1) // 2]
    require(memory[-1] <= 1.1 * half, f"memory: {half} MB after half of the time, {memory[-1]} MB in the end")
print("\n".join(missed))
PYTHON
}

end
