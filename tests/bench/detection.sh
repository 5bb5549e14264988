#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Measures the detectors and prints the figures of doc/lab/detection.md.
#   HEADWAY_DATA=DATA tests/bench/detection.sh [OUT]
# Simulates worlds in OUT (default out/detection). DATA, with the layout of doc/results.md, is required
# for real recordings only.
set -euo pipefail
cd "$(dirname "$0")/../.."
out=${1:-out/detection}
bin=build/release/bin
bench=build/release/tests/bench/detect
frames=200
mkdir -p "$out"

worlds=()
for world in city-01:101 city-01:7 city-02:102 city-03:103 city-03:8 street:9; do
  name=${world%:*}-${world#*:}
  worlds+=("$out/$name.rawlog")
  [ -f "$out/$name.rawlog" ] || $bin/headway-sim -q -c "config/worlds/${world%:*}.ini" \
    --seed "${world#*:}" --frames $frames -o "$out/$name.rawlog"
done

echo "stereo_motion on simulated worlds: ${worlds[*]##*/}"
$bench/bench_moving_objects "${worlds[@]}"
echo
echo "Lifting of perfect 2D boxes on the same worlds, up to 30 m"
$bench/bench_lifting simulated "${worlds[@]}"

[ -n "${HEADWAY_DATA:-}" ] || exit 0
echo
echo "Surface depth of real cars, KITTI stereo 2015"
$bench/bench_lifting kitti "$HEADWAY_DATA/kitti_stereo_2015/training"
echo
echo "Edges of YOLOX-nano's boxes of these cars, relative to their width"
$bench/bench_lifting edges "$HEADWAY_DATA/kitti_stereo_2015/training" \
  "$HEADWAY_DATA/models/yolox_nano.onnx"

# key FILE NAME: one figure of a summary.json
key() { grep -o "\"$2\": [0-9.]*" "$1" | head -1 | cut -d' ' -f2; }
# stage FILE NAME: median of one stage
stage() { grep -A1 "\"$2\": {" "$1" | grep -o '"median": [0-9.]*' | cut -d' ' -f2; }

# clip SEQUENCE NAME OPTIONS...: a real clip with a detector, three times, the last one's figures
clip() {
  local sequence=$1 name=$1_$2
  shift 2
  [ -f "$out/$sequence.rawlog" ] || $bin/headway-import kitti-odometry \
    "$HEADWAY_DATA/kitti_odometry" --sequence "$sequence" -q -o "$out/$sequence.rawlog"
  for _ in 1 2 3; do
    $bin/headway-replay -i "$out/$sequence.rawlog" -o "$out/$name" -w -q --snapshots 0 "$@"
  done
  local s=$out/$name/summary.json
  printf '| %s | %s | %s | %s | %.1f | %.1f | %.1f | %.1f |\n' "$name" \
    "$(key "$s" detections_used)" "$(key "$s" tracks_confirmed)" "$(key "$s" tracks_moving)" \
    "$(stage "$s" detect)" "$(key "$s" frame_ms_median)" "$(key "$s" cpu_ms_per_frame)" \
    "$(awk "BEGIN { print 1000 / $(key "$s" frame_ms_mean) }")"
}

echo
echo "| clip | detections | tracks | moving | detect ms | frame ms | CPU ms | frames/s |"
echo "| --- | --- | --- | --- | --- | --- | --- | --- |"
dnn=(-c config/detectors/yolox_nano.ini --set "dnn.model=$HEADWAY_DATA/models/yolox_nano.onnx"
  --set detect.period_s=0.2)
for sequence in 06 01; do
  clip $sequence none --detector none
  clip $sequence stereo_motion --detector stereo_motion
  clip $sequence dnn --detector dnn "${dnn[@]}"
  clip $sequence dnn+stereo_motion --detector dnn+stereo_motion "${dnn[@]}"
done
