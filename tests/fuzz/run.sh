#!/bin/bash
# Runs each libFuzzer target for some minutes from its seed corpus. Inputs that crash, take over
# 10 s or more than 512 MB are written to build/fuzz/found and end the script with status 1.
#
#     tests/fuzz/run.sh MINUTES
#
# Dictionaries of the targets are in tests/fuzz/dictionaries. Seeds of rawlogs are written by the
# tests: HEADWAY_FUZZ_SEEDS=tests/fuzz/corpus/rawlog_stream test_io; those of bags by bag_seeds.py.
set -eu
cd "$(dirname "$0")/../.."
seconds=$(awk "BEGIN { print int(60 * ${1:?minutes}) }")
cmake --preset fuzz > /dev/null
cmake --build --preset fuzz
mkdir -p build/fuzz/found
status=0
for seeds in tests/fuzz/corpus/*; do
  name=$(basename "$seeds")
  mkdir -p "build/fuzz/corpus/$name"
  options=(-max_total_time="$seconds" -max_len=24000 -timeout=10 -malloc_limit_mb=512)
  dictionary=tests/fuzz/dictionaries/$name.dict
  [ ! -f "$dictionary" ] || options+=("-dict=$dictionary")
  # What libfyaml leaks adds up over 100,000 inputs.
  grep -q yaml_leaks "tests/fuzz/${name}_fuzz.cpp" && memory=4096 || memory=512
  "$(find build/fuzz -name "fuzz_$name" -type f)" "${options[@]}" -rss_limit_mb="$memory" \
    -print_final_stats=1 -artifact_prefix="build/fuzz/found/$name-" \
    "build/fuzz/corpus/$name" "$seeds" || status=1
done
exit $status
