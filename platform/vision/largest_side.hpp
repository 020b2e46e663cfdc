// How large an image may be.
#pragma once

namespace pliant {

/// Largest side of an image, px, as that of TrackerLimits.
constexpr int kLargestSidePx = 16384;

}  // namespace pliant
