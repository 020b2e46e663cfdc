#!/bin/sh
# Runs the five commands of docs/your-own-surface.md as they stand there, and checks what the last one prints.
# usage: sh tests/system/own_surface.sh SOURCE_FOLDER PLIANT
set -eu
LC_ALL=C; export LC_ALL
source=$1 pliant=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/bin"
ln -s "$pliant" "$work/bin/pliant"
ln -s "$source/fixtures" "$work/fixtures"
PATH=$work/bin:$PATH; export PATH
# The first indented block of the page.
awk '/^    / { print substr($0, 5); seen = 1; next } seen { exit }' "$source/docs/your-own-surface.md" > "$work/commands"
[ "$(wc -l < "$work/commands")" -eq 5 ] || { echo "the page does not have five commands"; exit 1; }
cd "$work"
sh -eu commands > printed || { cat printed; exit 1; }
tail -1 printed
[ "$(wc -l < track.csv)" -eq 201 ] || { echo "track.csv does not have a row a frame"; exit 1; }
# The sheet is beyond the picture in about 20 frames. Measured: 0.2 degrees.
tail -1 printed | awk '{
  for (i = 1; i <= NF; ++i) { split($i, pair, "="); v[pair[1]] = pair[2] }
  exit !(v["frames"] == 200 && v["tracked"] >= 160 && v["rotation_deg"] < 1) }' || { echo "the track is not right"; exit 1; }
