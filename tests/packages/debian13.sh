#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds headway and runs its tests in a Debian 13, whose MRPT is of another version than Debian 12's. As root.
# Usage: debian13.sh SOURCE_DIR WORK_DIR [ARGUMENT_OF_CTEST ...], by default without the nightly tests.
# The tree is made once; with it in place only what has changed is compiled again.
set -euo pipefail
source_dir=$(cd "$1" && pwd)
work=$2
shift 2
here=$(cd "$(dirname "$0")" && pwd)
source "$here/tree.sh"
[ "$(id -u)" -eq 0 ] || { echo "making a Debian of its own takes root" >&2; exit 1; }
mkdir -p "$work"
tree=$(cd "$work" && pwd)/trixie
make_tree trixie "$tree"

# The sources anew, what was built from them as it is.
mkdir -p "$tree/headway"
find "$tree/headway" -mindepth 1 -maxdepth 1 ! -name build -exec rm -r {} +
tar -C "$source_dir" --exclude=./build --exclude=./out --exclude=./.git -cf - . | tar -C "$tree/headway" -xf -

DATA=${HEADWAY_DATA:-}
export DATA
[ $# -gt 0 ] || set -- -LE nightly
in_tree "$tree" ${DATA:+HEADWAY_DATA=/data} bash -c 'cd /headway && ./test.sh "$@"' _ "$@"
