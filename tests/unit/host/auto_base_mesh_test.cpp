// The automatic base mesh of the built-in face: as many vertices as asked, along the chart's boundaries, through its
// landmarks, of triangles alike in size and shape, and a base that a mesh takes.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "baked_model.hpp"
#include "host/bake/bake.hpp"
#include "host/io/owned.hpp"
#include "pliant/mesh.hpp"
#include "sanitized.hpp"

namespace auto_base_mesh_test {

using namespace pliant;

namespace {

std::vector<std::uint8_t> bake_with(int base_vertices) {
  host::bake::BakeOptions options;
  options.source = PLIANT_FIXTURES "/face";
  options.size = 64;  // the base mesh does not depend on the fields
  options.base_vertices = base_vertices;
  static const host::bake::Source source = host::bake::read_source(options);  // of which they are no part
  return host::bake::bake_source(source, options);
}

struct BaseMeshCase {
  int wanted;
  BakedModel face;
  host::Owned<Mesh> mesh;
  std::vector<Vec3> position;

  explicit BaseMeshCase(int vertices)
      : wanted(vertices), face(bake_with(vertices)), mesh(MeshLimits{10000, 20000, 2}) {
    const Status status = mesh->set_base(face.model.base_uv(), face.model.base_corners());
    REQUIRE_MESSAGE(status == Status::ok, text(status));
    for (const Vec2 uv : face.model.base_uv()) position.push_back(face.at(uv, face.rest()));
  }
  Vec3 corner(FaceId f, int k) { return position[mesh->corner(f, k)]; }
  std::vector<float> areas() {
    std::vector<float> out;
    for (const FaceId f : mesh->faces())
      out.push_back(0.5f * length(cross(corner(f, 1) - corner(f, 0), corner(f, 2) - corner(f, 0))));
    std::sort(out.begin(), out.end());
    return out;
  }
  /// Of all corners, ascending, degrees.
  std::vector<float> angles() {
    std::vector<float> out;
    for (const FaceId f : mesh->faces())
      for (int k = 0; k < 3; ++k) {
        const Vec3 a = normalised(corner(f, (k + 1) % 3) - corner(f, k)),
                   b = normalised(corner(f, (k + 2) % 3) - corner(f, k));
        out.push_back(57.29578f * std::acos(clamp(dot(a, b), -1, 1)));
      }
    std::sort(out.begin(), out.end());
    return out;
  }
};

const std::vector<std::unique_ptr<BaseMeshCase>>& cases() {
  static const auto all = [] {
    std::vector<std::unique_ptr<BaseMeshCase>> made;
    for (const int vertices : {150, 480, 1000, 2000})
      if (vertices < 1000 || !kSanitized) made.push_back(std::make_unique<BaseMeshCase>(vertices));
    return made;
  }();
  return all;
}

float at_fraction(const std::vector<float>& sorted, double fraction) {
  return sorted[static_cast<std::size_t>(fraction * static_cast<double>(sorted.size() - 1))];
}

}  // namespace

TEST_CASE("the base mesh has the number of vertices that was asked for, to 15 %, and is valid") {
  for (const auto& c : cases()) {
    CAPTURE(c->wanted);
    CHECK(std::abs(c->mesh->vertex_count() - c->wanted) < 0.15 * c->wanted);
    CHECK(c->mesh->validate().invariant == 0);
  }
}

TEST_CASE(
    "it is a disc with three holes, the chart has no fold-over, and blocks are complete except at the "
    "boundary") {
  for (const auto& c : cases()) {
    CAPTURE(c->wanted);
    const MeshStatistics s = c->mesh->compute_statistics();
    CHECK(s.euler == 1 - 3);
    CHECK(s.boundary_loops == 4);
    // The chart's v points down, so every area is negative.
    CHECK(s.folded_faces == s.faces);
    CHECK(s.largest_valence <= 10);
    int alone = 0;
    for (const FaceId f : c->mesh->faces()) alone += c->mesh->twin(Mesh::half_edge(f, 0)) == kNone;
    CHECK(alone < s.boundary_edges);
  }
}

TEST_CASE(
    "landmarks on the surface are vertices, to a millimetre, all of them where the mesh is fine enough to "
    "tell "
    "them apart") {
  for (const auto& c : cases()) {
    CAPTURE(c->wanted);
    const float edge = std::sqrt(4 / 1.732f * at_fraction(c->areas(), 0.5));
    int kept = 0, count = 0;
    for (const Landmark& l : c->face.model.landmarks()) {
      const std::string name = l.name;
      if (name == "eye_left" || name == "eye_right") continue;  // in the middle of an opening
      const Vec3 place = c->face.at(l.uv(), c->face.rest());
      float nearest_mm = 1e9f;
      for (const Vec3 p : c->position) nearest_mm = min(nearest_mm, length(p - place));
      CHECK_MESSAGE(nearest_mm < 0.6f * edge, name);
      kept += nearest_mm < 1;
      ++count;
    }
    CAPTURE(kept);
    if (c->wanted >= 480) CHECK(kept == count);
    CHECK(kept >= 0.6 * count);
  }
}

TEST_CASE("the boundary of the mesh follows the boundary of the surface") {
  for (const auto& c : cases()) {
    CAPTURE(c->wanted);
    const ChartImage mask = c->face.model.mask();
    double inside = 0, area = 0;
    for (std::size_t k = 0; k < std::size_t{mask.width} * mask.height; ++k) inside += mask.pixels[k] != 0;
    inside /= static_cast<double>(mask.width - 1) * (mask.height - 1);
    int outside = 0;
    for (const FaceId f : c->mesh->faces()) {
      const Vec2 a = c->mesh->uv(c->mesh->corner(f, 0)), b = c->mesh->uv(c->mesh->corner(f, 1)),
                 d = c->mesh->uv(c->mesh->corner(f, 2));
      area += 0.5 * static_cast<double>(magnitude((b.x - a.x) * (d.y - a.y) - (b.y - a.y) * (d.x - a.x)));
      outside += !c->face.model.is_on_surface((1.0f / 3) * (a + b + d));
    }
    CHECK(area == doctest::Approx(inside).epsilon(0.03));
    CHECK(outside <= 0.01 * c->mesh->face_count());
  }
}

TEST_CASE(
    "triangles are of nearly one size on the surface, smaller along the openings only, and well shaped") {
  for (const auto& c : cases()) {
    CAPTURE(c->wanted);
    const auto areas = c->areas();
    const auto angles = c->angles();
    CHECK(at_fraction(areas, 0.9) < 4 * at_fraction(areas, 0.25));
    CHECK(at_fraction(areas, 0.95) < 2.5f * at_fraction(areas, 0.5));
    CHECK(areas.back() < 6 * at_fraction(areas, 0.5));
    CHECK(angles.front() > 3);
    CHECK(at_fraction(angles, 0.05) > 25);
  }
}

TEST_CASE("the face's base mesh is its own mirror image") {
  for (const auto& c : cases()) {
    CAPTURE(c->wanted);
    const auto uv = c->face.model.base_uv();
    float worst = 0;
    for (std::size_t v = 0; v < uv.count; ++v) {
      float nearest = 1e9f;
      for (std::size_t w = 0; w < uv.count; ++w)
        nearest = min(nearest, length(uv[w] - Vec2{1 - uv[v].x, uv[v].y}));
      worst = max(worst, nearest);
    }
    CHECK(worst < 1e-5f);
  }
}

TEST_CASE("sizes beyond the limits are refused by name, and the table stays as it was") {
  for (const int vertices : {-1, 0, 59, 5001}) {
    host::bake::BakeOptions options;
    options.source = PLIANT_FIXTURES "/face";
    options.base_vertices = vertices;
    std::vector<std::uint8_t> table{1, 2, 3};
    std::string error;
    CHECK_FALSE(host::bake::bake(options, table, error));
    CHECK(error.find("--base-mesh") != std::string::npos);
    CHECK(table.size() == 3);
  }
}

}  // namespace auto_base_mesh_test
