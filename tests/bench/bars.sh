# SPDX-License-Identifier: BSD-3-Clause
# Sourced by scripts that measure and end with the bars that are missed: they define measure(), which prints what was
# measured, and missed FILE, which prints the bars that a file of such lines misses, one a line.

# begin DEFAULT_OUT [--check] [OUT]: sets and makes the folder $out; with --check nothing will be measured
begin() {
  only_check=false
  out=$1
  shift
  if [ "${1:-}" = --check ]; then
    only_check=true
    shift
  fi
  out=${1:-$out}
  mkdir -p "$out"
}

# Measures into $out/measured.txt, and fails if a bar is missed.
end() {
  if ! $only_check; then measure | tee "$out/measured.txt"; fi
  local bars
  bars=$(missed "$out/measured.txt")
  if [ -n "$bars" ]; then
    printf '== missed\n%s\n' "$bars"
    return 1
  fi
  echo "== all bars are reached"
}
