#!/bin/sh
# Builds the portable libraries twice, from two copies of the sources in folders of different names, in another order of
# jobs, and compares the archives and every object byte by byte: neither paths, nor times, nor the order of a build are in
# them. No compiler cache takes part.
# usage: sh tests/target/twice.sh WORK-FOLDER [option of cmake]...
set -eu
here=$(cd "$(dirname "$0")/../.." && pwd)
mkdir -p "$1"; work=$(cd "$1" && pwd); shift
rm -rf "$work/one" "$work/another name"
jobs=1
for copy in one "another name"; do
  mkdir -p "$work/$copy/source"
  cp -R "$here/CMakeLists.txt" "$here/include" "$here/src" "$here/platform" "$work/$copy/source/"
  CCACHE_DISABLE=1 cmake -S "$work/$copy/source" -B "$work/$copy/build" -DCMAKE_BUILD_TYPE=Release -DPLIANT_HOST=OFF \
    -DPLIANT_TESTS=OFF -DPLIANT_LIBCAMERA=OFF "$@" > /dev/null
  CCACHE_DISABLE=1 cmake --build "$work/$copy/build" --parallel $jobs > /dev/null
  jobs=$(nproc)
done
cd "$work/one/build"
objects=$(find . -name '*.o' -o -name '*.obj' -o -name '*.a' | sort)
count=$(echo "$objects" | wc -l)
[ "$count" -gt 60 ] || { echo "twice: FAILED: only $count objects were built" >&2; exit 1; }
for object in $objects; do
  cmp "$object" "$work/another name/build/$object" || { echo "twice: FAILED: $object" >&2; exit 1; }
done
echo "twice: $count objects and archives are the same bytes"
