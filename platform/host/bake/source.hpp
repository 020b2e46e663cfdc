#pragma once
/// \file source.hpp
/// What every kind of source is brought to before it becomes a table: one triangle mesh over the chart, its
/// rest shape, and how each parameter moves its vertices.
#include <array>
#include <string>
#include <vector>

#include "pliant/geometry.hpp"
#include "pliant/model.hpp"

namespace pliant::host::bake {

struct SourceParameter {
  std::string name;
  Group group;
  float minimum, maximum, sd;
};

/// A step of the cascade: `displacement` times the parameter is added (Eq. 4), or the vertices turn about an
/// axis by the parameter times `weight`. Exactly one of the two is filled, a value a vertex.
struct SourceShape {
  std::size_t parameter;
  std::vector<Vec3> displacement;
  std::vector<float> weight;
  Vec3 axis, pivot;
  int mirror_of =
      -1;  ///< the earlier shape of displacements whose mirror image this is, with which it shares samples
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

/// Rows from v = 0 to v = 1.
struct GreyImage {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
};

struct Source {
  std::vector<Vec2> uv;                       ///< a vertex
  std::vector<Vec3> neutral;                  ///< a vertex, millimetres
  std::vector<std::array<int, 3>> triangles;  ///< counter-clockwise seen from outside
  std::vector<char> is_hole;                  ///< a triangle: closes an eye or the mouth, is not skin
  std::vector<SourceParameter> parameters;
  std::vector<SourceShape> shapes;  ///< in the order of the cascade
  std::vector<SourceLandmark> landmarks;
  std::vector<SourceCurve> curves;
  std::vector<Vec2> base_uv;                ///< may be empty: then a base mesh is made
  std::vector<std::uint16_t> base_corners;  ///< three a face, in basic-block form
  bool is_symmetric = false;                ///< its own mirror image, u to 1 - u, with vertices on u = 0.5
  GreyImage albedo;                         ///< may be empty
};

}  // namespace pliant::host::bake
