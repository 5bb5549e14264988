#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Fails if a file in the packages of FOLDER contains one of the paths. Usage: no_paths.sh FOLDER PATH ...
set -euo pipefail
folder=$1
shift
contents=$(mktemp -d)
trap 'rm -r "$contents"' EXIT
for package in "$folder"/*.deb; do
  dpkg-deb --extract "$package" "$contents"
done
[ -n "$(find "$contents" -name 'libheadway_core.so.*' -print -quit)" ] || { echo "$folder has no libraries" >&2; exit 1; }
status=0
for path in "$@"; do
  found=$(grep -rlF --binary-files=text -e "$path" "$contents" || true)
  [ -z "$found" ] || { echo "these contain $path:"; echo "${found//$contents/}"; status=1; } >&2
done
exit $status
