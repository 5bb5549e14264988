#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Prints errors and 90 % ellipses of predictions by sequence, class, speed and range: on exact
# histories, on headway's tracks from PointRCNN's boxes, and on its tracks from exact boxes.
#   HEADWAY_DATA=DATA tests/bench/predictions.sh [OUT]
# DATA contains kitti_tracking/; OUT (default out/predictions) contains rawlogs and results.
set -euo pipefail
cd "$(dirname "$0")/../.."
data=${HEADWAY_DATA:?names no folder of real data}
out=${1:-out/predictions}
bin=build/release/bin
training=$data/kitti_tracking/training

# evaluate ARGUMENTS...: the tables of one set of predictions
evaluate() {
  $bin/headway-eval predictions --truth "$training/label_02" --poses "$training/pose_orbslam3" \
    --coverage "$@"
}

echo "Exact histories"
for predictor in mixture constant_velocity; do evaluate --predictor "$predictor"; done

for boxes in det3d_pointrcnn label_02; do
  mkdir -p "$out/$boxes/predictions"
  for labels in "$training"/label_02/*.txt; do
    sequence=$(basename "$labels" .txt)
    rawlog=$out/$boxes/$sequence.rawlog
    [ -f "$rawlog" ] || $bin/headway-import kitti-tracking "$data/kitti_tracking" \
      --sequence "$sequence" --boxes "$boxes" -q -o "$rawlog"
    $bin/headway-replay -i "$rawlog" -o "$out/$boxes/$sequence" -w -q --snapshots 0
    cp "$out/$boxes/$sequence/predictions.csv" "$out/$boxes/predictions/$sequence.csv"
  done
  echo
  echo "Tracks from boxes $boxes"
  evaluate --estimate "$out/$boxes/predictions"
done
