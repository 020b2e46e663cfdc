#include "host/bake/boundary_loops.hpp"

#include "host/bake/at.hpp"

namespace pliant::host::bake {

std::vector<std::vector<int>> trace_loops(std::vector<int> next) {
  std::vector<std::vector<int>> loops;
  for (std::size_t first = 0; first < next.size(); ++first) {
    if (next[first] < 0) continue;
    std::vector<int> loop;
    for (int v = static_cast<int>(first); next[at(v)] >= 0;) {
      loop.push_back(v);
      const int after = next[at(v)];
      next[at(v)] = -1;
      v = after;
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

double doubled_loop_area(const std::vector<Vec2>& uv, const std::vector<int>& loop) {
  const auto product = [](float a, float b) { return static_cast<double>(a) * static_cast<double>(b); };
  double sum = 0;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Vec2 a = uv[at(loop[k])], b = uv[at(loop[(k + 1) % loop.size()])];
    sum += product(a.x, b.y) - product(a.y, b.x);
  }
  return sum;
}

}  // namespace pliant::host::bake
