#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds the Debian packages libheadway0, libheadway-dev, headway and python3-headway: package.sh [FOLDER].
# The packages, *.changes and lintian's report are in FOLDER, by default build/package.
# Two builds of one tree give the same bytes, in whatever folder and at whatever time.
set -euo pipefail
cd "$(dirname "$0")"
source libs/cmake/setup.sh
install_packages packages.txt packaging/packages.txt
output=$(realpath -m "${1:-build/package}")
source_folder=$output/headway
rm -rf "$source_folder"
mkdir -p "$source_folder"
tar --exclude=./build --exclude=./out --exclude=./.git -cf - . | tar -xf - -C "$source_folder"
cp -r packaging/debian "$source_folder/debian"
packaging/changelog.sh > "$source_folder/debian/changelog"

# debhelper's builds have no home in which ccache would look for its folder. A base folder would make names of sources in
# the plug-in depend on where it is built.
if command -v ccache >/dev/null && [ -z "${CCACHE_DISABLE:-}" ]; then
  CCACHE_DIR=$(ccache --get-config cache_dir)
  export CCACHE_DIR CCACHE_BASEDIR=
  [ ! -f ~/.config/ccache/ccache.conf ] || export CCACHE_CONFIGPATH=~/.config/ccache/ccache.conf
fi
export DEB_BUILD_OPTIONS="${DEB_BUILD_OPTIONS:-noautodbgsym} parallel=$(nproc)"
(cd "$source_folder" && dpkg-buildpackage --build=binary --no-sign)

lintian --fail-on error,warning --info "$output"/*.changes | tee "$output/lintian.txt"
ls -l "$output"/*.deb
