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
  readelf -hW "$program" | grep -q 'Type: *DYN' || fail "$program" "is not position-independent"
  readelf -lW "$program" | grep -q GNU_RELRO || fail "$program" "has no read-only relocations"
  readelf -dW "$program" | grep -q 'BIND_NOW\|Flags:.* NOW' || fail "$program" "binds lazily"
  names=$(readelf --dyn-syms -W "$program")
  grep -q __stack_chk_fail <<<"$names" || fail "$program" "does not check its stack"
  grep -q '_chk@' <<<"$names" || fail "$program" "does not check its buffers"
done
exit $status
