#pragma once
/// \file points_file.hpp
/// Points CSV: `landmark,x,y`, a named image point a line.
#include <string>
#include <vector>

#include "pliant/geometry.hpp"

namespace pliant::cli {

struct NamedPoint {
  std::string name;
  Vec2 x;             ///< px
  std::string where;  ///< "FILE: line N"
};

/// The points of a file, in its order; further columns are ignored. Bad input, with line and column: a
/// missing column, a coordinate that is not a finite number, an empty or repeated name.
std::vector<NamedPoint> read_points(const std::string& path);
std::vector<NamedPoint> parse_points(const std::string& source, const std::string& text);

}  // namespace pliant::cli
