#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Covers a robot's camera for five seconds, every three seconds of each recording: error of the motion
# across the gap against the way driven in it, where wheel odometry bridges it.
#   [SEEDS="1 2 3"] [WORLDS="hall yard-loop"] [RIGS="robot small"] [FRAMES=170]
#     tests/bench/slam/covered.sh [OUT]
# OUT (default out/covered) keeps the tables; recordings are deleted.
set -euo pipefail
cd "$(dirname "$0")/../../.."
out=${1:-out/covered}
bin=build/release/bin
mkdir -p "$out"
for world in ${WORLDS:-hall yard-loop}; do
  for rig in ${RIGS:-robot small}; do
    for seed in ${SEEDS:-1 2 3}; do
      name=$out/$world-$rig-$seed
      $bin/headway-sim -q -w -c "config/worlds/$world.ini" --rig "$rig" --seed "$seed" --frames "${FRAMES:-170}" \
        --set camera.odometry=true --set camera.colour=false -o "$name.rawlog"
      build/release/tests/bench/slam/bench_covered -i "$name.rawlog" | tee "$name.txt"
      rm -r "$name".rawlog "${name}_Images" 2>/dev/null || true
    done
  done
done
