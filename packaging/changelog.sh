#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Prints debian/changelog: the version of libs/perception/core/include/headway/core/version.h, the date of the newest
# released section of CHANGELOG.md.
set -euo pipefail
cd "$(dirname "$0")/.."
version=$(sed -n 's/.*kVersion = "\([0-9.]*\)".*/\1/p' libs/perception/core/include/headway/core/version.h)
day=$(sed -n 's/^## \[[0-9.]*\] - \([0-9-]*\)$/\1/p' CHANGELOG.md | head -1)
maintainer=$(sed -n 's/^Maintainer: //p' packaging/debian/control)
: "${version:?no version in version.h}"
cat <<END
headway ($version) unstable; urgency=medium

  * Release $version: see /usr/share/doc/headway/CHANGELOG.md.

 -- $maintainer  $(LC_ALL=C date --utc --date "${day:-1970-01-01}" --rfc-email)
END
