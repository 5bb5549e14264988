#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Counts false moving tracks of stereo_motion in worlds in which nothing moves (config/worlds/static).
#   [SEEDS="1 2 3"] tests/bench/static_worlds.sh [OUT]
# OUT (default out/static_worlds) contains rawlogs and results; existing rawlogs are reused.
set -euo pipefail
cd "$(dirname "$0")/../.."
out=${1:-out/static_worlds}
seeds=${SEEDS:-1 2 3}
bin=build/release/bin
mkdir -p "$out"

# moving OUTDIR: tracks with a confirmed moving row, and the number of such rows
moving() {
  awk -F, 'NR > 1 && $5 == "confirmed" && $6 == 1 { rows++; track[$3] = 1 }
           END { for (id in track) tracks++; print tracks + 0, rows + 0 }' "$1/tracks.csv"
}

echo "| world | seed | frames | false moving tracks | their confirmed rows |"
echo "| --- | ---: | ---: | ---: | ---: |"
for world in config/worlds/static/*.ini; do
  for seed in $seeds; do
    name=$(basename "$world" .ini)-$seed
    [ -f "$out/$name.rawlog" ] ||
      $bin/headway-sim -q -c "$world" --seed "$seed" -o "$out/$name.rawlog"
    $bin/headway-replay -q -w -i "$out/$name.rawlog" -o "$out/$name" --snapshots 0 \
      --detector stereo_motion
    frames=$(wc -l <"$out/$name/trajectory_kitti.txt")
    read -r tracks rows <<<"$(moving "$out/$name")"
    echo "| ${name%-*} | $seed | $frames | $tracks | $rows |"
  done
done
