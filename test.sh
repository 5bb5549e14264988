#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs what is missing, builds, and runs every test. Tests on real data run where HEADWAY_DATA
# names its folder. Arguments go to ctest: ./test.sh -L unit, ./test.sh -LE slow. ./test.sh -L nightly
# runs the tests that build headway anew: shared libraries, Debian packages (as root).
set -euo pipefail
cd "$(dirname "$0")"
source libs/cmake/setup.sh
install_packages
[[ " $* " == *" nightly "* ]] && nightly=ON || nightly=OFF
cmake --preset release -DHEADWAY_NIGHTLY_TESTS=$nightly >/dev/null
build_preset release
ctest --preset release "$@"
