// The adaptive mesh on the built-in face (the paper, section 5): what each criterion pays for how much accuracy. The
// errors are Eq. 5's, averaged by area and finely sampled, the face at rest unless said otherwise.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "baked_face.hpp"
#include "host/commands/mesh_curve.hpp"
#include "host/render/mesh_figure.hpp"
#include "host/render/model_mesh.hpp"
#include "host/render/shown_mesh.hpp"

namespace face_mesh_test {

using namespace pliant;
using namespace pliant::host;

namespace {

ModelSurface& face_at_rest() {
  static auto* surface = new ModelSurface(baked_face().model, baked_face().rest());
  return *surface;
}

struct Measured {
  int vertices;
  ContourError error;
  AdaptStop stop;
};

Measured measured(const MeshRequest& request, ModelSurface& surface = face_at_rest()) {
  const ModelMesh mesh(baked_face().model, surface, request);
  REQUIRE(mesh.mesh().validate().invariant == 0);
  return {mesh.mesh().vertex_count(), mesh.measure(), mesh.report().stop};
}

constexpr int kDeepest = 12;

MeshRequest uniform(int levels) {
  return {MeshCriterion::uniform, levels, 0, 0};
}
MeshRequest contour(float mean_mm) {
  return {MeshCriterion::contour, kDeepest, mean_mm, 0};
}
MeshRequest budget(int vertices) {
  return {MeshCriterion::contour, kDeepest, 0, vertices};
}

const Measured& three_levels() {
  static const Measured m = measured(uniform(3));
  return m;
}

// Of triangles with mean error k times their area, as small ones on a smooth surface have: N of one size have an error
// E with N E = area x integral of k. Sizes that give every triangle the same error, as a tolerance does, have the same
// N E: they lower the maximum, not the mean. The least N E is the squared integral of k^(1/2), for sizes that go as
// k^(-1/2), with the same error times area in every triangle: what a budget aims at.

/// The least N E as a fraction of that of triangles of equal size.
double least_fraction() {
  const ModelMesh mesh(baked_face().model, face_at_rest(), uniform(3));
  double area = 0, root = 0, whole = 0;
  for (const FaceId f : mesh.mesh().faces()) {
    const ContourError e = measure_contour(mesh.shape(), mesh.mesh().triangle(f), 5);
    const auto a = static_cast<double>(e.area_mm2);
    const double k = static_cast<double>(e.mean_mm) / a;
    area += a;
    root += a * std::sqrt(k);
    whole += a * k;
  }
  return root * root / (area * whole);
}

}  // namespace

TEST_CASE(
    "three levels everywhere: contour refinement has their mean error with fewer vertices, as few as can "
    "be") {
  const double least = least_fraction();
  const double fraction = 0.8;
  const int vertices = static_cast<int>(fraction * three_levels().vertices);
  const Measured refined = measured(budget(vertices));
  MESSAGE("three levels: " << three_levels().vertices << " vertices, " << three_levels().error.mean_mm
                           << " mm; " << vertices << " vertices by contour: " << refined.error.mean_mm
                           << " mm; least fraction of triangles " << least);
  CHECK(refined.vertices <= vertices);
  CHECK(refined.error.mean_mm <= three_levels().error.mean_mm);
  // The error of this face is spread so evenly that no sizes of triangles whatever could do with half of them.
  CHECK(least > 0.65);
  CHECK(fraction < 1.1 * least);
}

TEST_CASE(
    "three levels everywhere: contour refinement has their maximum error with a quarter of their vertices") {
  const Measured refined = measured(contour(0.73f));
  MESSAGE("three levels: " << three_levels().vertices << " vertices, maximum " << three_levels().error.max_mm
                           << " mm; by contour " << refined.vertices << ", " << refined.error.max_mm
                           << " mm");
  CHECK(refined.stop == AdaptStop::converged);
  CHECK(4 * refined.vertices < three_levels().vertices);
  CHECK(refined.error.max_mm <= three_levels().error.max_mm);
}

TEST_CASE(
    "a tolerance has the same mean error as equal triangles for its vertices, and a much smaller maximum") {
  const Measured even = measured(contour(0.18f));
  const auto cost = [](const Measured& m) { return static_cast<float>(m.vertices) * m.error.mean_mm; };
  MESSAGE("vertices x mean error: tolerance " << cost(even) << ", three levels " << cost(three_levels()));
  CHECK(cost(even) == doctest::Approx(static_cast<double>(cost(three_levels()))).epsilon(0.1));
  CHECK(even.error.max_mm < 0.3f * three_levels().error.max_mm);
}

TEST_CASE("a budget has no larger mean error than the contour criterion with as many vertices") {
  for (const float mean_mm : {1.0f, 0.5f, 0.25f}) {
    const Measured by_tolerance = measured(contour(mean_mm)),
                   by_budget = measured(budget(by_tolerance.vertices));
    CAPTURE(mean_mm);
    CHECK(by_budget.vertices <= by_tolerance.vertices);
    CHECK(by_budget.error.mean_mm <= by_tolerance.error.mean_mm);
  }
}

TEST_CASE(
    "with an open mouth and a smile a budget has a smaller error than tolerance, and tolerance than "
    "normals") {
  auto q = baked_face().posed("jawOpen");
  for (const char* name : {"mouthSmileLeft", "mouthSmileRight"})
    q[baked_face().model.find_parameter(name)] = 0.8f;
  ModelSurface smile(baked_face().model, q);
  const Measured by_tolerance = measured(contour(0.5f), smile);
  MeshRequest normals{MeshCriterion::normals, kDeepest, 20, by_tolerance.vertices};
  CHECK(measured(budget(by_tolerance.vertices), smile).error.mean_mm <= by_tolerance.error.mean_mm);
  CHECK(by_tolerance.error.mean_mm < measured(normals, smile).error.mean_mm);
}

TEST_CASE("a tolerance is met on the whole face, and the error falls with every level") {
  const Measured fine = measured(contour(0.3f));
  CHECK(fine.stop == AdaptStop::converged);
  CHECK(fine.error.mean_mm < 0.3f);
  CHECK(fine.error.max_mm < 3 * 0.3f);
  float before = measured({}).error.mean_mm;
  for (int levels = 1; levels <= 3; ++levels) {
    const float now = measured(uniform(levels)).error.mean_mm;
    CHECK(now < 0.75f * before);
    before = now;
  }
}

TEST_CASE("the figure has five columns and three rows, none of them empty, and the table a row a mesh") {
  const Image figure = draw_mesh_figure(baked_face().model, face_at_rest());
  CHECK(figure.channels == 3);
  const int width = figure.width / 5, height = figure.height / 3;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 5; ++column) {
      int drawn = 0;
      for (int y = row * height; y < (row + 1) * height; ++y)
        for (int x = column * width; x < (column + 1) * width; ++x) drawn += *figure.at(x, y) < 200;
      CAPTURE(row);
      CAPTURE(column);
      CHECK(drawn > width * height / 100);
      CHECK(drawn < width * height * 9 / 10);
    }
  const std::string table = mesh_curve(baked_face().model, face_at_rest(), {0.5f});
  CHECK(std::count(table.begin(), table.end(), '\n') == 2 + 1 + 4 + 4 + 2);
  CHECK(std::count(table.begin(), table.end(), '|') == 7 * (2 + 1 + 4 + 4 + 2));
  CHECK(table.find("| unconditional | depth 3 | " + std::to_string(three_levels().vertices)) !=
        std::string::npos);
}

TEST_CASE("an opening is closed whole or not at all, and never with more vertices than there may be") {
  const ModelMesh mesh(baked_face().model, face_at_rest(), uniform(1));
  const MeshData open = mesh_data(mesh), closed = closed_mesh(mesh);
  REQUIRE(closed.position.size() > open.position.size() + 3);  // eyes and mouth
  std::size_t sizes = 0;
  for (std::size_t most = open.position.size(), before = 0; most <= closed.position.size(); ++most) {
    const MeshData part = closed_mesh(mesh, most);
    REQUIRE(part.position.size() <= most);
    REQUIRE(part.level.size() == part.faces.size());
    std::vector<char> is_used(part.position.size(), 0);
    for (const auto& f : part.faces)
      for (const std::uint16_t v : f) is_used[v] = 1;
    CHECK(std::count(is_used.begin(), is_used.end(), 0) == 0);
    sizes += part.position.size() != before;
    before = part.position.size();
  }
  CHECK(sizes >= 3);  // more openings are closed as there are more vertices
  CHECK(closed_mesh(mesh, 0).faces == open.faces);
}

}  // namespace face_mesh_test
