#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds the Debian packages twice, compares their bytes, looks for paths of the build in them, and uses them in an
# empty Debian. As root. Usage: packages_test.sh SOURCE_DIR WORK_DIR
# SUITE: the Debian to use them in (bookworm).
set -euo pipefail
source_dir=$1
work=$2
here=$(cd "$(dirname "$0")" && pwd)
[ "$(id -u)" -eq 0 ] || { echo "installing packages in a Debian of its own takes root" >&2; exit 1; }
mkdir -p "$work"

echo "== built twice, in different folders, the second time without a compiler's cache"
"$source_dir/package.sh" "$work/first" > "$work/first.log" 2>&1 || { tail -30 "$work/first.log"; exit 1; }
CCACHE_DISABLE=1 "$source_dir/package.sh" "$work/another/second" > "$work/second.log" 2>&1 ||
  { tail -30 "$work/second.log"; exit 1; }
for package in "$work"/first/*.deb; do
  cmp "$package" "$work/another/second/$(basename "$package")"
done
[ "$(ls "$work"/first/*.deb | wc -l)" -eq 4 ]

echo "== every compiler and linker run has the distribution's flags, and no library is linked for nothing"
blhc --all --debian --ignore-flag=-g "$work/first.log"
# BLAS is what LAPACK itself needs, and ld keeps it; it is in libatlas3-base, on which libceres3 depends anyway.
if grep 'could avoid a useless dependency' "$work/first.log" | grep -v libf77blas; then exit 1; fi

echo "== no path of the source or of the build"
"$here/no_paths.sh" "$work/first" "$source_dir" "$work"

echo "== licences of all that the packages depend on"
"$here/licences.sh" "$work/first" "$source_dir/doc/licences.md"

"$here/in_debian.sh" "$work/first" "$source_dir/tests/consumer/project" "${SUITE:-bookworm}" "$work/tree"
