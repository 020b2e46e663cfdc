#pragma once
// How far a warp is from none.
#include "pliant/geometry.hpp"

namespace pliant {

/// The largest difference of an entry from that of the identity: px, by which a point moves that is 1 px away.
inline float strain(const Mat2& warp) {
  return max(max(magnitude(warp.a - 1), magnitude(warp.d - 1)), max(magnitude(warp.b), magnitude(warp.c)));
}

}  // namespace pliant
