#pragma once
/// \file source.hpp
/// A surface before it becomes a model table: one triangle mesh over the chart, its rest shape, and how each parameter moves
/// its vertices. Every kind of input is converted to it.
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "host/io/learnt_file.hpp"
#include "pliant/geometry.hpp"
#include "pliant/model.hpp"

namespace pliant::host::bake {

struct SourceParameter {
  std::string name;
  Group group;
  float minimum, maximum, sd;

  /// The limit that is farther from rest.
  float farthest() const { return maximum >= -minimum ? maximum : minimum; }
};

/// One step of the cascade. It adds the parameter times `displacement` (Eq. 4), or rotates each vertex about the axis by the
/// parameter times `weight`. Exactly one of the two vectors is filled, with one value a vertex, unless `mirror_of` is set. A
/// corrective shape adds `displacement` times the product of two parameters, which may be the same one.
struct SourceShape {
  std::size_t parameter;
  std::vector<Vec3> displacement;
  std::vector<float> weight;
  Vec3 axis, pivot;
  int mirror_of = -1;  ///< index of an earlier shape of displacements whose mirror image this is, or -1
  int second = -1;     ///< second parameter of a corrective shape, or -1
};

struct SourceLandmark {
  std::string name;
  Vec2 uv;
};

struct SourceCurve {
  std::string name;
  CurveKind kind;
  std::vector<Vec2> points;
};

/// A spring between two of the points, as a table stores it (docs/model-format.md).
struct SourceSpring {
  std::uint16_t first, second;
  float length_mm, sd_mm;
};

/// Springs that keep lengths on the surface. Without springs there are no points.
struct SourceSprings {
  std::vector<Vec2> points;
  std::vector<SourceSpring> springs;
};

/// A picture over the chart; rows from v = 0 to v = 1.
struct GreyImage {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
};

struct Source {
  std::vector<Vec2> uv;                       ///< one a vertex
  std::vector<Vec3> neutral;                  ///< one a vertex, millimetres
  std::vector<std::array<int, 3>> triangles;  ///< counter-clockwise seen from outside
  std::vector<char> is_hole;  ///< one a triangle: it fills an opening and is no part of the surface
  std::vector<SourceParameter> parameters;
  std::vector<SourceShape> shapes;  ///< in the order of the cascade
  std::vector<SourceLandmark> landmarks;
  std::vector<SourceCurve> curves;
  std::vector<Vec2> base_uv;                ///< if empty, a base mesh is made
  std::vector<std::uint16_t> base_corners;  ///< three a face, in basic-block form
  bool is_symmetric =
      false;               ///< the surface is its own mirror image (u to 1 - u) and has vertices on u = 0.5
  GreyImage albedo;        ///< may be empty
  bool has_print = false;  ///< the albedo is a print that the surface can be found by
  /// Reads the pictures of this source anew and gives the albedo of at most so many pixels a side; empty where the albedo does
  /// not depend on the size of the table. Throws as the reader does.
  std::function<GreyImage(const Source& source, int most_side)> paint;
  SourceSprings springs;   ///< may be empty
  LearntTables learnt;     ///< for finding faces; each may be empty
  std::vector<std::string> warnings;  ///< of the reader, for the user, one line each
};

}  // namespace pliant::host::bake
