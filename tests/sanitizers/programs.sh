#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# All tests of units and programs, the slow and the nightly ones too, as another preset builds them: `asan` under the
# address and undefined-behaviour sanitizers, `clang` optimised by Clang. Left out: the README's commands, which build
# headway anew; under sanitizers Python, which trips them by itself, headway-live beside a robot of ROS 2, for which they
# are too slow, and what a test says that it skips.
# Usage: programs.sh PRESET SOURCE_DIR [ARGUMENT_OF_CTEST ...]
set -euo pipefail
preset=$1
cd "$2"
shift 2
labels='unit|regression|program'
[ "$preset" != clang ] || labels+='|python|workflow'
[ $# -gt 0 ] || set -- -L "$labels" -E 'readme$'
source libs/cmake/setup.sh
cmake --preset "$preset" -DHEADWAY_NIGHTLY_TESTS=ON >/dev/null
build_preset "$preset"
ctest --preset "$preset" --no-tests=error "$@"
