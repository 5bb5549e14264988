#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# The tests of what runs in several threads, under the thread sanitizer.
# Usage: threads.sh SOURCE_DIR [ARGUMENT_OF_CTEST ...]
set -euo pipefail
cd "$1"
shift
suites='Worker|Stop|ObservationQueue|LiveSource|Clock|FrameContext|SharedMap|DenseMap'
suites+='|BundleAdjuster|DetachedBundle|LoopSearch|LoopCloser|FrameFeed|LiveRunner'
[ $# -gt 0 ] || set -- -R "\.($suites)[A-Za-z]*\$" -LE slow
source libs/cmake/setup.sh
build_preset tsan test_core test_io test_stereo test_map test_slam test_pipeline
ctest --preset tsan --no-tests=error "$@"
