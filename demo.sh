#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# From a clean Debian 12 to pictures: installs what is missing, builds all programs, replays the bundled
# street and the bundled hall, and compares the trajectories with the truth.
set -euo pipefail
cd "$(dirname "$0")"
source libs/cmake/setup.sh
install_packages
build_preset release installed
bin=build/release/bin

for name in street hall; do
  out=out/$name
  $bin/headway-replay -i rawlogs/$name.rawlog -o $out -w
  $bin/headway-render -i $out -o $out/top.png --view top -w
  $bin/headway-eval trajectory --truth rawlogs/$name.truth/trajectory.tum \
    --estimate $out/trajectory.tum --plot $out/trajectory.png -w
done

for name in street hall; do
  out=out/$name
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
