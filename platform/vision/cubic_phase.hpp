#pragma once
// The phase of cubic sampling.
#include "vision/patch_arrays.hpp"

namespace pliant::patch {

// Catmull and Rom's cubic as the line between the two middle samples less a bend:
//   p1 + t (p2 - p1) - t (1 - t) / 2 [(1 - t) (p0 - 2 p1 + p2) + t (p1 - 2 p2 + p3)].
// Its remaining phase error is of the form t (1 - t) (1 - 2 t). Moving t by a twentieth of that halves the position
// error on textures with wavelengths of five pixels and more (measured on plane waves).
struct CubicPhase {
  i16 line, blend;  // the two uses of t, times 2^15
  i16 bend;         // t (1 - t) times 2^16, at most 2^14
};

inline CubicPhase cubic_phase(int f) {
  const int p = f * (kSubpixel - f);             // t (1 - t) * 2^14
  const int odd = p * (kSubpixel - 2 * f) / 20;  // t (1 - t) (1 - 2 t) / 20 * 2^21
  return {narrow(f * 256 + odd / 64), narrow(f * 256), narrow(p * 4)};
}

}  // namespace pliant::patch
