#!/bin/sh
# Builds the project and runs its tests. The presets of CMakePresets.json say with which flags.
# usage: sh tests/run.sh [--all | --targets]
#   without an option  the optimised build, by GCC
#   --all              also the optimised build by Clang, and GCC's with the address and undefined-behaviour sanitizers
#   --targets          all of that, the fuzzers for 20 seconds each, and the targets: Cortex-M7 on an emulated board; AArch64,
#                      ARMv7 and RISC-V under qemu-user; Windows under Wine; WebAssembly under Node.js; two builds compared
#                      byte by byte; builds without each optional part; a camera in a virtual machine
# A target is skipped, with a line that says so, when its compiler or emulator cannot be installed, and when it would begin
# more than PLIANT_MINUTES after the start, where that is set. ARMv7 and RISC-V leave out the tests with the label `long`, which
# AArch64 runs: minutes each on an emulated processor.
# Tests of real data read it from the folder in PLIANT_DATA. Without it ctest shows them as skipped.
set -eu
cd "$(dirname "$0")/.."
scope=${1:-}
case $scope in "" | --all | --targets) ;; *) echo "usage: sh tests/run.sh [--all | --targets]" >&2; exit 2 ;; esac

begin=$(date +%s)
seconds() { echo $(($(date +%s) - begin)); }
heading() { echo "== $1, after $(seconds) s"; }
skip() { echo "== $1: skipped, $2"; }

# run_tests PRESET [option of cmake]...: without the tests of which the label is $left_out.
left_out=""
run_tests() {
  heading "$1"
  cmake --preset "$@" >/dev/null
  cmake --build --preset "$1" -- --quiet
  ctest --preset "$1" -j "$(nproc)" ${left_out:+-LE "$left_out"}
}

# obtain COMMAND... -- PACKAGE...: true when the commands are there, if need be after an attempt to install the packages.
obtain() {
  commands=""
  while [ "$1" != -- ]; do commands="$commands $1"; shift; done
  shift
  sh toolchains/packages.sh "$@" || true
  for command in $commands; do command -v "$command" >/dev/null 2>&1 || return 1; done
}

# in_time NAME: whether there is time left to begin it.
in_time() {
  [ "$(seconds)" -lt $((${PLIANT_MINUTES:-1000} * 60)) ] || { skip "$1" "too late"; return 1; }
}

# target PRESET COMMAND... -- PACKAGE...: the tests of a target.
target() {
  preset=$1; shift
  in_time "$preset" || return 0
  if obtain "$@"; then
    run_tests "$preset" "-DPLIANT_HOST_BUILD=$PWD/build/release"
  else
    skip "$preset" "there are no tools for it"
  fi
}

# script NAME COMMAND...: a test that is a script of its own.
script() {
  in_time "$1" || return 0
  heading "$1"
  shift
  sh "$@"
}

sh toolchains/packages.sh g++ cmake ninja-build pkg-config libeigen3-dev doctest-dev libstb-dev \
  libcli11-dev nlohmann-json3-dev libyaml-cpp-dev libcamera-dev
run_tests release
[ -n "$scope" ] || exit 0

sh toolchains/packages.sh clang
run_tests clang
run_tests sanitize
[ "$scope" = --targets ] || exit 0

obtain clang++ -- clang libclang-rt-dev && script "fuzzers" tests/fuzz/run.sh --seed 1 20
script "the same bytes twice" tests/target/twice.sh build/twice
script "optional parts" tests/target/parts.sh build/parts
if [ "$(uname -m)" = x86_64 ]; then sh toolchains/packages.sh qemu-system-x86 busybox-static cpio kmod python3 || true; fi
script "a camera" tests/target/camera_vm.sh build/release/pliant build/camera-vm
target cortex-m7 arm-none-eabi-g++ qemu-system-arm -- gcc-arm-none-eabi libnewlib-arm-none-eabi \
  libstdc++-arm-none-eabi-newlib qemu-system-arm
target aarch64 aarch64-linux-gnu-g++ qemu-aarch64-static -- g++-aarch64-linux-gnu qemu-user-static
target windows x86_64-w64-mingw32-g++-posix /usr/lib/wine/wine64 -- g++-mingw-w64-x86-64-posix wine64
target wasm em++ node -- emscripten nodejs
left_out=long
target armhf arm-linux-gnueabihf-g++ qemu-arm-static -- g++-arm-linux-gnueabihf qemu-user-static
target riscv64 riscv64-linux-gnu-g++ qemu-riscv64-static -- g++-riscv64-linux-gnu qemu-user-static
