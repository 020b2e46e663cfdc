#!/bin/sh
# Builds and runs all host tests: GCC optimised, Clang optimised, and GCC with the address and undefined-behaviour
# sanitizers. With --targets also the portable libraries and their tests on AArch64, ARMv7 and RISC-V under qemu-user, and
# the programs of platform/cortex-m on an emulated Cortex-M7, and a camera in a virtual machine. Tests that need real data read it from the folder in
# PLIANT_DATA and say so when they skip. usage: sh tests/run.sh [--targets]
set -eu
cd "$(dirname "$0")/.."
sh toolchains/packages.sh g++ clang cmake ninja-build pkg-config libeigen3-dev doctest-dev libstb-dev libcamera-dev

# run_tests PRESET [option of cmake]...
run_tests() {
  echo "== $1"
  cmake --preset "$@" >/dev/null
  cmake --build --preset "$1" -- --quiet
  ctest --preset "$1" -j "$(nproc)"
}

for preset in release clang sanitize; do run_tests "$preset"; done
if [ "${1:-}" = "--targets" ]; then
  sh toolchains/packages.sh g++-aarch64-linux-gnu g++-arm-linux-gnueabihf g++-riscv64-linux-gnu qemu-user-static \
    gcc-arm-none-eabi libnewlib-arm-none-eabi libstdc++-arm-none-eabi-newlib qemu-system-arm
  for preset in aarch64 armhf riscv64 cortex-m7; do run_tests "$preset" "-DPLIANT_HOST_BUILD=$PWD/build/release"; done
  echo "== a camera"
  if [ "$(uname -m)" = x86_64 ]; then sh toolchains/packages.sh qemu-system-x86 busybox-static cpio kmod python3; fi
  sh tests/target/camera_vm.sh build/release/pliant build/camera-vm
fi
