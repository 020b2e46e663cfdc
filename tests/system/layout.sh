#!/bin/sh
# The rules of the house that a machine can check. Prints each violation as file:line: rule, and fails if there is one.
# usage: sh tests/system/layout.sh SOURCE_FOLDER
set -eu
cd "$1"
faults=$(mktemp)
trap 'rm -f "$faults"' EXIT

# fault RULE: what grep or awk found, "file:line:text", one line each.
fault() { sed "s|^\([^:]*:[0-9]*\):.*|\1: $1|" >> "$faults"; }

# --- The core includes nothing of the platform.
# A private include of the core is a file of the core, and so is not found under platform.
grep -rnE '^ *# *include "' src | grep -v '"pliant/' | while IFS= read -r line; do
  name=$(echo "$line" | sed 's/.*include "\([^"]*\)".*/\1/')
  [ -e "src/$name" ] || echo "$line"
done | fault "the core includes what is not the core's"
# Public headers from which a frame can be reached are the platform's.
platform=pliant/frame.hpp
while :; do
  pattern=$(echo "$platform" | paste -sd'|')
  more=$( (echo "$platform"; grep -lE "include \"($pattern)\"" include/pliant/* | sed 's|^include/||') | sort -u)
  [ "$more" != "$platform" ] || break
  platform=$more
done
grep -rnE "include \"($pattern)\"" src | fault "the core includes a header of the platform"

# --- Public headers ask a user for no more than the language's own small headers; libcamera.hpp is for systems that have
# the whole library.
grep -nE '^ *# *include *[<"](Eigen/|string>|vector>|functional>|cmath>|math\.h>|iostream>|memory>)' include/pliant/* |
  grep -v '^include/pliant/libcamera\.hpp:' | fault "a public header includes Eigen or the standard library"
grep -nE '^ *# *include "' include/pliant/* | grep -v '"pliant/' | fault "a public header includes a private one"

# --- Lengths.
# too_long LINES FILES...
too_long() {
  most=$1; shift
  awk -v most="$most" 'FNR == most + 1 { print FILENAME ":" FNR ":" }' "$@" | fault "more than $most lines"
}
too_long 200 include/pliant/*
# shellcheck disable=SC2046
too_long 500 $(find src platform tests -name '*.?pp' -o -name '*.c' -o -name '*.h')
# Of bytes that continue a character none counts, whatever the locale.
find include src platform tests \( -name '*.?pp' -o -name '*.[ch]' \) -exec env LC_ALL=C awk '
  { line = $0; gsub(/[\200-\277]/, "", line) }
  length(line) > 132 { print FILENAME ":" FNR ":" }' {} + | fault "a line of more than 132 characters"
# Functions outside of classes: from the first line at the margin to the brace that closes at the margin.
find src platform -name '*.?pp' -exec awk '
  FNR == 1 { start = 0 }
  /^[A-Za-z[]/ && !/^(namespace|using|struct|class|enum|union|constexpr|const|static|inline const|#)/ && !start { start = FNR }
  /;$/ && start == FNR { start = 0 }
  /^}/ { if (start && $0 == "}" && FNR - start + 1 > 60) print FILENAME ":" start ":"; start = 0 }' {} + |
  fault "a function of more than 60 lines"

# --- Every unit test is built: named in tests/CMakeLists.txt, without its ending.
for file in tests/unit/*/*_test.cpp; do
  name=$(basename "$file" _test.cpp)
  grep -qE "(^|[ /])$name([ )]|\$)" tests/CMakeLists.txt || echo "$file:"
done | fault "a test that is not built"

# --- Friends.
grep -rnE '^ *friend ' include src platform | fault "a friend"

# --- No path of a machine, but where tools are found on every one.
find . -type d \( -name 'build*' -o -name .git -o -name fixtures \) -prune -o -type f \( -name '*.?pp' -o -name '*.[ch]' \
  -o -name '*.sh' -o -name '*.py' -o -name '*.awk' -o -name '*.cmake' -o -name '*.txt' -o -name '*.md' -o -name '*.json' \
  -o -name '*.yml' -o -name '*.js' -o -name '*.html' \) ! -path ./tests/system/layout.sh -print | sed 's|^\./||' |
  while IFS= read -r file; do grep -nHE '(/home/|/Users/|/root/|[^a-zA-Z$][CD]:\\)' "$file" || true; done |
  grep -v '\$work/' | fault "a path of one machine"

[ ! -s "$faults" ] || { cat "$faults"; exit 1; }
echo "ok: $(find src include platform -name '*.?pp' | wc -l) files of the library follow the rules"
