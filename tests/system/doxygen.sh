#!/bin/sh
# Doxygen over the public headers without a warning: every public declaration has a comment. Exits 77 without Doxygen.
# usage: sh tests/system/doxygen.sh SOURCE_FOLDER SCRATCH_FOLDER
set -eu
cd "$1"
command -v doxygen >/dev/null 2>&1 || { echo "skipped: no doxygen on this machine"; exit 77; }
mkdir -p "$2"
{ cat docs/Doxyfile; echo "OUTPUT_DIRECTORY = $2"; echo "GENERATE_HTML = NO"; echo "GENERATE_XML = YES"; } | doxygen - 2>&1
