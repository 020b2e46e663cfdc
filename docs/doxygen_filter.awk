# What Doxygen reads of a header: members that are deleted or defaulted are left out, and the names of one declaration
# ("float x = 0, y = 0;") become declarations of their own, each with the comment of all of them.
function without_comment(line) { sub(/(\/\/\/<|\/\*\*<).*/, "", line); return line }
function is_several(line) {
  return line !~ /\(/ &&
    line ~ /^[ \t]*((static )?(inline )?constexpr |const )?[A-Za-z_][A-Za-z_0-9:<>]*( const)? [*]?[A-Za-z_][A-Za-z_0-9]*(\[[^]]*\])*( = [^;]*)?,.*;[ \t]*$/
}
function flush_doc() { printf "%s", doc; doc = "" }
function names_of(list, out,   n, i, depth, c, start) {
  n = 0; depth = 0; start = 1
  for (i = 1; i <= length(list); ++i) {
    c = substr(list, i, 1)
    if (c ~ /[({\[]/) ++depth
    if (c ~ /[)}\]]/) --depth
    if (c == "," && depth == 0) { out[++n] = substr(list, start, i - start); start = i + 1 }
  }
  out[++n] = substr(list, start)
  return n
}
# Data members with a trailing underscore are not for users.
/^[ \t]+[A-Za-z][^(]*[A-Za-z0-9]_( = [^(]*)?;/ { doc = ""; next }
/^#(define|undef) PLIANT_HAS_SIZE|^PLIANT_HAS_SIZE/ { next }
/= delete;[ \t]*$/ || /\(\) = default;[ \t]*$/ { doc = ""; next }
/^[ \t]*\/\/\/[^<]/ || /^[ \t]*\/\/\/$/ { release(); doc = doc $0 "\n"; next }
held != "" && /^[ \t]*\/\/\/</ { tail = tail "\n" $0; next }
{ release() }
is_several(without_comment($0)) {
  held = $0; tail = ""
  next
}
{ flush_doc(); print }
END { release(); flush_doc() }
function release(   text, at, declaration, type, list, part, n, i) {
  if (held == "") return
  at = match(held, /\/\/\/<|\/\*\*</)
  text = at ? substr(held, at) tail : tail
  declaration = at ? substr(held, 1, at - 1) : held
  sub(/;[ \t]*$/, "", declaration)
  match(declaration, /^[ \t]*((static )?(inline )?constexpr |const )?[A-Za-z_][A-Za-z_0-9:<>]*( const)? /)
  type = substr(declaration, 1, RLENGTH); list = substr(declaration, RLENGTH + 1)
  n = names_of(list, part)
  for (i = 1; i <= n; ++i) { printf "%s", doc; sub(/^[ \t]+/, "", part[i]); print type part[i] ";  " text }
  doc = ""; held = ""; tail = ""
}
