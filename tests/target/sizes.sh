#!/bin/sh
# Prints, as a table, what the tracker takes on each target that has been built (sh tests/run.sh --targets, or one preset):
# code and constants of core, vision and track in the linked example, by the linker's map; static memory and arena of each
# profile with the built-in face, by the example itself; and the deepest stack of a frame, by the compiler's call graph.
# usage: sh tests/target/sizes.sh [BUILD_FOLDER...]
set -eu
cd "$(dirname "$0")/../.."
[ $# -gt 0 ] || set -- build/release build/aarch64 build/armhf build/riscv64 build/cortex-m7
here=tests/target
echo "| target | code | constants | tracker object | arena S | arena L | stack | largest frame |"
echo "|---|---:|---:|---:|---:|---:|---:|---:|"
for build in "$@"; do
  [ -f "$build/tests/target/firmware.map" ] || continue
  code=$(awk -f $here/map.awk "$build/tests/target/firmware.map")
  sizes=$(sed -n 's/^sizes: object \([0-9]*\), arena S \([0-9]*\), arena L \([0-9]*\)$/\1 | \2 | \3/p' \
    "$build/tests/target/firmware.txt")
  graph=$(find "$build/src" "$build/platform" -name '*.ci' -path '*/pliant_*.dir/*' ! -path '*/pliant_host.dir/*')
  # shellcheck disable=SC2086
  stack=$(awk -v limit=1024 -v roots="Tracker5start Tracker6update" -f $here/stack.awk $graph || true)
  deepest=$(echo "$stack" | awk '/^stack / && $NF > most { most = $NF } END { print most + 0 }')
  largest=$(echo "$stack" | sed -n 's/.*largest frame \([0-9]*\).*/\1/p')
  echo "| $(basename "$build") | ${code% *} | ${code#* } | $sizes | $deepest | $largest |"
done
