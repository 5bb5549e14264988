#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# All unit and regression tests, the slow ones too, as another preset builds them: `asan` under the address and
# undefined-behaviour sanitizers, `clang` optimised by Clang.
# Usage: programs.sh PRESET SOURCE_DIR [ARGUMENT_OF_CTEST ...]
set -euo pipefail
preset=$1
cd "$2"
shift 2
[ $# -gt 0 ] || set -- -L 'unit|regression' -E 'readme$'
source libs/cmake/setup.sh
build_preset "$preset" unit_tests test_regression test_live_program test_pipeline_regression test_slam_regression
ctest --preset "$preset" --no-tests=error "$@"
