#pragma once
/// \file paint.hpp
/// Paints the grey picture over the chart that `render` draws a face with: layers read from a table, one on
/// the other.
#include <array>
#include <string>
#include <vector>

#include "host/bake/cage.hpp"
#include "host/bake/source.hpp"
#include "host/bake/subdivision.hpp"

namespace pliant::host::bake {

/// What is painted on.
struct Canvas {
  const Cage& cage;
  const SubdividedCage& fine;
  const std::vector<Vec2>& uv;
  const std::vector<Vec3>& position;
  const std::vector<std::array<int, 3>>& triangles;  ///< two a fine quad
  const std::vector<char>& is_hole;
};

/// Reads `folder`/paint.txt, which explains its layers, and paints them. Throws SourceError.
GreyImage paint(const std::string& folder, const Canvas& canvas);

}  // namespace pliant::host::bake
