#!/bin/sh
# A compiler launcher. Where the same compiler has compiled the same source with the same flags, it takes that object. What may differ
# are the level of optimisation, warnings as errors, and GCC's call graph. Else it compiles.
# usage: sh reuse_object.sh BUILD_FOLDER COMMANDS COMPILER argument...
#   COMMANDS  a file: commands of the build in that folder, one a line
set -eu
build=$1 commands=$2
shift 2
object="" depends="" before=""
for word in "$@"; do
  case $before in -o) object=$word ;; -MF) depends=$word ;; esac
  before=$word
done
source=$before  # the last argument
# flags WORDS...: without what may differ, and without names of files, in order.
flags() {
  before=""
  for word in "$@"; do
    case $before in -o | -MF | -MT) before=$word; continue ;; esac
    before=$word
    case $word in
      -O? | -DNDEBUG | -Werror | -fcallgraph-info=* | -o | -MF | -MT) ;;
      *) echo "$word" ;;
    esac
  done | sort
}
theirs=$(grep -F -e " -c $source" "$commands" | sed -e "s|^.*$1 |$1 |" -e 's/ *$//') || true
found=$build/${object#pliant/}
if [ -n "$theirs" ] && [ -f "$found" ] && [ -n "$depends" ] && [ "$(flags $theirs)" = "$(flags "$@")" ]; then
  cp "$found" "$object"
  echo "$object: $source" > "$depends"
  echo "$source" >> "$commands.reused"
  exit
fi
exec "$@"
