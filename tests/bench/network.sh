#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Measures stereo_motion with and without a network on a real street: frames 0-109 of KITTI raw
# 2011_09_26_drive_0005, which are tracking sequence 0000, from images alone.
#   HEADWAY_DATA=DATA tests/bench/network.sh [OUT]
# Prints headway-eval's tables of moving and of labelled objects, and the time per frame.
set -euo pipefail
cd "$(dirname "$0")/../.."
out=${1:-out/network}
bin=build/release/bin
: "${HEADWAY_DATA:?names no folder of real data}"
model=$HEADWAY_DATA/models/yolox_nano.onnx
mkdir -p "$out"

[ -f "$out/0005.rawlog" ] || $bin/headway-import kitti-raw "$HEADWAY_DATA/kitti_raw" \
  --drive 2011_09_26_drive_0005_sync -q -o "$out/0005.rawlog"

$bin/headway-replay --check-model "$model"

# run NAME OPTIONS...: one replay, its errors and times
run() {
  local name=$1
  shift
  $bin/headway-replay -i "$out/0005.rawlog" -o "$out/$name" -w -q --snapshots 0 "$@"
  echo
  echo "$name"
  $bin/headway-eval movers --truth "$HEADWAY_DATA/kitti_tracking/training/label_02/0000.txt" \
    --poses "$out/0005.rawlog" --estimate "$out/$name" --json "$out/$name.json" |
    sed '/^Motion by/,$d'
  grep -E '"frame_ms_median"|"cpu_ms_per_frame"|"frames_dropped_late"' "$out/$name/summary.json"
}

run stereo_motion --detector stereo_motion
run auto --detector auto --set "dnn.model=$model"
run realtime --detector auto --set "dnn.model=$model" --realtime 1
