#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Drives robots through simulated worlds by their own images, by true tracks, without predictions, and by the
# map's obstacles alone, and among people of a simulated detector. Ends with the bars that are missed, and fails then.
#   [SEED=1] [JOBS=2] [WORLDS=...] [RIGS=...] tests/bench/drive.sh [--quick] [--check] [OUT]
# OUT (default out/drive) gets the figures of each cell as JSON and a video of the worst trial by images.
# A cell has 20 trials with rig robot, 10 with small and rgbd (hours); with --quick two of 20 s at 5 frames a
# second, which shows that everything runs. --check drives nothing: it compares what OUT contains with the bars.
set -euo pipefail
cd "$(dirname "$0")/../.."
source tests/bench/bars.sh
quick=
[ "${1:-}" != --quick ] || { quick=1 && shift; }
begin out/drive "$@"
options=(--set robot.time_limit_s=120)
[ -z "$quick" ] || options=(--set robot.time_limit_s=20 --set robot.planning_rate_hz=5)

# drive NAME TRIALS OPTION...: one cell
drive() {
  echo "== $1"
  build/release/bin/headway-nav -q -w --trials "$2" --jobs "${JOBS:-2}" --json "$out/$1.json" "${@:3}"
}

# in_world WORLD RIG SENSE POLICY|map TRIALS [OPTION...]: the same trials for each sense and policy
in_world() {
  local policy=$4 layer=()
  [ "$policy" != map ] || { policy=time_gated && layer=(--layer map); }
  drive "$1-$2-$3-$4" "$5" --world "$1" --rig "$2" --sense "$3" --policy "$policy" "${layer[@]}" --seed "${SEED:-1}" \
    "${options[@]}" "${@:6}"
}

measure() {
  local world rig seed trials film
  for world in ${WORLDS:-hall campus warehouse yard-loop}; do
    for rig in ${RIGS:-robot small rgbd}; do
      trials=10
      [ $rig != robot ] || trials=20
      [ -z "$quick" ] || trials=2
      film=()
      [ -n "$quick" ] || film=(--worst "$out/$world-$rig-worst.mp4")
      in_world $world $rig truth time_gated $trials
      in_world $world $rig images static $trials
      in_world $world $rig images map $trials
      in_world $world $rig images time_gated $trials "${film[@]}"
    done
  done
  trials=200
  [ -z "$quick" ] || trials=2
  for seed in 90210 $((${SEED:-1} + 1000)) $((${SEED:-1} + 2000)) $((${SEED:-1} + 3000)) $((${SEED:-1} + 4000)); do
    drive "detections-$seed" $trials --policy all --seed $seed
  done
  python3 tests/bench/drive_table.py "$out"
}

missed() { python3 tests/bench/drive_table.py --missed "$out"; }

end
