#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Run in an empty Debian that has headway's source package in /source: its Build-Depends, and nothing else, bring all
# that the packages are built with.
set -euo pipefail
apt() { apt-get -qq -o Dpkg::Use-Pty=0 "$@" > /source/apt.log 2>&1 || { tail -20 /source/apt.log; exit 1; }; }

echo "== build dependencies"
apt update
apt autoremove -y --purge
apt install -y --no-install-recommends build-essential
apt build-dep -y --no-install-recommends /source
cd /source
dpkg-checkbuilddeps
debian/rules override_dh_auto_configure > configure.log 2>&1 || { tail -30 configure.log; exit 1; }
if grep 'was not found' configure.log; then
  echo "the build leaves out parts" >&2
  exit 1
fi
