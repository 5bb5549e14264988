#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Programs are hardened: position-independent, with read-only tables of addresses, and with checks
# of the stack and of buffers. hardening.sh PROGRAM ...
set -euo pipefail
export LC_ALL=C
status=0
fail() {
  echo "$1: $2" >&2
  status=1
}
for program in "$@"; do
  # In whole first: grep -q ends before readelf has written everything, which would then fail.
  all=$(readelf -hldW "$program")
  grep -q 'Type: *DYN' <<<"$all" || fail "$program" "is not position-independent"
  grep -q GNU_RELRO <<<"$all" || fail "$program" "has no read-only relocations"
  grep -q 'BIND_NOW\|Flags:.* NOW' <<<"$all" || fail "$program" "binds lazily"
  names=$(readelf --dyn-syms -W "$program")
  grep -q __stack_chk_fail <<<"$names" || fail "$program" "does not check its stack"
  grep -q '_chk@' <<<"$names" || fail "$program" "does not check its buffers"
done
exit $status
