#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Records the worlds from which people's shapes are learnt, three frames a second.
#   SEEDS="911 912" training/record.sh OUT
# OUT contains rawlogs and their truth; existing ones are kept.
set -euo pipefail
out=$(realpath -m "$1")
cd "$(dirname "$0")/.."
mkdir -p "$out"

# recorded WORLD RIG SEED OPTIONS...
recorded() {
  local world=$1 rig=$2 seed=$3
  shift 3
  [ -f "$out/$world-$rig-$seed.rawlog" ] ||
    build/release/bin/headway-sim -q -c "config/worlds/$world.ini" --rig "$rig" --seed "$seed" \
      --set camera.rate_hz=3 --frames 80 -o "$out/$world-$rig-$seed.rawlog" "$@"
}

people="--set traffic.varied_bodies=true --set traffic.idle_people=40 --set traffic.pedestrians=50
  --set traffic.encounter_ratio=0.8 --set traffic.stop_rate_hz=0.15 --set world.machines=40"
for seed in $SEEDS; do
  for rig in robot small rgbd; do
    recorded hall $rig "$seed" $people
    recorded warehouse $rig "$seed" $people
  done
  recorded campus robot "$seed" $people
  recorded street car "$seed" --set traffic.pedestrians=60
done
