#!/bin/bash
# Installs what is missing, builds, and runs every test. Tests on real data run where HEADWAY_DATA
# names its folder. Arguments go to ctest: ./test.sh -L unit, ./test.sh -LE slow
set -euo pipefail
cd "$(dirname "$0")"
source libs/cmake/setup.sh
install_packages
build_preset release
ctest --preset release "$@"
