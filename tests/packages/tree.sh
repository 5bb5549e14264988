# SPDX-License-Identifier: BSD-3-Clause
# Sourced by scripts that work in a Debian of its own, a folder. As root.

# make_tree SUITE TREE: TREE is a minimal Debian SUITE; made once. It reaches the network and starts no services.
make_tree() {
  local suite=$1 tree=$2
  if [ ! -e "$tree/etc/debian_version" ] || [ ! -e "$tree.made" ]; then
    echo "== an empty Debian $suite"
    rm -rf "$tree" "$tree.made"
    debootstrap --variant=minbase "$suite" "$tree" > "$tree.log" 2>&1 || { tail "$tree.log"; return 1; }
    touch "$tree.made"
  fi
  cp /etc/resolv.conf "$tree/etc/resolv.conf"
  printf '#!/bin/sh\nexit 101\n' > "$tree/usr/sbin/policy-rc.d"
  chmod +x "$tree/usr/sbin/policy-rc.d"
}

# in_tree TREE [NAME=VALUE ...] COMMAND ...: runs COMMAND in TREE, in a mount namespace of its own, so that nothing
# stays mounted. DATA: a folder that is /data there, to be read only.
in_tree() {
  unshare --mount bash -euc '
    tree=$1
    shift
    mount --rbind /dev "$tree/dev"
    mount -t proc proc "$tree/proc"
    if [ -n "${DATA:-}" ]; then
      mkdir -p "$tree/data"
      mount --bind -o ro "$DATA" "$tree/data"
    fi
    exec chroot "$tree" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 \
      DEBIAN_FRONTEND=noninteractive "$@"' in_tree "$@"
}
