#pragma once
/// \file albedo_picture.hpp
/// The albedo of a surface from the pictures of an OBJ file's materials.
#include <vector>

#include "host/bake/source.hpp"
#include "host/io/image.hpp"

namespace pliant::host::bake {

/// Where the albedo of a surface comes from.
struct PaintedSurface {
  std::vector<Vec2> picture_uv;  ///< one a vertex: u to the right and v upwards, each 0 to 1 over its picture
  std::vector<int> picture;      ///< one a triangle: index in `pictures`, or -1 for light grey
  std::vector<Image> pictures;
};

/// Samples the pictures over the chart. Pictures with more pixels than the result are averaged first. Around the surface the
/// values are those of its boundary.
/// \param most_side  pixels of a side of the result, count, at most; it has no more than the largest picture has.
GreyImage albedo_of(const Source& source, const PaintedSurface& painted, int most_side);

}  // namespace pliant::host::bake
