#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs what is missing, builds, and runs every test. Tests on real data run where HEADWAY_DATA
# names its folder. Arguments go to ctest: ./test.sh -L unit, ./test.sh -LE slow. ./test.sh -L nightly, as root,
# installs more and runs what takes long: shared libraries, Debian packages, a Debian 13, fleets by Snakemake and Slurm.
set -euo pipefail
cd "$(dirname "$0")"
source libs/cmake/setup.sh
lists=(packages.txt)
nightly=OFF
if [[ " $* " == *" -L nightly "* ]]; then
  nightly=ON
  lists+=(packaging/packages.txt workflow/packages.txt tests/workflow/packages.txt tests/sanitizers/packages.txt)
fi
install_packages "${lists[@]}"
cmake --preset release -DHEADWAY_NIGHTLY_TESTS=$nightly >/dev/null
build_preset release
ctest --preset release "$@"
