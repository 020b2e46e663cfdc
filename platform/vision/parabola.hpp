#pragma once
// The peak between samples.
#include "pliant/geometry.hpp"

namespace pliant {

/// Where the parabola through three values at -1, 0 and 1, the middle one the largest, has its maximum: -0.5 to 0.5.
constexpr float parabola_peak(float before, float at, float after) {
  const float bend = before - 2 * at + after;
  return bend < 0 ? clamp(0.5f * (before - after) / bend, -0.5f, 0.5f) : 0.0f;
}

}  // namespace pliant
