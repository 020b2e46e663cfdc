#pragma once
/// \file paint.hpp
/// Paints the albedo of a surface: a grey picture over the chart, in layers that a table lists.
#include <array>
#include <string>
#include <vector>

#include "host/bake/cage.hpp"
#include "host/bake/source.hpp"
#include "host/bake/subdivision.hpp"

namespace pliant::host::bake {

/// The surface that is painted.
struct Canvas {
  const Cage& cage;
  const SubdividedCage& fine;
  const std::vector<Vec2>& uv;
  const std::vector<Vec3>& position;
  const std::vector<std::array<int, 3>>& triangles;  ///< two for each fine quad
  const std::vector<char>& is_hole;
};

/// Reads paint.txt of a folder and paints its layers in order; the file explains them. Throws SourceError.
GreyImage paint(const std::string& folder, const Canvas& canvas);

}  // namespace pliant::host::bake
