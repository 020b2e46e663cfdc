#!/bin/sh
# Configures and builds the libraries without each optional part: libcamera, the host's library and command, the tests; and
# without all of them, as somebody's sub-project does. Says which targets must not be there any more.
# usage: sh tests/target/parts.sh WORK-FOLDER [option of cmake]...
set -eu
here=$(cd "$(dirname "$0")/../.." && pwd)
mkdir -p "$1"; work=$(cd "$1" && pwd); shift
fail() { echo "parts: FAILED: $1" >&2; exit 1; }

# without NAME TARGET-THAT-IS-GONE TARGET-TO-BUILD [option of cmake]...
without() {
  name=$1; gone=$2; build=$3; shift 3
  rm -rf "$work/$name"
  cmake -S "$here" -B "$work/$name" -DCMAKE_BUILD_TYPE=Debug "$@" > "$work/$name.log" 2>&1 || fail "$name: see $work/$name.log"
  cmake --build "$work/$name" --target help | grep -q "$gone" && fail "$name: $gone is still there"
  cmake --build "$work/$name" --target $build --parallel "$(nproc)" >> "$work/$name.log" 2>&1 || fail "$name: see $work/$name.log"
  echo "parts: without $name: $build"
}
without libcamera pliant_libcamera "pliant host_tests" -DPLIANT_LIBCAMERA=OFF "$@"
"$work/libcamera/pliant" camera list > "$work/camera.log" 2>&1 && fail "a camera without libcamera"
grep -q 'without libcamera' "$work/camera.log" || fail "no line says that libcamera is not there"
without tests digest_test pliant_track -DPLIANT_TESTS=OFF "$@"
# What only the host's command needs is not even looked for; without the tests Eigen is not, either.
none="-DCMAKE_DISABLE_FIND_PACKAGE_CLI11=ON -DCMAKE_DISABLE_FIND_PACKAGE_nlohmann_json=ON"
without host pliant_host "pliant_track base_tests" -DPLIANT_HOST=OFF $none "$@"
without all pliant_host pliant_track -DPLIANT_LIBCAMERA=OFF -DPLIANT_HOST=OFF -DPLIANT_TESTS=OFF $none -DCMAKE_DISABLE_FIND_PACKAGE_Eigen3=ON "$@"
