# SPDX-License-Identifier: BSD-3-Clause
# Sourced by demo.sh, test.sh, fleet.sh and package.sh: installs what packages.txt lists and builds a preset.

# install_packages [list ...]: installs the packages that are missing (default: packages.txt); asks
# for root only then.
install_packages() {
  local wanted missing=()
  wanted=$(sed 's/#.*//' "${@:-packages.txt}")
  for package in $wanted; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q '^install ok installed$' ||
      missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return 0
  local as_root=""
  if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
      echo "$0: these packages are missing and there is no sudo; install them as root: ${missing[*]}" >&2
      return 1
    fi
    as_root="sudo"
  fi
  echo "installing: ${missing[*]}"
  export DEBIAN_FRONTEND=noninteractive
  $as_root apt-get -qq update
  $as_root apt-get -qq install -y --no-install-recommends "${missing[@]}" >/dev/null
}

# build_preset <preset> [targets ...]: configures once and builds what changed (default: all).
build_preset() {
  local preset=$1
  shift
  cmake --preset "$preset" >/dev/null
  cmake --build --preset "$preset" --parallel "$(nproc)" ${1:+--target "$@"}
}
