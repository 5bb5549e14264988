#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# From a clean Debian 12 to pictures: installs what is missing, builds all programs, replays the bundled
# street and the bundled hall with a loop, the hall also from images alone, and compares with the truth.
set -euo pipefail
cd "$(dirname "$0")"
source libs/cmake/setup.sh
echo "demo.sh: installs missing packages, builds headway (10 minutes on two idle cores, later what has"
echo "changed) and replays a street and, twice, a hall (2 minutes)."
install_packages
build_preset release installed
bin=build/release/bin

replay() {  # replay RECORDING FOLDER OPTION...: its results and their errors
  local rawlog=rawlogs/$1.rawlog truth=rawlogs/$1.truth out=out/$2
  shift 2
  echo
  echo "headway-replay -i $rawlog -o $out --truth $truth $*"
  $bin/headway-replay -i $rawlog -o "$out" --truth $truth -w "$@"
  $bin/headway-render -i "$out" -o "$out/top.png" --view top -w
  $bin/headway-eval trajectory --truth $truth/trajectory.tum --estimate "$out/trajectory.tum" \
    --plot "$out/trajectory.png" -w
}
replay street street                                   # from boxes of a detector, recorded
replay hall_loop hall                                  # the same in a hall
replay hall_loop hall_images --detector stereo_motion  # from images alone

for out in out/street out/hall out/hall_images; do
  echo
  echo "pictures:   $(ls $out/snapshots/*.png | tr '\n' ' ')$out/top.png $out/trajectory.png"
  echo "trajectory: $out/trajectory.tum   tracks: $out/tracks.csv   map: $out/map.headway"
  [ ! -f $out/report.html ] || echo "report:     $out/report.html   in 3D: $out/replay.html"
done

programs=("$PWD/$bin"/headway-*)
echo
echo "programs:   ${#programs[@]} in $PWD/$bin; for the lines of README.md:"
echo "            export PATH=\"$PWD/$bin:\$PATH\" LD_LIBRARY_PATH=\"$PWD/build/release/lib\""
echo "            cmake --install build/release --prefix FOLDER   # installs them"
