#include "host/bake/source_check.hpp"

#include <algorithm>
#include <cmath>

#include "host/bake/at.hpp"
#include "host/bake/landmark_names.hpp"
#include "host/bake/record_limit.hpp"
#include "host/bake/source_error.hpp"
#include "host/io/bounding_box.hpp"
#include "host/io/numbers.hpp"
#include "host/io/track_table.hpp"
#include "model/chart.hpp"
#include "model/table_reader.hpp"

namespace pliant::host::bake {

namespace {

/// Tuning of the warnings. Each constant: unit, reason, experiment.
struct SourceCheckTuning {
  /// Diagonal below which a user is warned, millimetres. A camera is 50 mm or more from what it tracks, and sheets of 40, 20 and
  /// 10 mm that fill a third of the frame were found in 39, 27 and 0 of 40 frames.
  float least_tracked_mm = 30;
  /// Distance of the surface's middle from the origin, in diagonals, above which a user is warned. With 1.5 a sheet was tracked in
  /// all frames, with 25 in 83 of 100; one 5 diagonals in front of its origin was not found, since that was behind the camera.
  float most_off_origin = 3;
};
constexpr SourceCheckTuning kTuning{};

/// How a surface is seen along z.
enum class ShownSide { front, back, edge };

/// Of a closed surface, the front. Edge: all of it is seen from the side.
ShownSide side_shown(const Source& source) {
  double area = 0, seen = 0, all = 0;
  for (std::size_t k = 0; k < source.triangles.size(); ++k) {
    if (k < source.is_hole.size() && source.is_hole[k] != 0) continue;
    const auto p = [&](std::size_t corner) { return source.neutral[at(source.triangles[k][corner])]; };
    const Vec3 normal = cross(p(1) - p(0), p(2) - p(0));
    area += static_cast<double>(normal.z);
    seen += static_cast<double>(magnitude(normal.z));
    all += static_cast<double>(length(normal));
  }
  constexpr double kRounding = 1e-3;  // of a closed surface, which has no back, or of one that is edge-on
  if (seen <= kRounding * all) return ShownSide::edge;
  return area < -kRounding * all ? ShownSide::back : ShownSide::front;
}

/// Whether the triangles are one point or line with these vertices: their area is rounding.
template <class Vector, class Area>
bool has_no_area(const Source& source, const std::vector<Vector>& vertices, Area&& area) {
  constexpr double kRounding = 1e-6;  // of the box's diagonal, squared
  BoundingBox<Vector> box;
  double sum = 0;
  for (std::size_t k = 0; k < source.triangles.size(); ++k) {
    if (k < source.is_hole.size() && source.is_hole[k] != 0) continue;
    const auto p = [&](std::size_t corner) { return vertices[at(source.triangles[k][corner])]; };
    for (std::size_t corner = 0; corner < 3; ++corner) box.add(p(corner));
    sum += static_cast<double>(area(p(1) - p(0), p(2) - p(0)));
  }
  const auto diagonal = static_cast<double>(length(box.size()));
  return sum <= kRounding * diagonal * diagonal;
}

}  // namespace

void check_source(const Source& source, const std::string& file) {
  const auto fail = [&file](const std::string& what) { throw SourceError(file, 0, what); };
  constexpr float kFarthest = 2e5f;  // millimetres or radians: well within the format's 1e6
  if (source.parameters.size() > table::kMaxParameters)
    fail("has " + std::to_string(source.parameters.size()) + " parameters, more than " +
         std::to_string(table::kMaxParameters) + ": choose some with --identities and --expressions");
  if (source.shapes.size() > kMostShapes)
    fail("has " + std::to_string(source.shapes.size()) + " shapes, more than " + std::to_string(kMostShapes) +
         ": choose some with --identities and --expressions");
  if (source.landmarks.size() > table::kMaxLandmarks)
    fail("has " + std::to_string(source.landmarks.size()) + " landmarks, more than " +
         std::to_string(table::kMaxLandmarks));
  for (std::size_t k = 0; k < source.landmarks.size(); ++k) {
    const SourceLandmark& l = source.landmarks[k];
    if (!is_in_chart(l.uv))
      fail("the landmark '" + l.name + "' lies outside the chart");
    for (std::size_t i = 0; i < k; ++i)
      if (source.landmarks[i].name == l.name) fail("the landmark '" + l.name + "' appears twice");
  }
  if (has_no_area(source, source.uv, [](Vec2 a, Vec2 b) { return magnitude(a.x * b.y - a.y * b.x); }))
    fail("has no area in the chart: all (u,v) are in a point or a line");
  if (has_no_area(source, source.neutral, [](Vec3 a, Vec3 b) { return length(cross(a, b)); }))
    fail("has no area: all vertices are in a point or a line");
  for (const SourceParameter& p : source.parameters)
    if (is_track_column(p.name))
      fail("the parameter '" + p.name + "' has the name of another column of a track: rename it");
  for (const SourceShape& shape : source.shapes) {
    const SourceParameter& p = source.parameters[shape.parameter];
    float reach = std::max(1.0f, std::abs(p.farthest()));
    if (shape.second >= 0) reach *= std::max(1.0f, std::abs(source.parameters[at(shape.second)].farthest()));
    bool is_near = true;  // false for what is not a number
    for (const Vec3 d : shape.displacement) is_near &= length(d) * reach <= kFarthest;
    for (const float w : shape.weight) is_near &= magnitude(w) * reach <= kFarthest;
    if (!is_near) fail("the parameter '" + p.name + "' moves a vertex by more than 200 m");
  }
}

std::vector<std::string> tracking_warnings(const Source& source, const std::vector<std::size_t>& surface) {
  std::vector<std::string> warnings = misspelt_landmarks(source);
  const auto millimetres = [](float x) {
    return number_text(std::round(100 * static_cast<double>(x)) / 100) + " mm";
  };
  BoundingBox<Vec3> box;
  Vec3 sum{};
  for (const std::size_t v : surface) {
    box.add(source.neutral[v]);
    sum = sum + source.neutral[v];
  }
  const float diagonal = length(box.size());
  const float off = length((1 / static_cast<float>(std::max<std::size_t>(surface.size(), 1))) * sum);
  const ShownSide side = side_shown(source);
  if (side != ShownSide::front)
    warnings.push_back(
        std::string("seen from the front, along z, this surface ") +
        (side == ShownSide::back ? "shows its back" : "is edge-on") +
        ": a rendered picture without a turn, or a start from a box, sees nothing of its front. A "
        "start by print or points "
        "turns it. Else turn its vertices" +
        (side == ShownSide::back ? "; to reverse the corners of its faces would mirror the print"
                                 : ", so that it faces +z"));
  if (diagonal < kTuning.least_tracked_mm)
    warnings.push_back("the surface is " + millimetres(diagonal) +
                       " across, and nothing is tracked nearer than 50 mm: is it in centimetres "
                       "(--unit 10), inches (--unit 25.4) or metres (--unit 1000)?");
  if (off > kTuning.most_off_origin * diagonal)
    warnings.push_back("the origin is " + millimetres(off) + " from the surface, which is " +
                       millimetres(diagonal) +
                       " across, and must be in front of the camera as well: move the surface to it");
  return warnings;
}

}  // namespace pliant::host::bake
