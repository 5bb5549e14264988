#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs the packages of FOLDER in an empty Debian, uses them as their users do, and removes them. As root.
# Usage: in_debian.sh FOLDER CONSUMER_PROJECT SUITE TREE
set -euo pipefail
folder=$1
project=$2
suite=$3
tree=$4

if [ ! -e "$tree/etc/debian_version" ]; then
  echo "== an empty Debian $suite"
  rm -rf "$tree"
  debootstrap --variant=minbase "$suite" "$tree" > "$tree.log" 2>&1 || { tail "$tree.log"; exit 1; }
fi
cp /etc/resolv.conf "$tree/etc/resolv.conf"
printf '#!/bin/sh\nexit 101\n' > "$tree/usr/sbin/policy-rc.d"  # start no services
chmod +x "$tree/usr/sbin/policy-rc.d"
rm -rf "$tree/packages" "$tree/project" "$tree/home/user"
mkdir -p "$tree/packages"
cp "$folder"/*.deb "$tree/packages"
cp -r "$project" "$tree/project"
cp "$(dirname "$0")/use.sh" "$tree/packages/use.sh"

# A mount namespace of its own, so that nothing stays mounted.
unshare --mount bash -c '
  mount --rbind /dev "$0/dev" && mount -t proc proc "$0/proc" &&
  exec chroot "$0" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive \
    bash /packages/use.sh' "$tree"
