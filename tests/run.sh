#!/bin/sh
# Builds and runs all host tests: GCC optimised, Clang optimised, and GCC with the address and undefined-behaviour
# sanitizers. With --targets also the portable libraries and their tests on AArch64, ARMv7 and RISC-V under qemu-user, the
# programs of platform/cortex-m on an emulated Cortex-M7, two builds compared byte by byte, builds without each optional
# part, and a camera in a virtual machine; a target whose compiler or emulator cannot be had is skipped and named at the end,
# and so is one that would begin later than PLIANT_MINUTES after the start, where that is set.
# Tests that need real data read it from the folder in PLIANT_DATA and say so when they skip.
# usage: sh tests/run.sh [--targets]
set -eu
cd "$(dirname "$0")/.."
sh toolchains/packages.sh g++ clang cmake ninja-build pkg-config libeigen3-dev doctest-dev libstb-dev libcamera-dev

begin=$(date +%s)
# timed NAME COMMAND...: runs it under a heading, with the time that it took.
timed() {
  echo "== $1"
  from=$(date +%s); name=$1; shift
  "$@"
  now=$(date +%s)
  echo "== $name: $((now - from)) s, $((now - begin)) s in all"
}

# run_tests PRESET [option of cmake]...
run_tests() {
  cmake --preset "$@" >/dev/null
  cmake --build --preset "$1" -- --quiet
  ctest --preset "$1" -j "$(nproc)"
}

# obtain COMMAND... -- PACKAGE...: true when the commands are there, after the packages were asked for if need be.
obtain() {
  commands=""
  while [ "$1" != -- ]; do commands="$commands $1"; shift; done
  shift
  sh toolchains/packages.sh "$@" || true
  missing=""
  for command in $commands; do command -v "$command" >/dev/null 2>&1 || missing="$missing $command"; done
  [ -z "$missing" ] || { echo "there is no$missing"; return 1; }
}

skipped=""
# in_time NAME: whether there is time left to begin it.
in_time() {
  [ $(($(date +%s) - begin)) -lt $((${PLIANT_MINUTES:-1000} * 60)) ] || { skipped="$skipped $1"; return 1; }
}
# target PRESET COMMAND... -- PACKAGE...: the tests of a target, where its tools can be had.
target() {
  preset=$1; shift
  in_time "$preset" || return 0
  if obtain "$@"; then
    timed "$preset" run_tests "$preset" "-DPLIANT_HOST_BUILD=$PWD/build/release"
  else
    skipped="$skipped $preset"
  fi
}

for preset in release clang sanitize; do timed "$preset" run_tests "$preset"; done
[ "${1:-}" = "--targets" ] || exit 0
target cortex-m7 arm-none-eabi-g++ qemu-system-arm -- gcc-arm-none-eabi libnewlib-arm-none-eabi \
  libstdc++-arm-none-eabi-newlib qemu-system-arm
if in_time twice; then timed "the same bytes twice" sh tests/target/twice.sh build/twice; fi
target aarch64 aarch64-linux-gnu-g++ qemu-aarch64-static -- g++-aarch64-linux-gnu qemu-user-static
if [ "$(uname -m)" = x86_64 ]; then sh toolchains/packages.sh qemu-system-x86 busybox-static cpio kmod python3 || true; fi
if in_time camera; then timed "a camera" sh tests/target/camera_vm.sh build/release/pliant build/camera-vm; fi
target armhf arm-linux-gnueabihf-g++ qemu-arm-static -- g++-arm-linux-gnueabihf qemu-user-static
if in_time parts; then timed "optional parts" sh tests/target/parts.sh build/parts; fi
target riscv64 riscv64-linux-gnu-g++ qemu-riscv64-static -- g++-riscv64-linux-gnu qemu-user-static
[ -z "$skipped" ] || echo "skipped, for want of tools or time:$skipped"
