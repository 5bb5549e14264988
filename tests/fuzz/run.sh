#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs each libFuzzer target for some minutes from its seed corpus. Inputs that crash, take over
# 10 s or more than 512 MB are written to build/fuzz/found and end the script with status 1.
#
#     tests/fuzz/run.sh MINUTES [SEED]
#
# With a SEED each run begins with the same inputs; without one it tries others each time.
# Dictionaries of the targets are in tests/fuzz/dictionaries. Seeds of rawlogs are written by the
# tests: HEADWAY_FUZZ_SEEDS=tests/fuzz/corpus/rawlog_stream test_io; those of bags by bag_seeds.py.
set -eu
cd "$(dirname "$0")/../.."
seconds=$(awk "BEGIN { print int(60 * ${1:?minutes}) }")
seed=${2:-0}
cmake --preset asan > /dev/null
cmake --build --preset asan --target fuzzers
export ASAN_OPTIONS=intercept_tls_get_addr=0  # see .ci/run
mkdir -p build/fuzz/found

# fuzz NAME: what it prints is in build/fuzz/NAME.log, and here if it fails.
fuzz() {
  local name=$1 dictionary=tests/fuzz/dictionaries/$1.dict memory=512
  local options=(-seed="$seed" -max_total_time="$seconds" -max_len=24000 -timeout=10 -malloc_limit_mb=512)
  [ ! -f "$dictionary" ] || options+=("-dict=$dictionary")
  # What libfyaml leaks adds up over 100,000 inputs.
  ! grep -q yaml_leaks "tests/fuzz/${name}_fuzz.cpp" || memory=4096
  mkdir -p "build/fuzz/corpus/$name"
  if "build/asan/tests/fuzz/fuzz_$name" "${options[@]}" -rss_limit_mb="$memory" \
    -print_final_stats=1 -artifact_prefix="build/fuzz/found/$name-" \
    "build/fuzz/corpus/$name" "tests/fuzz/corpus/$name" > "build/fuzz/$name.log" 2>&1; then
    echo "$name: $(awk '/number_of_executed_units/ { print $2 }' "build/fuzz/$name.log") inputs"
  else
    echo "$name: failed"
    tail -50 "build/fuzz/$name.log"
    return 1
  fi
}
export -f fuzz
export seconds seed
ls tests/fuzz/corpus | xargs -P "$(nproc)" -I{} bash -c 'fuzz {}'
