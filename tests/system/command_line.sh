#!/bin/sh
# Compares docs/command-line.md with the command's own help: after a line "<!-- pliant WORDS -->" a fenced block follows that
# must be what the command prints. Every command must be there. With --write the blocks are renewed.
# usage: sh tests/system/command_line.sh PLIANT SOURCE_FOLDER [--write]
set -eu
pliant=$1; document=$2/docs/command-line.md
made=$(mktemp)
trap 'rm -f "$made"' EXIT
in_block=""
while IFS= read -r line || [ -n "$line" ]; do
  case $in_block$line in
    "wait"'```'*) in_block=skip; echo "$line"
      # shellcheck disable=SC2086
      "$pliant" $words ;;
    "skip"'```') in_block=""; echo "$line" ;;
    skip*) ;;
    "<!-- pliant "*" -->") words=${line#<!-- pliant }; words=${words% -->}; in_block=wait; echo "$line" ;;
    *) echo "$line" ;;
  esac
done < "$document" > "$made"
for command in $("$pliant" --help | sed -n 's/^  pliant \([a-z]*\) .*/\1/p'); do
  grep -q "^<!-- pliant $command --help -->$" "$made" || { echo "$document: pliant $command is missing"; exit 1; }
done
[ "${3:-}" != --write ] || { cp "$made" "$document"; exit 0; }
diff "$document" "$made" || {
  echo "$document is not what the command prints; renew it with: sh tests/system/command_line.sh PLIANT . --write"
  exit 1
}
