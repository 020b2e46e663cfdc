#!/bin/sh
# What only the program itself shows: closed standard streams, readers that go away, and a limit on the size of files.
# usage: sh tests/system/streams.sh PLIANT SOURCE_FOLDER
set -u
pliant=$1 sheet=$2/fixtures/sheet
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
fail() { echo "$1"; cat said; exit 1; }
bake() { "$pliant" bake "$sheet" --size 16 -o "$1"; }

bake whole.plm > said 2>&1 || fail "bake fails"
bake out.plm >&- 2> said
[ $? -eq 1 ] || fail "bake does not exit with 1 where standard output is closed"
bake err.plm > said 2>&- || fail "bake fails where standard error is closed"
for table in out err; do
  cmp whole.plm $table.plm || fail "a message is in the table"
done

(ulimit -f 8; bake long.plm > said 2>&1)
[ $? -eq 1 ] || fail "bake does not exit with 1 where the table is larger than a file may be"
[ "$(cat said)" = "pliant bake: long.plm: writing failed: File too large" ] || fail "bake does not say why it fails"
[ ! -e long.plm ] || fail "a part of a table is left"

# The reader is gone before the table is written: it never reads.
{ bake - 2> said; echo $? > code; } | :
[ "$(cat code)" -eq 1 ] && grep -q "^pliant bake: standard output: writing failed: Broken pipe$" said ||
  fail "bake does not say that its reader went away"
