#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Prints the table "your rig -> what you get" of doc/results.md, from simulated recordings with exact truth, by images
# alone. Seeds that no parameter was chosen with are the ones to report.
#   SEEDS="4242" [FRAMES=300] tests/bench/rigs.sh [OUT]
# OUT (default out/rigs) contains rawlogs and results; existing rawlogs are reused.
set -euo pipefail
cd "$(dirname "$0")/../.."
out=${1:-out/rigs}
seeds=${SEEDS:?names seeds}
frames=${FRAMES:-300}
bin=build/release/bin
mkdir -p "$out"

# measured RIG WORLD SEED: results and figures of one recording
measured() {
  local name=$out/$1-$2-$3 detector=stereo_motion+shape  # `auto` of a recording without boxes
  [ "$1" != car ] || detector=stereo_motion
  [ -f "$name.rawlog" ] || $bin/headway-sim -q --depth --masks --frames "$frames" -o "$name.rawlog" \
    -c "config/worlds/$2.ini" --rig "$1" --seed "$3"
  $bin/headway-replay -q -w -i "$name.rawlog" -o "$name" --snapshots 0 --detector "$detector"
  $bin/headway-eval trajectory -q -w --truth "$name.truth/trajectory.tum" --estimate "$name/trajectory.tum" \
    --json "$name.path.json"
  $bin/headway-eval people -q -w "$name" --truth "$name.truth" --json "$name.people.json"
  $bin/headway-eval grid -q -w --truth "$name.truth" --estimate "$name" --json "$name.grid.json"
}

for seed in $seeds; do
  measured car street "$seed"
  for rig in robot small rgbd; do
    for world in hall campus warehouse yard-loop; do
      measured $rig $world "$seed"
    done
  done
done

echo -n "| rig | path error m, mean (worst) | walking, < 1.5 m | 1.5-3 m | 3-7 m | standing, < 1.5 m | 1.5-3 m | 3-7 m "
echo "| false rows | grid: found of observed | precision with touch | CPU ms a frame |"
echo "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"
for rig in car robot small rgbd; do
  paths=()
  for seed in $seeds; do paths+=("$out/$rig"-*-"$seed".path.json); done
  python3 tests/bench/rigs_row.py $rig "${paths[@]}"
done
