# Stack use from the call graphs that GCC writes beside its objects (-fcallgraph-info=su): the largest frames, and the
# deepest path from each root. A call through a pointer counts as the deepest of all functions of internal linkage that
# nobody calls by name; one of those may call another so (a criterion samples a surface), three deep.
# usage: awk -v limit=1024 -v roots="NAME NAME ..." -f stack.awk *.ci
function field(name,    at, rest) {
  at = index($0, name ": \"")
  if (!at) return ""
  rest = substr($0, at + length(name) + 3)
  return substr(rest, 1, index(rest, "\"") - 1)
}
/^node:/ {
  title = field("title"); label = field("label")
  if (match(label, /[0-9]+ bytes/)) {
    bytes[title] = substr(label, RSTART, RLENGTH - 6) + 0
    name[title] = substr(label, 1, index(label, "\\n") - 1)
  }
}
/^edge:/ {
  from = field("sourcename"); to = field("targetname")
  if (!((from, to) in seen)) { seen[from, to] = 1; callee[from, ++callees[from]] = to; if (to != from) has_caller[to] = 1 }
}
# The deepest path below and with a function, calls through pointers costing `pointer`.
function depth(f,    k, d, most) {
  if (f == "__indirect_call") return pointer
  if (!(f in bytes)) return 0       # the C library: memcpy and its like
  if (f in known) return known[f]
  known[f] = bytes[f]               # no recursion: a cycle would end here
  most = 0
  for (k = 1; k <= callees[f]; ++k) { d = depth(callee[f, k]); if (d > most) { most = d; next_of[f] = callee[f, k] } }
  return known[f] = bytes[f] + most
}
function pass(    f, most) {
  split("", known)
  most = 0
  for (f in bytes) if (index(f, "/") && !has_caller[f] && depth(f) > most) most = depth(f)
  return most
}
END {
  for (k = 0; k < 3; ++k) pointer = pass()
  split("", known)
  for (f in bytes) {
    ++count
    if (bytes[f] > largest) largest = bytes[f]
    if (bytes[f] > limit) { ++over; printf "frame of %d bytes: %s\n", bytes[f], name[f] }
  }
  printf "functions %d, largest frame %d bytes, frames above %d bytes: %d\n", count, largest, limit, over
  n = split(roots, root, " ")
  for (r = 1; r <= n; ++r)
    for (f in bytes) if (f ~ root[r]) {
      printf "stack %s %d\n", name[f], depth(f)
      if (verbose) for (g = f; g in bytes; g = next_of[g]) printf "    %6d %s\n", bytes[g], name[g]
    }
  exit (over > 0)
}
