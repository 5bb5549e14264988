#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Checks that the first line of every source file, or the second after #! or <!doctype>, names its licence.
# Usage: licence_headers.sh SOURCE_DIR
set -euo pipefail
cd "$1"
missing=$(
  find . \( -path ./build -o -path ./out -o -path ./.git -o -path ./tests/fuzz/corpus -o -name node_modules \) -prune -o \
    -type f \( -name '*.cpp' -o -name '*.h' -o -name '*.in' -o -name '*.py' -o -name '*.pyi' -o -name '*.sh' \
    -o -name '*.cmake' -o -name CMakeLists.txt -o -name '*.js' -o -name '*.mjs' -o -name '*.css' -o -name '*.html' \
    -o -name '*.dict' -o -name '*.proto' -o -name Snakefile -o -name Doxyfile -o -path './.ci/*' \
    -o -path './config/*/*.ini' -o -path './workflow/*.yaml' \) -exec awk '
      FNR == 1 && /^#!|^<!doctype/ { next }
      FNR <= 2 && /SPDX-License-Identifier: BSD-3-Clause/ { found[FILENAME] = 1 }
      { seen[FILENAME] = 1; nextfile }
      END { for (file in seen) if (!(file in found)) print file }' {} +
)
[ -z "$missing" ] || { echo "without SPDX-License-Identifier: BSD-3-Clause as their first line:"; echo "$missing"; exit 1; }
