#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# All recordings of a folder or list to one page and one CSV: ./fleet.sh FOLDER -j2. Installs what is
# missing, builds, and runs workflow/headway-fleet, whose --help lists the options.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
(
  cd "$here"
  source libs/cmake/setup.sh
  install_packages packages.txt workflow/packages.txt
  build_preset release headway-import headway-replay headway-eval headway-render
) >&2
exec "$here/workflow/headway-fleet" --programs "$here/build/release/bin" "$@"
