#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Checks sizes: sources of at most 800 lines besides the licence's, functions of at most 60, documents of at
# most 120 columns.
# Relies on clang-format: a function starts with a line that ends in '{' and ends with '}' at the same
# indentation. Usage: sizes.sh SOURCE_DIR
set -u
export LC_ALL=C.UTF-8
cd "$1" || exit 1
failures=$(
  find libs apps -name '*.cpp' -exec awk '
    function judge() { if (lines > 800) print name ": " lines " lines" }
    FNR == 1 { judge(); name = FILENAME; lines = 0 }
    !/SPDX-License-Identifier/ { ++lines }
    END { judge() }' {} +
  find libs apps \( -name '*.cpp' -o -name '*.h' \) -exec awk '
    FNR == 1 { start = 0; first = 0 }
    # A definition at namespace scope or directly in a class; control flow is indented deeper.
    /^( ? ?)[A-Za-z~:\[<].*[^;]$/ && !/^ *(namespace|class|struct|enum|union|extern|public|private|using|template|#|if|for|while|switch|else|do|return|case)/ && !start {
      match($0, /^ */); candidate = RLENGTH; first = FNR }
    /\{$/ && !start && first && FNR - first < 12 && !/^ *(namespace|class|struct|enum|union|extern)/ && !/= *\{+$/ {
      start = first; indent = candidate }
    start && /^ *\}/ { match($0, /^ */); if (RLENGTH == indent) {
      if (FNR - start + 1 > 60) print FILENAME ":" start ": function of " FNR - start + 1 " lines"
      start = 0; first = 0 } }' {} +
  for document in doc/*.md doc/lab/*.md README.md CHANGELOG.md rawlogs/README.md config/worlds/README.md; do
    grep -nE '.{121,}' "$document" | cut -d: -f1 | sed "s|^|$document:|; s|\$|: more than 120 characters|"
  done
)
[ -z "$failures" ] || { echo "$failures"; exit 1; }
