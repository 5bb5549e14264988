#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Writes the manual pages of the programs and of their sub-commands from their --help, by help2man.
# Usage: man_pages.sh FOLDER_OF_PROGRAMS OUTPUT_FOLDER
set -euo pipefail
export LC_ALL=C.UTF-8
programs=$(cd "$1" && pwd)
mkdir -p "$2"
output=$(cd "$2" && pwd)
work=$(mktemp -d)
trap 'rm -r "$work"' EXIT
cd "$programs"
export PATH=$programs:$PATH

# page PROGRAM [SUBCOMMAND]: the first line of --help after the usage is the name's description.
page() {
  local name=${*// /-} about see
  name=${1}${2:+-$2}
  about=$("$@" --help | awk 'BEGIN { RS = "" } NR == 2 { gsub("\n", " "); sub(/\.( .*)?$/, ""); print }')
  {
    echo "[see also]"
    see=$([ $# -gt 1 ] && echo "\\fB$1\\fP(1), " || true)
    for command in $(commands "$1"); do
      [ "$1-$command" = "$name" ] || [ $# -gt 1 ] || see+="\\fB$1-$command\\fP(1), "
    done
    echo "${see}the documents in /usr/share/doc/headway, \\fB/usr/share/headway/config/headway.ini\\fP"
  } > "$work/include"
  help2man --no-info --section 1 --source headway --manual "headway" --name "${about,}" \
    --include "$work/include" --output "$output/$name.1" "$*"
}

# commands PROGRAM: its sub-commands.
commands() {
  "$1" --help | awk '/^Sub-commands:/ { inside = 1; next } /^[^ ]/ { inside = 0 } inside && /^  [a-z]/ { print $1 }'
}

for program in headway-*; do
  page "$program"
  for command in $(commands "$program"); do
    page "$program" "$command"
  done
done
