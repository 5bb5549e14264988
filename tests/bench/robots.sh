#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Measures what small rigs see in the worlds for robots, by images alone: moving objects, the occupancy grid, people, and
# how often they are where they were predicted, by images and by recorded boxes.
#   [SEEDS="11 12 13"] [FRAMES=120] tests/bench/robots.sh [OUT]
# OUT (default out/robots) contains rawlogs and results; existing rawlogs are reused.
set -euo pipefail
cd "$(dirname "$0")/../.."
out=${1:-out/robots}
seeds=${SEEDS:-11 12 13}
frames=${FRAMES:-120}
bin=build/release/bin
mkdir -p "$out"

# recorded NAME OPTIONS...: the recording NAME in OUT
recorded() {
  local rawlog=$out/$1.rawlog
  shift
  [ -f "$rawlog" ] || $bin/headway-sim -q --depth --masks --frames "$frames" -o "$rawlog" "$@"
}

# figures WORLD RIG KIND: the figures of all seeds
figures() { for seed in $seeds; do echo "$out/$1-$2-$seed.$3.json"; done; }

# replayed NAME: the results of the recording NAME, without the boxes in it, and its figures of people
replayed() {
  $bin/headway-replay -q -w -i "$out/$1.rawlog" -o "$out/$1" --snapshots 0 --detector stereo_motion+shape
  $bin/headway-eval people -q -w "$out/$1" --truth "$out/$1.truth" --json "$out/$1.people.json"
}

for world in yard-loop hall campus warehouse; do
  for rig in robot small rgbd; do
    for seed in $seeds; do
      recorded "$world-$rig-$seed" -c "config/worlds/$world.ini" --rig $rig --seed "$seed"
    done
  done
done
for seed in ${EMPTY_SEEDS:-31 32}; do
  recorded "empty-$seed" -c config/worlds/hall.ini --rig robot --seed "$seed" \
    --set traffic.pedestrians=0 --set traffic.idle_people=0
done

echo "Moving objects within the rig's reach, rig robot"
for world in yard-loop-robot hall-robot campus-robot warehouse-robot empty; do
  echo "== $world"
  build/release/tests/bench/detect/bench_moving_objects range=rig "$out/$world"-*.rawlog
done

echo
echo "Grid: visible obstacles within the rig's reach, all seeds together"
echo "Precision: cells called occupied that are obstacles or touch one (that are obstacles)"
echo -n "| world, rig | visible | observed | found | free alone | at 0.5-3 m: visible, found "
echo "| precision | phantoms | left by movers | drops, free |"
echo "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"
for world in yard-loop hall campus warehouse; do
  for rig in robot small rgbd; do
    for seed in $seeds; do
      name=$world-$rig-$seed
      replayed "$name"
      $bin/headway-eval grid -q -w --truth "$out/$name.truth" --estimate "$out/$name" --json "$out/$name.grid.json"
    done
    python3 tests/bench/robots_grid.py "$world, $rig" $(figures $world $rig grid)
  done
done

echo
echo "People: person-frames found (number), to the reach of the rig's line"
echo -n "| world, rig | walks < 1.5 m | 1.5-3 m | 3-7 m | 7 m- | stands < 1.5 m | 1.5-3 m | 3-7 m | 7 m- "
echo "| false rows | person rows right | false moving tracks |"
echo "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"
for world in yard-loop hall campus warehouse; do
  for rig in robot small rgbd; do
    python3 tests/bench/robots_people.py "$world, $rig" $(figures $world $rig people)
  done
done
for seed in ${EMPTY_SEEDS:-31 32}; do replayed "empty-$seed"; done
python3 tests/bench/robots_people.py "empty halls, robot" "$out"/empty-*.people.json

echo
echo "People who walk, by how they come, to the reach of the rig's line, all worlds together; time to their first row"
echo "| rig | head-on | crossing | leaving | in a group | from behind something | robot turns | median | within 1 s |"
echo "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"
for rig in robot small rgbd; do
  python3 tests/bench/robots_people.py --ways $rig $(for w in yard-loop hall campus warehouse; do figures $w $rig people; done)
done

# predicted NAME RESULTS KIND: how the predictions of RESULTS came true; no figures if no person is followed for 3 s
predicted() {
  $bin/headway-eval predictions -q -w --truth "$out/$1.truth/label_02.txt" --poses "$out/$1.truth/trajectory.tum" \
    --extrinsic "$out/$1.truth/calibration.yaml" --estimate "$out/$2/predictions.csv" --json "$out/$1.$3.json" ||
    rm -f "$out/$1.$3.json"
}

echo
echo "True positions of people in the 90 % ellipses of their predictions at 1 / 2 / 3 s, % (predictions)"
echo "| world, rig, by | straight on | turns | stands |"
echo "| --- | ---: | ---: | ---: |"
for world in yard-loop hall campus warehouse; do
  for rig in robot small rgbd; do
    for seed in $seeds; do
      name=$world-$rig-$seed
      $bin/headway-replay -q -w -i "$out/$name.rawlog" -o "$out/$name-boxes" --snapshots 0
      predicted "$name" "$name" by_images
      predicted "$name" "$name-boxes" by_boxes
    done
    for by in images boxes; do
      python3 tests/bench/robots_ellipses.py "$world, $rig, $by" $(ls $(figures $world $rig by_$by) 2> /dev/null)
    done
  done
done
