#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Counts at how many moments it is noticed that one of two cameras fails, at several image sizes, with and without wheel
# odometry, and of how many good frames that is said. Ends with the bars that are missed, and fails then. Needs the
# targets bench_one_eye, headway-import and -sim.
#   [HEADWAY_DATA=DATA] tests/bench/one_eye.sh [--check] [OUT]
# OUT (default out/one_eye) contains rawlogs; existing ones are reused. An hour. --check measures nothing: it compares
# OUT/measured.txt with the bars.
set -euo pipefail
cd "$(dirname "$0")/../.."
source tests/bench/bars.sh
begin out/one_eye "$@"
bin=build/release/bin
bench=build/release/tests/bench/pipeline/bench_one_eye

measure() {
  local rawlog world odometry every rate
  for odometry in "" --odometry; do
    echo "== failing rigs in the street $odometry"
    $bench rawlogs/street.rawlog --width 173 --width 336 --width 672 --width 1240 --moments 10 $odometry
    echo "== failing rigs in the hall $odometry"
    $bench rawlogs/hall.rawlog --width 173 --width 320 --width 640 --moments 5 $odometry
  done
  for world in warehouse campus hall yard-loop; do
    rate=()
    [ $world != yard-loop ] || rate=(--set camera.rate_hz=30)
    [ -f "$out/$world.rawlog" ] || $bin/headway-sim -q -o "$out/$world.rawlog" -c config/worlds/$world.ini --seed 811 \
      --rig robot --frames 300 --set recording.storage=external_jpeg "${rate[@]}"
  done
  if [ -n "${HEADWAY_DATA:-}" ]; then
    [ -f "$out/06.rawlog" ] || $bin/headway-import kitti-odometry "$HEADWAY_DATA/kitti_odometry" --sequence 06 -q \
      -o "$out/06.rawlog"
    [ -f "$out/euroc.rawlog" ] || $bin/headway-import euroc "$HEADWAY_DATA/euroc/MH_01_easy" -q -o "$out/euroc.rawlog"
  fi
  for rawlog in rawlogs/*.rawlog "$out"/*.rawlog; do
    for every in 1 2 3; do
      echo "== good frames, every $every of $rawlog"
      $bench "$rawlog" --width 173 --width 336 --width 640 --good --every $every
    done
  done
}

# missed FILE: the bars that what measure() printed misses, one a line
missed() {
  python3 - "$1" <<'PYTHON'
import re
import sys

good = alarms = 0
where = ""
for line in open(sys.argv[1]):
    if line.startswith("== "):
        where = line[3:].strip()
    if match := re.match(r" *(\d+) (\d+) good frames, (\d+) with an alarm", line):
        good += int(match[2])
        alarms += int(match[3])
        if int(match[3]) > 0:
            print(f"{where}, {match[1]} px: {match[3]} of {match[2]} good frames with an alarm")
    if match := re.match(r" *(\d+) (\S+) +named +(\d+) of (\d+) .*to the end +(\d+)", line):
        named, moments, kept = int(match[3]), int(match[4]), int(match[5])
        if named < moments or kept < moments:
            print(f"{where}, {match[1]} px, {match[2]}: of {moments} moments {named} named, {kept} without a pose")
if good < 10000:
    print(f"{good} good frames, must be 10000")
PYTHON
}

end
