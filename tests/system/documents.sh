#!/bin/sh
# Checks the documents: every section that a comment cites exists, every link resolves, lines are no longer than those of the
# sources, the README is short.
# Prints each fault and fails if there was one. usage: sh tests/system/documents.sh SOURCE_FOLDER
set -eu
cd "$1"
faults=$(mktemp)
trap 'rm -f "$faults"' EXIT

documents=$(ls README.md CHANGELOG.md docs/*.md platform/boards/*/README.md)
sources=$(find include src platform tests fixtures toolchains CMakeLists.txt -type f \
  \( -name '*.?pp' -o -name '*.h' -o -name '*.c' -o -name '*.cmake' -o -name CMakeLists.txt -o -name '*.sh' \
     -o -name '*.py' -o -name '*.awk' \) ! -path tests/system/documents.sh)

# Headings, as "FILE<tab>heading", and as "FILE<tab>#anchor" in the form that GitHub and Doxygen make of them.
headings() {
  awk '/^```/ { code = !code } !code && /^#+ / {
    sub(/^#+ +/, ""); print FILENAME "\t" $0
    anchor = tolower($0); gsub(/[^a-z0-9 _-]/, "", anchor); gsub(/ /, "-", anchor); print FILENAME "\t#" anchor }' $documents
}
known=$(headings)
has() { printf '%s\n' "$known" | grep -qixF "$1	$2"; }
has_beginning() { printf '%s\n' "$known" | awk -F '\t' -v f="$1" -v n="$2" \
  '$1 == f && index(tolower($2 " "), tolower(n " ")) == 1 { found = 1 } END { exit !found }'; }

# Citations, by number or by a heading's name: comment lines are joined, so that one may run over the end of a line.
# "FILE<tab>DOCUMENT<tab>sections".
# shellcheck disable=SC2086
awk 'FNR == 1 && NR > 1 { scan() } FNR == 1 { file = FILENAME; text = "" }
  { line = $0; gsub(/^[ \t]*(\/\/[\/!]?<?|\*|#)[ \t]*|\/\/\/</, " ", line); text = text " " line }
  END { scan() }
  function scan(   rest, cite, doc) {
    gsub(/[ \t]+/, " ", text); rest = text
    while (match(rest, /docs\/[a-z-]+\.md(, (sections? [A-Za-z0-9]|[A-Z0-9])[^).;]*(\.[0-9][^).;]*)*)?/)) {
      cite = substr(rest, RSTART, RLENGTH); rest = substr(rest, RSTART + RLENGTH)
      doc = cite; sub(/,.*/, "", doc)
      if (cite !~ /,/) cite = ""; else sub(/[^,]*, (sections? )?/, "", cite)
      print file "\t" doc "\t" cite
    }
  }' $sources | sort -u | while IFS='	' read -r file document section; do
  [ -f "$document" ] || { echo "$file: there is no $document"; continue; }
  case $section in
    "") ;;
    [0-9]*) for number in $(echo "$section" | grep -oE '[0-9]+(\.[0-9]+)?'); do
        has_beginning "$document" "$number" || echo "$file: $document has no section $number"
      done ;;
    *) word=$(echo "$section" | sed 's/[,: ].*//')
       has_beginning "$document" "$word" || echo "$file: $document has no section $word" ;;
  esac
done >> "$faults"
# A citation of anything that is not part of the project.
# shellcheck disable=SC2086
grep -nE 'ALGORITHMS|DESIGN\.md|GLOSSARY' $sources >> "$faults" || true

# Links: [text](target), relative to the document.
for document in $documents; do
  awk '/^```/ { code = !code } !code && !/^    / { rest = $0
    while (match(rest, /\]\([^)]*\)/)) { print substr(rest, RSTART + 2, RLENGTH - 3); rest = substr(rest, RSTART + RLENGTH) } }' \
    "$document" | while read -r target; do
    case $target in http://* | https://*) continue ;; esac
    path=${target%%#*}
    folder=$(dirname "$document")
    [ "$folder" = . ] && at=$path || at=$folder/$path
    at=$(echo "$at" | sed -e ':again' -e 's|[^/]*/\.\./||' -e 't again')
    [ -n "$path" ] || at=$document
    [ -e "$at" ] || { echo "$document: no such file: $target"; continue; }
    case $target in *#*) has "$at" "#${target##*#}" || echo "$document: no such heading: $target" ;; esac
  done
done >> "$faults"

# Prose in lines of at most 132 characters, which are bytes but for those that continue a character. Tables, code and pictures may be
# longer, and so may the entries of the changelog.
# shellcheck disable=SC2046,SC2086
LC_ALL=C awk 'FNR == 1 { code = 0 } /^```/ { code = !code } code || /^(\||    |```|!\[|<!--|#)/ { next }
  { line = $0; gsub(/[\200-\277]/, "", line); if (length(line) > 132) print FILENAME ":" FNR ": more than 132 characters" }' \
  $(echo "$documents" | grep -v '^CHANGELOG.md$') >> "$faults"

# Every section that the evaluation script measures has its place, and only those.
if command -v python3 >/dev/null 2>&1; then
  sections=$(python3 tests/bench/evaluate.py --list | sort)
  places=$(sed -n 's/^<!-- measured: \(.*\) -->$/\1/p' docs/evaluation.md | sort)
  [ "$sections" = "$places" ] || echo "docs/evaluation.md: its sections are not those of tests/bench/evaluate.py" >> "$faults"
fi

lines=$(wc -l < README.md)
[ "$lines" -le 150 ] || echo "README.md: $lines lines, at most 150" >> "$faults"
[ ! -s "$faults" ] || { cat "$faults"; exit 1; }
echo "ok: $(echo "$documents" | wc -w) documents, $(printf '%s\n' "$known" | wc -l) headings"
