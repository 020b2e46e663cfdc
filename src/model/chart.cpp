#include "model/chart.hpp"

namespace pliant {

bool is_in_chart(Vec2 uv) {
  return uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1;
}

}  // namespace pliant
