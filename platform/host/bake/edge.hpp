#pragma once
// An edge of a mesh, whichever way it is passed.
#include <algorithm>
#include <utility>

namespace pliant::host::bake {

/// Its ends, the smaller index first.
using Edge = std::pair<int, int>;
inline Edge edge_of(int a, int b) {
  return {std::min(a, b), std::max(a, b)};
}

}  // namespace pliant::host::bake
