#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Drives robots through simulated worlds by their own images, by true tracks, without predictions, and by the
# map's obstacles alone.
#   [SEED=1] [JOBS=2] tests/bench/drive.sh [--quick] [OUT]
# OUT (default out/drive) gets the figures of each cell as JSON and a video of the worst trial by images.
# A cell has 20 trials with rig robot, 10 with small and rgbd (hours); with --quick two of 20 s at 5 frames a
# second, which shows that everything runs.
set -euo pipefail
cd "$(dirname "$0")/../.."
quick=
[ "${1:-}" != --quick ] || { quick=1 && shift; }
out=${1:-out/drive}
options=(--set robot.time_limit_s=120)
[ -z "$quick" ] || options=(--set robot.time_limit_s=20 --set robot.planning_rate_hz=5)
mkdir -p "$out"

# drive WORLD RIG SENSE POLICY|map TRIALS [OPTION...]: one cell
drive() {
  local name=$1-$2-$3-$4 policy=$4 layer=()
  [ "$policy" != map ] || { policy=time_gated && layer=(--layer map); }
  echo "== $name"
  build/release/bin/headway-nav -w --world "$1" --rig "$2" --sense "$3" --policy "$policy" "${layer[@]}" --trials "$5" \
    --seed "${SEED:-1}" --jobs "${JOBS:-2}" "${options[@]}" --json "$out/$name.json" "${@:6}"
}

for world in hall campus warehouse yard-loop; do
  for rig in robot small rgbd; do
    trials=10
    [ $rig != robot ] || trials=20
    [ -z "$quick" ] || trials=2
    film=()
    [ -n "$quick" ] || film=(--worst "$out/$world-$rig-worst.mp4")
    drive $world $rig truth time_gated $trials
    drive $world $rig images static $trials
    drive $world $rig images map $trials
    drive $world $rig images time_gated $trials "${film[@]}"
  done
done
