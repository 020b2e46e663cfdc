#!/bin/sh
# Builds and runs all host tests: GCC optimised, Clang optimised, and GCC with the address and undefined-behaviour
# sanitizers. With --targets also the portable libraries and their tests on AArch64, ARMv7 and RISC-V under qemu-user, and
# the libraries for a bare Cortex-M7. Tests that need real data read it from the folder in PLIANT_DATA and say so when
# they skip. usage: sh tests/run.sh [--targets]
set -eu
cd "$(dirname "$0")/.."
sh toolchains/packages.sh g++ clang cmake ninja-build pkg-config libeigen3-dev doctest-dev libstb-dev

run_tests() {
  echo "== $1"
  cmake --preset "$1" >/dev/null
  cmake --build --preset "$1" -- --quiet
  ctest --preset "$1" -j "$(nproc)"
}

for preset in release clang sanitize; do run_tests "$preset"; done
if [ "${1:-}" = "--targets" ]; then
  sh toolchains/packages.sh g++-aarch64-linux-gnu g++-arm-linux-gnueabihf g++-riscv64-linux-gnu qemu-user-static \
    gcc-arm-none-eabi libnewlib-arm-none-eabi libstdc++-arm-none-eabi-newlib
  for preset in aarch64 armhf riscv64; do run_tests "$preset"; done
  echo "== cortex-m7"
  cmake --preset cortex-m7 >/dev/null
  cmake --build --preset cortex-m7 -- --quiet
  cmake -DNM=arm-none-eabi-nm \
    "-DLIBRARIES=build/cortex-m7/src/libpliant_core.a;build/cortex-m7/platform/libpliant_platform.a" -P tests/symbols.cmake
fi
