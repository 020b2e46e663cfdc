#pragma once
/// \file points_file.hpp
/// Reads points CSV: `landmark,x,y`, one named image point a row. The optional columns `u,v` give the surface point; if they are
/// empty, the name is a landmark of the model.
#include <optional>
#include <string>
#include <vector>

#include "pliant/geometry.hpp"

namespace pliant::host {

/// Largest coordinate of a point that is taken, px; far outside every picture.
constexpr float kFarthestPx = 1e6f;

struct NamedPoint {
  std::string name;
  Vec2 x;                    ///< px
  std::string where;         ///< "FILE: line N"
  std::optional<Vec2> uv{};  ///< in [0,1]^2; none: the model's landmark of that name
};

/// The points of a file, in its order; further columns are ignored. Bad input, with line and column: a
/// missing column, a coordinate that is not a finite number, only one of u and v or outside [0,1], an empty or repeated name.
std::vector<NamedPoint> read_points(const std::string& path);
std::vector<NamedPoint> parse_points(const std::string& source, const std::string& text);

}  // namespace pliant::host
