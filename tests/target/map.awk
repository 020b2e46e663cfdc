# Bytes of code and of constants that the portable libraries have in a linked image, from GNU ld's map of it.
# usage: awk [-v by_file=1] -f map.awk IMAGE.map
function hex(s,    k, v) {
  for (k = 3; k <= length(s); ++k) v = 16 * v + index("0123456789abcdef", substr(s, k, 1)) - 1
  return v
}
/^Linker script and memory map/ { linked = 1 }
!linked { next }
/^ \.[a-zA-Z]/ { section = $1 }
/libpliant_(core|track)\.a\(/ {
  for (i = 1; i < NF; ++i) if ($i ~ /^0x/ && $(i + 1) ~ /^0x/) {
    bytes = hex($(i + 1))
    if (section ~ /^\.text/) { text += bytes; file = $NF; sub(/.*\(/, "", file); of[file] += bytes }
    if (section ~ /^\.(rodata|srodata|data\.rel\.ro)/) constants += bytes
    break
  }
}
END {
  print text + 0, constants + 0
  if (by_file) for (f in of) printf "%7d %s\n", of[f], f | "sort -rn"
}
