#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Measures headway on real recordings and prints the figures of doc/lab.
#   HEADWAY_DATA=DATA tests/bench/real_data.sh [OUT]
# DATA has the layout of doc/results.md; OUT (default out/real_data) contains rawlogs and results.
set -euo pipefail
cd "$(dirname "$0")/../.."
data=${HEADWAY_DATA:?names no folder of real data}
out=${1:-out/real_data}
bin=build/release/bin
mkdir -p "$out"

# key FILE NAME: one figure of a summary.json
key() { grep -o "\"$2\": [0-9.]*" "$1" | head -1 | cut -d' ' -f2; }
# stage FILE NAME: median of one stage
stage() { grep -A1 "\"$2\": {" "$1" | grep -o '"median": [0-9.]*' | cut -d' ' -f2; }

# clip NAME IMPORT-ARGUMENTS...: a recording with images, three times, the last one's figures
clip() {
  local name=$1
  shift
  [ -f "$out/$name.rawlog" ] || $bin/headway-import "$@" -q -o "$out/$name.rawlog"
  for _ in 1 2 3; do
    $bin/headway-replay -i "$out/$name.rawlog" -o "$out/$name" -w -q --snapshots 0 --detector none
  done
  local ate s=$out/$name/summary.json
  ate=$($bin/headway-eval trajectory --truth "$out/$name.rawlog" \
    --estimate "$out/$name/trajectory.tum" | awk '/ATE RMSE/ { print $5 }')
  printf '| %s | %s of %s | %s | %.1f | %.1f | %.1f | %.0f | %.2f |\n' "$name" \
    "$(key "$s" frames_tracked)" "$(key "$s" frames)" "$ate" "$(stage "$s" slam_track)" \
    "$(key "$s" frame_ms_median)" "$(key "$s" cpu_ms_per_frame)" "$(key "$s" peak_memory_mb)" \
    "$(key "$s" start_up_s)"
}

echo "| recording | tracked | ATE RMSE m | slam_track ms | frame ms | CPU ms | MB | start-up s |"
echo "| --- | --- | --- | --- | --- | --- | --- | --- |"
clip kitti_06 kitti-odometry "$data/kitti_odometry" --sequence 06
clip kitti_01 kitti-odometry "$data/kitti_odometry" --sequence 01
clip euroc_mh01 euroc "$data/euroc/MH_01_easy"

echo
echo "Predictors on exact histories"
training=$data/kitti_tracking/training
$bin/headway-eval predictions --truth "$training/label_02" --poses "$training/pose_orbslam3" \
  --predictor all

# tracking GROUP SEQUENCES...: 3D tracking from a lidar network's boxes, judged as one set
tracking() {
  local group=$out/$1 sequence rawlog
  shift
  mkdir -p "$group/tracks" "$group/labels"
  for sequence in "$@"; do
    rawlog=$out/$sequence.rawlog
    [ -f "$rawlog" ] || $bin/headway-import kitti-tracking "$data/kitti_tracking" \
      --sequence "$sequence" --boxes det3d_pointrcnn -q -o "$rawlog"
    $bin/headway-replay -i "$rawlog" -o "$out/$sequence" -w -q --snapshots 0
    cp "$out/$sequence/tracks_kitti.txt" "$group/tracks/$sequence.txt"
    cp "$training/label_02/$sequence.txt" "$group/labels/$sequence.txt"
  done
  $bin/headway-eval tracks --truth "$group/labels" --estimate "$group/tracks" --metric 3d --iou 0.25
}

echo
echo "3D tracking from PointRCNN boxes, 3D IoU 0.25"
tracking compared 0001 0006 0008 0010 0012 0013 0014 0015 0016 0018
echo
echo "The same on the other sequences"
tracking others 0000 0002 0003 0004 0005 0007 0009 0011 0017
