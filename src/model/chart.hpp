// The square of surface coordinates.
#pragma once
#include "pliant/geometry.hpp"

namespace pliant {

/// False for NaN. Not inline, for the sake of code size.
bool is_in_chart(Vec2 uv);

}  // namespace pliant
