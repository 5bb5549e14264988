#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Programs start, work and end under Valgrind: no invalid access, no use of values never set, nothing lost.
# Of libraries that are not ours, valgrind.txt names what is passed over.
# Usage: valgrind.sh BIN_DIR SOURCE_DIR
set -euo pipefail
bin=$1 source=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export LIBGL_ALWAYS_SOFTWARE=1 OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
# libhwy, which FFmpeg's libraries link, reads a clock when it is loaded by an instruction that valgrind 3.19 does not
# know on every processor. Nothing calls it here, so that an empty library of its name will do.
cc -shared -Wl,-soname,libhwy.so.1 -o "$work/libhwy.so.1" -x c /dev/null
export LD_LIBRARY_PATH="$work${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
memcheck=(valgrind --quiet --error-exitcode=99 --leak-check=full --show-leak-kinds=definite
  --errors-for-leak-kinds=definite --num-callers=40 --suppressions="$source/tests/sanitizers/valgrind.txt")

# ends_with STATUS COMMAND ...
ends_with() {
  local wanted=$1 status=0
  shift
  "$@" >"$work/output" 2>&1 || status=$?
  [ "$status" -eq "$wanted" ] && return 0
  echo "exit status $status instead of $wanted: $*"
  cat "$work/output"
  return 1
}

for program in replay live import export render eval sim nav; do
  for option in --version --help; do
    ends_with 0 "${memcheck[@]}" "$bin/headway-$program" $option
  done
done
ends_with 2 "${memcheck[@]}" "$bin/headway-replay" --no-such-option
ends_with 1 "${memcheck[@]}" "$bin/headway-replay" -i "$work/none.rawlog" -o "$work/none"
ends_with 0 "${memcheck[@]}" "$bin/headway-replay" -q --snapshots 0 -i "$source/rawlogs/street.rawlog" --to-index 5 \
  -o "$work/street"

# A camera that is a rawlog, until the first status line; then SIGTERM.
cat >"$work/sensors.ini" <<INI
[CAM]
driver = CCameraSensor
grabber_type = rawlog
rawlog_file = $source/rawlogs/street.rawlog
process_rate = 2
pose_z = 1.65
pose_yaw = -90
pose_roll = -90
INI
live() {
  "${memcheck[@]}" "$bin/headway-live" --sensors "$work/sensors.ini" -o "$work/live" &
  local process=$!
  for _ in $(seq 600); do
    kill -0 $process 2>/dev/null || break
    [ -s "$work/live/trajectory_online.tum" ] && break
    sleep 0.5
  done
  kill -TERM $process
  wait $process
}
ends_with 0 live
