#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Run in an empty Debian that has headway's packages in /packages and a project that uses them in /project.
set -euo pipefail
fail() {
  echo "$1" >&2
  exit 1
}
apt() { apt-get -qq -o Dpkg::Use-Pty=0 "$@" > /packages/apt.log 2>&1 || { tail -20 /packages/apt.log; fail "apt-get $*"; }; }
share=/usr/share/headway

echo "== install"
apt update
apt install -y --no-install-recommends man-db bash-completion mrpt-apps
apt install -y --no-install-recommends /packages/*.deb
work=/packages/work
mkdir $work
cd "$work"

echo "== the main job on the bundled street"
headway-replay -q -i $share/rawlogs/street.rawlog -o street
for file in trajectory.tum tracks.csv predictions.csv map.headway report.html summary.json; do
  [ -s street/$file ] || fail "street/$file was not written"
done
headway-eval trajectory -q --truth $share/rawlogs/street.truth/trajectory.tum --estimate street/trajectory.tum \
  --json errors.json
python3 - <<'P'
import json
error = json.load(open('errors.json'))['ate_rmse_m']
assert 0 < error < 0.031, f'{error} m on the bundled street'
print(f'absolute trajectory error {error:.3f} m')
P
headway-render -q -i street -o top.png --view top
[ -s top.png ] || fail "headway-render drew nothing"

echo "== installed worlds and configuration are found by the names that the documents give"
headway-sim -q -c config/worlds/street.ini --frames 3 -o made.rawlog
headway-replay -q -c config/presets/small_computer.ini -i made.rawlog -o made

echo "== ROS 2"
headway-live --ros2 config/ros2.ini --ros2-list --ros2-interface lo > topics.txt || fail "--ros2-list"
grep -q '^no topics on ROS 2 domain 0 on lo' topics.txt || { cat topics.txt; fail "--ros2-list does not say where it is"; }
[ -s $share/config/ros2.ini ] || fail "$share/config/ros2.ini is missing"

echo "== documents"
for document in README.md CHANGELOG.md doc/licences.md doc/ros2.md copyright changelog.gz; do
  [ -s /usr/share/doc/headway/$document ] || fail "/usr/share/doc/headway/$document is missing"
done
for package in headway libheadway0 libheadway-dev python3-headway; do
  version=$(dpkg-query -W -f='${Version}' $package)
  zcat /usr/share/doc/$package/changelog.gz | grep > /dev/null "^headway ($version)" || fail "the changelog of $package lacks $version"
  grep -q BSD-3-Clause /usr/share/doc/$package/copyright || fail "$package has no licence"
done
for program in /usr/bin/headway-*; do
  [ "$("$program" --version)" = "$(basename "$program") $version" ] || fail "$program is not of version $version"
done

echo "== manual pages"
for program in /usr/bin/headway-*; do
  page=$(MANWIDTH=100 man "$(basename "$program")") || fail "no manual page of $program"
  for section in NAME SYNOPSIS DESCRIPTION; do
    grep -q "^$section" <<< "$page" || fail "$program's manual page has no $section"
  done
done
man headway-replay | grep > /dev/null -- '--load-map FILE' || fail "headway-replay's page lacks its options"
man headway-import-euroc | grep > /dev/null -- '--from-index N' || fail "headway-import euroc has no page"

echo "== documents"
python3 /packages/document_links.py /usr/share/doc/headway || fail "a document's link"

echo "== completion"
complete_line() {
  bash -c 'source /usr/share/bash-completion/bash_completion
    _completion_loader "$1"
    COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
    COMP_LINE="$*"; COMP_POINT=${#COMP_LINE}
    compopt() { :; }  # bash has it while completing only
    _headway "$1" "${@: -1}" "${@: -2:1}"; printf "%s\n" "${COMPREPLY[@]}"' _ "$@"
}
complete_line headway-import eu | grep -x > /dev/null euroc || fail "sub-commands are not completed"
complete_line headway-replay --load | grep -x > /dev/null -- --load-map || fail "options are not completed"
complete_line headway-fleet --places r | grep -x > /dev/null recognised || fail "choices of headway-fleet are not completed"
complete_line headway-replay --set slam.loop | grep > /dev/null '^slam\.loop.*=$' || fail "keys are not completed"

echo "== MRPT's own tools with the plug-in"
rawlog-edit -p libheadway-plugin.so --info -i $share/rawlogs/street.rawlog > info.txt 2>&1 || { cat info.txt; fail rawlog-edit; }
grep -q 'detections / *120' info.txt || fail "rawlog-edit does not know the detections"

echo "== Python"
python3 - <<'P'
import headway
source = headway.RawlogSource('/usr/share/headway/rawlogs/street.rawlog')
frame = next(iter(source))
assert frame.left.shape[0] == 256, frame.left.shape
P

echo "== a project that uses the libraries"
apt install -y --no-install-recommends cmake g++ make
cmake -S /project -B consumer -DCMAKE_BUILD_TYPE=Release > cmake.log 2>&1 || { cat cmake.log; fail "find_package"; }
cmake --build consumer > build.log 2>&1 || { tail -30 build.log; fail "the project was not built"; }
consumer/follow $share/rawlogs/street.rawlog > follow.txt || fail "follow"
[ -s follow.txt ] || fail "follow printed nothing"

echo "== all public headers and libraries, with nothing but what libheadway-dev brings"
mkdir all
cat > all/CMakeLists.txt <<'E'
cmake_minimum_required(VERSION 3.20)
project(everything LANGUAGES CXX)
find_package(headway REQUIRED)
add_executable(everything all.cpp)
file(GLOB folders /usr/include/headway/*)
foreach(folder IN LISTS folders)
  get_filename_component(library ${folder} NAME)
  target_link_libraries(everything PRIVATE headway::${library})
endforeach()
E
(cd /usr/include && printf '#include <%s>\n' headway/*/*.h) > all/all.cpp
echo 'int main() { return *headway::kVersion == 0; }' >> all/all.cpp
cmake -S all -B all/build > cmake.log 2>&1 || { cat cmake.log; fail "find_package without components"; }
cmake --build all/build > build.log 2>&1 || { tail -30 build.log; fail "a public header or library"; }
all/build/everything || fail "a program that is linked with all libraries"

echo "== removal"
cd /
rm -r "$work"
apt purge -y headway libheadway0 libheadway-dev python3-headway
# What man-db keeps of pages that were read is not the packages'.
rest=$(find / -xdev \( -path /proc -o -path /dev -o -path /packages -o -path /var/cache/man \) -prune -o -iname '*headway*' -print)
[ -z "$rest" ] || fail "remains after the removal: $rest"
if dpkg --get-selections | grep headway; then fail "dpkg still lists headway"; fi
echo "passed"
