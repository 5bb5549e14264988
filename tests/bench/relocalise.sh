#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Counts how often a lost camera is found again in a stored map, and how often in a wrong place: with people before the
# camera, furniture moved, another gamma, and in worlds that the map is not of, identical racks included. Ends with the
# bars that are missed, and fails then.
#   [SEEDS="701 702"] [PLACES=20] tests/bench/relocalise.sh [--check] [OUT]
# OUT (default out/relocalise) contains rawlogs; existing ones are reused. --check measures nothing: it compares
# OUT/measured.txt with the bars.
set -euo pipefail
cd "$(dirname "$0")/../.."
source tests/bench/bars.sh
begin out/relocalise "$@"
seeds=${SEEDS:-701 702}
places=${PLACES:-20}
bin=build/release/bin
bench=build/release/tests/bench/slam/bench_relocalisation

# recorded NAME WORLD SEED OPTIONS...: the recording NAME in OUT, of a tour
recorded() {
  local rawlog=$out/$1.rawlog world=$2 seed=$3
  shift 3
  [ -f "$rawlog" ] || $bin/headway-sim -q -c "config/worlds/$world.ini" --rig small --seed "$seed" -o "$rawlog" \
    --set camera.rate_hz=10 --set robot.tour_stops=5 --set recording.storage=external_jpeg "$@"
}

# tried NAME WORLD SEED SPEED OPTIONS...: all starts in the map of one world; others are as slow on the same way
tried() {
  local name=$1 world=$2 seed=$3 speed=$4 again=() elsewhere=()
  shift 4
  recorded "$name" "$world" "$seed" --frames 400 "$@"
  for change in traffic.cover=0 traffic.cover=0.3 traffic.cover=0.6 world.moved_ratio=0.3 camera.gamma=0.5 \
    camera.gamma=2; do
    recorded "$name-$change" "$world" "$seed" --frames 240 --set "route.speed_mps=$speed" --set $change "$@"
    again+=(--restart "$out/$name-$change.rawlog")
  done
  for other in hall warehouse; do
    recorded "$other-$((seed + 100))" $other $((seed + 100)) --frames 240
    elsewhere+=(--elsewhere "$out/$other-$((seed + 100)).rawlog")
  done
  recorded "racks-$((seed + 100))" warehouse $((seed + 100)) --frames 240 --set world.identical_racks=true
  elsewhere+=(--elsewhere "$out/racks-$((seed + 100)).rawlog")
  echo "== $name"
  $bench --map "$out/$name.rawlog" "${again[@]}" --mapped --places "$places" | grep -v '^  frame'
  # No second of another world is this one.
  $bench --map "$out/$name.rawlog" "${elsewhere[@]}" --places $((3 * places)) | grep -v '^  frame'
  echo "where nothing is mapped:"
  $bench --map "$out/$name.rawlog" --map-to 150 --restart "$out/$name.rawlog" --restart-from 200 \
    --places $((3 * places)) | grep -v '^  frame'
}

measure() {
  for seed in $seeds; do
    tried "hall-$seed" hall "$seed" 0.65
    tried "warehouse-$seed" warehouse "$seed" 0.9
    tried "racks-$seed" warehouse "$seed" 0.9 --set world.identical_racks=true
  done
}

# missed FILE: the bars that what measure() printed misses, one a line
missed() {
  python3 - "$1" <<'PYTHON'
import re
import sys

tried = wrong = 0
right: dict[str, list[int]] = {}
is_mapped = True
for line in open(sys.argv[1]):
    is_mapped = is_mapped and not line.startswith("where nothing is mapped")
    if line.startswith("== "):
        is_mapped = True
    if not (match := re.match(r"(\S+?)( \(another world\))?: (\d+) of (\d+) found, (\d+) of them wrong", line)):
        continue
    found, places, elsewhere = (int(match[i]) for i in (3, 4, 5))
    if match[2]:
        tried += places
        wrong += found
        continue
    if not is_mapped:
        # Where the tour comes back, a start is found rightly.
        tried += places - (found - elsewhere)
        wrong += elsewhere
        continue
    wrong += elsewhere
    if change := re.search(r"-\d+-([a-z]\S+)\.rawlog$", match[1]):
        counts = right.setdefault(change[1], [0, 0])
        counts[0] += found - elsewhere
        counts[1] += places
if wrong > 0 or tried < 1000:
    print(f"{tried} starts at wrong places, must be 1000, and {wrong} found in a wrong one, must be 0")
for change, (found, places) in right.items():
    if found < 0.95 * places:
        print(f"{change}: {found} of {places} found in 3 s, must be 95 %")
if not right:
    print("right places: not measured")
PYTHON
}

end
