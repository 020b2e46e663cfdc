#pragma once
// The simplest source of a model: a square sheet over the whole chart.
#include <functional>

#include "host/bake/source.hpp"

/// A square of n x n vertices over the chart, lifted by f, with two triangles a cell.
inline pliant::host::bake::Source sheet(int n, const std::function<pliant::Vec3(pliant::Vec2)>& f) {
  pliant::host::bake::Source source;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const pliant::Vec2 uv{static_cast<float>(i) / static_cast<float>(n - 1),
                            static_cast<float>(j) / static_cast<float>(n - 1)};
      source.uv.push_back(uv);
      source.neutral.push_back(f(uv));
    }
  for (int j = 0; j + 1 < n; ++j)
    for (int i = 0; i + 1 < n; ++i) {
      const int a = j * n + i;
      source.triangles.push_back({a, a + n, a + n + 1});
      source.triangles.push_back({a, a + n + 1, a + 1});
    }
  source.is_hole.assign(source.triangles.size(), 0);
  source.base_uv = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
  source.base_corners = {2, 0, 1, 0, 2, 3};
  return source;
}

inline pliant::Vec3 dome(pliant::Vec2 uv) {
  return {100 * (uv.x - 0.5f), 100 * (0.5f - uv.y), 40 * uv.x * (1 - uv.x)};
}
