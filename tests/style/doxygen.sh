#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Writes doxygen's pages of the public headers and fails at any warning, at a header without a page, and at a
# class without a description. Usage: doxygen.sh SOURCE_DIR OUTPUT_DIR
set -euo pipefail
cd "$1"
rm -rf "$2"
mkdir -p "$2"
{ cat doc/Doxyfile; echo "OUTPUT_DIRECTORY = $2"; } | doxygen -

for header in libs/*/*/include/headway/*/*.h; do
  page=$(basename "$header" .h | sed 's/_/__/g')_8h.html
  [ -n "$(find "$2/html" -name "*$page" -print -quit)" ] || { echo "$header has no page" >&2; exit 1; }
done

undescribed=$({ cat doc/Doxyfile; echo "OUTPUT_DIRECTORY = $2
EXTRACT_ALL = NO
GENERATE_HTML = NO
GENERATE_XML = NO
WARN_AS_ERROR = NO"; } | doxygen - 2>&1 | grep 'Compound .* is not documented' || true)
[ -z "$undescribed" ] || { echo "$undescribed" >&2; exit 1; }
