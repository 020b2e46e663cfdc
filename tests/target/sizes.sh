#!/bin/sh
# Prints, as a table, what the tracker takes on each target that has been built (sh tests/run.sh --targets, or one preset),
# in profile S and profile L: code and constants of core, vision and track in a linked program, by the linker's map; the
# tracker's object and its arena with the built-in face, by the programs themselves; the deepest stack of a frame and the
# largest frame on it, by the compiler's call graph; and the instructions of a frame where they can be counted. The
# libraries have no variables of their own.
# usage: sh tests/target/sizes.sh [BUILD_FOLDER...]
set -eu
cd "$(dirname "$0")/../.."
[ $# -gt 0 ] || set -- build/release build/aarch64 build/armhf build/riscv64 build/cortex-m7
here=tests/target
echo "| target | code S | code L | constants | object | arena S | arena L | deepest stack | largest frame |"
echo "|---|---:|---:|---:|---:|---:|---:|---:|---:|"
instructions=""
for build in "$@"; do
  made=$build/$here
  [ -f "$made/firmware.txt" ] && [ -f "$made/bad_input.txt" ] || continue
  small=$(awk -f $here/map.awk "$made/firmware.map"); large=$(awk -f $here/map.awk "$made/bad_input.map")
  sizes=$(sed -n 's/^sizes: object \([0-9]*\), arena \([0-9]*\)$/\1 | \2/p' "$made/firmware.txt")
  arena=$(sed -n 's/^sizes: arena \([0-9]*\)$/\1/p' "$made/bad_input.txt")
  graph=$(find "$build/src" "$build/platform" -name '*.ci' -path '*/pliant_*.dir/*' ! -path '*/pliant_host.dir/*')
  # shellcheck disable=SC2086
  stack=$(awk -v limit=1024 -v roots="Tracker5start Tracker6update" -f $here/stack.awk $graph || true)
  deepest=$(echo "$stack" | awk '/^stack / && $NF > most { most = $NF } END { print most + 0 }')
  largest=$(echo "$stack" | sed -n 's/.*largest frame \([0-9]*\).*/\1/p')
  echo "| $(basename "$build") | ${small% *} | ${large% *} | ${large#* } | $sizes | $arena | $deepest | $largest |"
  instructions="$instructions$(sed -n "s/^thousand instructions a frame: /$(basename "$build"): thousand instructions a frame of profile S: /p" "$made/firmware.txt")"
done
echo "$instructions"
