#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs libFuzzer targets, all unless some are named, for some minutes each. Inputs that crash, take
# over 10 s or more than 512 MB are written to build/fuzz/found and end the script with status 1.
#
#     tests/fuzz/run.sh MINUTES [SEED [TARGET ...]]
#
# With a SEED other than 0 each run begins with the same inputs; otherwise it tries others each time.
# Inputs that reach something new are kept in build/fuzz/corpus, where the next run continues; how
# many each run has tried is added to build/fuzz/inputs.txt.
#
# Dictionaries of the targets are in tests/fuzz/dictionaries. Seeds of rawlogs are written by the
# tests: HEADWAY_FUZZ_SEEDS=tests/fuzz/corpus/rawlog_stream test_io; those of bags by bag_seeds.py.
set -eu
cd "$(dirname "$0")/../.."
seconds=$(awk "BEGIN { print int(60 * ${1:?minutes}) }")
seed=${2:-0}
shift "$(($# < 2 ? $# : 2))"
[ $# -gt 0 ] || set -- $(ls tests/fuzz/corpus)
cmake --preset fuzz > /dev/null
cmake --build --preset fuzz
# intercept_tls_get_addr: see .ci/run. The memory that counts is what the code holds: AddressSanitizer
# keeps up to 16 MB of what was freed, not 256, and returns the rest to the system within 2 s.
export ASAN_OPTIONS=intercept_tls_get_addr=0:quarantine_size_mb=16:allocator_release_to_os_interval_ms=2000
mkdir -p build/fuzz/found

# fuzz NAME: what it prints is in build/fuzz/NAME.log, and here if it fails.
fuzz() {
  local name=$1 dictionary=tests/fuzz/dictionaries/$1.dict inputs
  local options=(-seed="$seed" -max_total_time="$seconds" -max_len=24000 -timeout=10
    -rss_limit_mb=512 -malloc_limit_mb=512 -print_final_stats=1
    -artifact_prefix="build/fuzz/found/$name-")
  [ ! -f "$dictionary" ] || options+=("-dict=$dictionary")
  # Their leaks are checked at the end alone.
  ! grep -q yaml_parsers "tests/fuzz/${name}_fuzz.cpp" || options+=(-detect_leaks=0)
  mkdir -p "build/fuzz/corpus/$name"
  if "build/asan/tests/fuzz/fuzz_$name" "${options[@]}" "build/fuzz/corpus/$name" \
    "tests/fuzz/corpus/$name" > "build/fuzz/$name.log" 2>&1; then
    inputs=$(awk '/number_of_executed_units/ { print $2 }' "build/fuzz/$name.log")
    echo "$name: $inputs inputs, $(awk '/peak_rss_mb/ { print $2 }' "build/fuzz/$name.log") MB"
    echo "$name $inputs" >> build/fuzz/inputs.txt
  else
    echo "$name: failed"
    tail -50 "build/fuzz/$name.log"
    return 1
  fi
}
export -f fuzz
export seconds seed
printf '%s\n' "$@" | xargs -P "$(nproc)" -I{} bash -c 'fuzz {}'
