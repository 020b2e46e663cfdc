#!/bin/sh
# Builds and runs all host tests: GCC optimised, Clang optimised, and GCC with the address and undefined-behaviour
# sanitizers. Tests that need real data read it from the folder in PLIANT_DATA and say so when they skip.
# usage: sh tests/run.sh
set -eu
cd "$(dirname "$0")/.."
sh toolchains/packages.sh g++ clang cmake ninja-build pkg-config libeigen3-dev doctest-dev libstb-dev
for preset in release clang sanitize; do
  echo "== $preset"
  cmake --preset "$preset" >/dev/null
  cmake --build --preset "$preset" -- --quiet
  ctest --preset "$preset" -j "$(nproc)"
done
