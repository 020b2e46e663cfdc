// Which pixels a camera may have.
#pragma once

namespace pliant {

/// Range of Camera::aspect. Round values; the integers of TurnedPicture count on them.
constexpr float kLeastAspect = 0.5f, kMostAspect = 2;

/// False for NaN.
constexpr bool is_aspect(float aspect) {
  return aspect >= kLeastAspect && aspect <= kMostAspect;
}

}  // namespace pliant
