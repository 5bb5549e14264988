#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# All unit and regression tests, the slow ones too, under the address and undefined-behaviour sanitizers.
# Usage: programs.sh SOURCE_DIR [ARGUMENT_OF_CTEST ...]
set -euo pipefail
cd "$1"
shift
[ $# -gt 0 ] || set -- -L 'unit|regression' -E 'readme$'
source libs/cmake/setup.sh
build_preset asan unit_tests test_regression test_live_program test_pipeline_regression test_slam_regression
ctest --preset asan --no-tests=error "$@"
