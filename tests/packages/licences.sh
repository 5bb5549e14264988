#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Fails if a package that those of FOLDER depend on is not in DOCUMENT, between back-quotes, where * stands for
# anything, or if a package of FOLDER does not contain DOCUMENT. Usage: licences.sh FOLDER DOCUMENT
set -euo pipefail
needed=$(for package in "$1"/*.deb; do dpkg-deb --field "$package" Depends; done |
  sed 's/([^)]*)//g; s/:any//g' | tr ',|' '\n\n' | tr -d ' ' | grep -vE '^$|headway|\.so\.[0-9]+$' | sort -u)
[ -n "$needed" ] || { echo "the packages of $1 depend on nothing" >&2; exit 1; }
listed=$(grep -o '`[^` ]*`' "$2" | tr -d '`')
status=0
for package in "$1"/*.deb; do
  dpkg-deb --fsys-tarfile "$package" | tar -xO --wildcards '*/licences.md' 2>/dev/null | cmp --quiet - "$2" && continue
  echo "$package does not contain $2" >&2
  status=1
done
for name in $needed; do
  while read -r pattern; do
    # shellcheck disable=SC2053  # a pattern
    [[ $name == $pattern ]] && continue 2
  done <<< "$listed"
  echo "$2 does not list the licence of $name" >&2
  status=1
done
exit $status
