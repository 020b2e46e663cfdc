#include "pliant/criteria.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "aligned_block.hpp"
#include "mesh_shapes.hpp"
#include "random.hpp"

namespace criteria_test {

using namespace pliant;
using shapes::limits;
using shapes::MeshBox;
using shapes::Triangles;

namespace {

// One surface on one mesh, sampled at its vertices.
struct Sampled {
  Sampled(const Triangles& base, const Surface& s, int vertices = 200, int faces = 400)
      : box(limits(vertices, faces, 14), base), surface(s) {
    REQUIRE(box.status == Status::ok);
    sample();
  }
  void sample() {
    position.assign(box.mesh.limits().vertices, Vec3{});
    for (const VertexId v : box.mesh.vertices()) position[v] = surface(box.mesh.uv(v));
  }
  Shape shape() const { return {box.mesh, surface, position.data()}; }
  MeshBox box;
  Surface surface;
  std::vector<Vec3> position;
};

Triangles one_triangle(Vec2 a, Vec2 b, Vec2 c) {
  return {{a, b, c}, {0, 1, 2}};
}

Surface surface_of(Vec3 (*sample)(void*, Vec2)) {
  return {nullptr, sample};
}
Vec3 plane(void*, Vec2 uv) {
  return {uv.x, uv.y, 3 * uv.x - 2 * uv.y + 1};
}
Vec3 paraboloid(void*, Vec2 uv) {
  return {uv.x, uv.y, uv.x * uv.x + uv.y * uv.y};
}
Vec3 roof(void*, Vec2 uv) {
  return {100 * uv.x, 100 * uv.y, uv.x < 0.5f ? 60 * uv.x : 60 - 60 * uv.x};
}
Vec3 collapsed(void*, Vec2) {
  return {1, 2, 3};
}

float squared(Vec2 a) {
  return dot(a, a);
}

int adapt(Sampled& s, const Criterion& criterion, AdaptReport* report = nullptr) {
  const MeshLimits l = s.box.mesh.limits();
  AlignedBlock block(measured_bytes<Adapter>(l));
  Arena arena(block.data(), block.size());
  Adapter adapter;
  REQUIRE(create_in(arena, adapter, l) == Status::ok);
  REQUIRE(adapter.start(s.box.mesh, s.surface, criterion) == Status::ok);
  const AdaptReport r = adapter.adapt({});
  if (report != nullptr) *report = r;
  s.sample();
  return r.splits;
}

}  // namespace

TEST_CASE("Eq. 5-7: the contour error of a flat surface is zero") {
  Sampled s(shapes::block_grid(3), surface_of(plane));
  for (const FaceId f : s.box.mesh.faces()) {
    const ContourError e = measure_contour(s.shape(), s.box.mesh.triangle(f));
    CHECK(e.mean_mm < 1e-6f);
    CHECK(e.max_mm < 1e-6f);
  }
  CHECK(compute_contour_error(s.shape(), 8).mean_mm < 1e-6f);
}

TEST_CASE(
    "Eq. 6 and 7: on a paraboloid the mean is a twelfth of the sum of squared edges, the maximum a quarter "
    "of the longest") {
  Random random{9};
  for (int i = 0; i < 50; ++i) {
    const Vec2 c{random.uniform(0, 1), random.uniform(0, 1)};
    const Vec2 a = c + Vec2{random.uniform(0.1f, 1.1f), 0}, b = c + Vec2{0, random.uniform(0.1f, 1.1f)};
    // A right angle at c: the maximum is in the middle of the hypotenuse, the subdivision edge.
    Sampled s(one_triangle(a, b, c), surface_of(paraboloid));
    const float mean = (squared(b - a) + squared(c - b) + squared(a - c)) / 12, most = squared(b - a) / 4;
    const ContourError few = measure_contour(s.shape(), s.box.mesh.triangle(0));
    const ContourError many = measure_contour(s.shape(), s.box.mesh.triangle(0), 64);
    CHECK(few.mean_mm == doctest::Approx(static_cast<double>(mean)).epsilon(1e-4));
    CHECK(few.max_mm == doctest::Approx(static_cast<double>(most)).epsilon(1e-4));
    CHECK(many.mean_mm == doctest::Approx(static_cast<double>(mean)).epsilon(2e-3));
    CHECK(many.max_mm == doctest::Approx(static_cast<double>(most)).epsilon(0.05));
    CHECK(many.max_mm <= most * 1.0001f);
  }
}

TEST_CASE("splitting a paraboloid's triangles quarters the error with every two levels") {
  Sampled s(shapes::block_grid(2), surface_of(paraboloid), 2000, 4000);
  float before = compute_contour_error(s.shape(), 6).mean_mm;
  for (int levels = 2; levels <= 6; levels += 2) {
    Unconditional depth{levels};
    (void)adapt(s, criterion_of(depth));
    const float now = compute_contour_error(s.shape(), 6).mean_mm;
    CHECK(now == doctest::Approx(static_cast<double>(before) / 4).epsilon(0.15));
    before = now;
  }
}

TEST_CASE("a contour tolerance that is off does not count, and the rank is the largest ratio") {
  Sampled s(one_triangle({0, 0}, {1, 0}, {0, 1}), surface_of(paraboloid));
  const Triangle t = s.box.mesh.triangle(0);
  const ContourError e = measure_contour(s.shape(), t);
  CHECK(compute_rank(ContourOptions{0.1f, 0, 0}, s.shape(), t) == e.mean_mm / 0.1f);
  CHECK(compute_rank(ContourOptions{0, 0.1f, 0}, s.shape(), t) == e.max_mm / 0.1f);
  CHECK(compute_rank(ContourOptions{0, 0, 0.1f}, s.shape(), t) == e.mean_mm * e.area_mm2 / 0.1f);
  CHECK(compute_rank(ContourOptions{0.1f, 0.1f, 100}, s.shape(), t) == e.max_mm / 0.1f);
  CHECK(compute_rank(ContourOptions{0, 0, 0}, s.shape(), t) == 0);
}

TEST_CASE("a weld rank is the rank of the worse triangle that comes back") {
  Sampled s(shapes::block_grid(3), surface_of(paraboloid));
  const ContourOptions options;
  const Criterion c = criterion_of(options);
  for (FaceId f = 0; f < 18; f = static_cast<FaceId>(f + 2)) {
    const float before = max(c.refine_rank(c.context, s.shape(), f),
                             c.refine_rank(c.context, s.shape(), static_cast<FaceId>(f + 1)));
    VertexId v = kNone;
    REQUIRE(s.box.mesh.split_edge(Mesh::half_edge(f, 0), v) == Status::ok);
    s.sample();
    CHECK(c.weld_rank(c.context, s.shape(), v) == before);
    REQUIRE(s.box.mesh.weld_edge(v) == Status::ok);
  }
}

TEST_CASE("normals: a plane is left alone, a ridge is refined down to the shortest edge") {
  const NormalsOptions options{0.96593f, 4};
  Sampled flat(shapes::block_grid(3), surface_of(plane));
  CHECK(adapt(flat, criterion_of(options)) == 0);
  Sampled nothing(shapes::block_grid(3), surface_of(collapsed));
  CHECK(adapt(nothing, criterion_of(options)) == 0);
  Sampled s(shapes::block_grid(3), surface_of(roof), 2000, 4000);
  AdaptReport report;
  CHECK(adapt(s, criterion_of(options), &report) > 50);
  CHECK(report.stop == AdaptStop::converged);
  for (const FaceId f : s.box.mesh.faces()) {
    CHECK(compute_rank(options, s.shape(), s.box.mesh.triangle(f)) <= 1);
    float nearest = 1;
    for (int k = 0; k < 3; ++k)
      nearest = min(nearest, magnitude(s.box.mesh.uv(s.box.mesh.corner(f, k)).x - 0.5f));
    if (nearest > 0.4f) CHECK(s.box.mesh.face_level(f) < 4);  // fine at the ridge, coarse away from it
  }
}

TEST_CASE(
    "normals: an interior edge is judged by its dihedral angle, a boundary edge by the normals at its ends") {
  Triangles two = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {2, 0, 1, 0, 2, 3}};
  Sampled s(two, surface_of(plane));
  s.position = {{0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {0, 10, 0}};
  s.position.resize(200);
  const NormalsOptions options{0.5f, 0};
  CHECK(compute_rank(options, s.shape(), s.box.mesh.triangle(0)) == 0);
  s.position[3] = {5, 5, 0};  // the second half has no area and no normal
  CHECK(compute_rank(options, s.shape(), s.box.mesh.triangle(0)) == 0);
  s.position[3] = {5, 5, 7.0710678f};  // the second half stands upright: 90 degrees, cos 0
  CHECK(compute_rank(options, s.shape(), s.box.mesh.triangle(0)) == doctest::Approx(2));
  CHECK(compute_rank(NormalsOptions{0.5f, 100}, s.shape(), s.box.mesh.triangle(0)) == 0);
  // Without the interior edge: at 60 degrees' tolerance the ends' mean normals (45 degrees apart) are within
  // it.
  const Triangle alone{{2, 0, 1}, {kNone, kNone, kNone}, 0};
  const float half_turn = 1 - 0.70710678f;
  CHECK(compute_rank(options, s.shape(), alone) ==
        doctest::Approx(static_cast<double>(half_turn / 0.5f)).epsilon(1e-4));
}

TEST_CASE(
    "view: pixels grow with focal length and nearness, and errors along the line of sight do not show") {
  // A square of 100 mm that faces the camera at 1 m.
  struct Dent {
    Vec3 amount;
    static Vec3 sample(void* context, Vec2 uv) {
      const float w = 16 * uv.x * (1 - uv.x) * uv.y * (1 - uv.y);
      return Vec3{100 * uv.x - 50, 100 * uv.y - 50, 0} + w * static_cast<Dent*>(context)->amount;
    }
  };
  Dent sideways{{4, 0, 0}}, towards{{0, 0, 4}};
  Sampled a(shapes::block_grid(1), {&sideways, &Dent::sample}),
      b(shapes::block_grid(1), {&towards, &Dent::sample});
  ViewOptions view;
  const auto rank = [&](Sampled& s) { return compute_rank(view, s.shape(), s.box.mesh.triangle(0)); };
  const float plain = rank(a);
  CHECK(plain ==
        doctest::Approx(500.0 / 1000 * 4 / 0.5).epsilon(0.02));  // the middle of the diagonal moves by 4 mm
  CHECK(rank(b) < 0.05f * plain);
  view.focal_px = 1000;
  CHECK(rank(a) == doctest::Approx(2 * static_cast<double>(plain)).epsilon(0.01));
  view.focal_px = 500;
  view.pose.t.z = 2000;
  CHECK(rank(a) == doctest::Approx(static_cast<double>(plain) / 2).epsilon(0.01));
  view.pose.t.z = -1000;  // behind the camera
  CHECK(rank(a) == 0);
  for (const Vec2 beside : {Vec2{5000, 0}, Vec2{-5000, 0}, Vec2{0, 5000}, Vec2{0, -5000}}) {
    view.pose.t = {beside.x, beside.y, 1000};  // far outside the image
    CHECK(rank(a) < 0.2f * plain);
  }
}

TEST_CASE("view: a triangle that reaches into the picture counts in full, wherever its middle is seen") {
  // Two triangles of 2 m fill the picture from 0.3 m; their middles are seen 278 px beside that of the picture.
  Sampled wall(shapes::block_grid(1), surface_of([](void*, Vec2 uv) {
                 return Vec3{2000 * uv.x - 1000, 2000 * uv.y - 1000, 30 * uv.x * (1 - uv.x)};
               }));
  ViewOptions view;
  view.pose.t = {0, 0, 300};
  const auto rank = [&](const Sampled& s, int f) {
    return compute_rank(view, s.shape(), s.box.mesh.triangle(static_cast<FaceId>(f)));
  };
  const float full = rank(wall, 0);
  view.hidden_gain = 1;
  CHECK(rank(wall, 0) == full);
  // A floor 0.2 m below the camera, from 0.8 m behind it to 1.2 m before it. Of one triangle a third is before it.
  Sampled floor(shapes::block_grid(1), surface_of([](void*, Vec2 uv) {
                  return Vec3{2000 * uv.x - 1000, -200 - 30 * uv.x * (1 - uv.x), 2000 * uv.y - 1000};
                }));
  view.pose.t = {0, 0, 200};
  CHECK(rank(floor, 0) > 1);
  CHECK(rank(floor, 1) > 1);
  view.pose.t = {0, 0, -1100};  // all of it is behind the camera
  CHECK(rank(floor, 0) == 0);
  CHECK(rank(floor, 1) == 0);
}

TEST_CASE("view: the silhouette counts more and the far side less") {
  Sampled s(shapes::block_grid(1), surface_of([](void*, Vec2 uv) {
              return Vec3{100 * uv.x - 50, 100 * uv.y - 50, 30 * uv.x * (1 - uv.x)};
            }));
  ViewOptions view;
  const Triangle t = s.box.mesh.triangle(0);
  const auto rank_at = [&](float degrees) {
    const float half = degrees * 0.00872664626f;
    view.pose.q = {std::cos(half), 0, std::sin(half), 0};
    return compute_rank(view, s.shape(), t);
  };
  view.silhouette_gain = view.hidden_gain = 1;
  const float side = rank_at(85), back = rank_at(150), front = rank_at(30);
  view.silhouette_gain = 3;
  view.hidden_gain = 0.05f;
  CHECK(rank_at(30) == front);
  CHECK(rank_at(85) == doctest::Approx(3 * static_cast<double>(side)));
  CHECK(rank_at(150) == doctest::Approx(0.05 * static_cast<double>(back)));
}

TEST_CASE("texture: vertices gather where the score is high and never closer than the shortest edge") {
  Sampled s(shapes::block_grid(2), surface_of(roof), 2000, 4000);
  TextureOptions options;
  options.shortest_edge_mm = 3;
  CHECK(adapt(s, criterion_of(options)) == 0);
  options.score = [](void*, Vec2 uv) { return uv.y > 0.75f ? 1.0f : 0.0f; };
  CHECK(adapt(s, criterion_of(options)) > 100);
  int high = 0, low = 0;
  for (const VertexId v : s.box.mesh.vertices()) (s.box.mesh.uv(v).y > 0.75f ? high : low) += 1;
  CHECK(high > 2 * low);
  for (const FaceId f : s.box.mesh.faces())
    if (s.box.mesh.face_level(f) > 0)
      for (int k = 0; k < 3; ++k)
        CHECK(length(s.position[s.box.mesh.corner(f, k)] - s.position[s.box.mesh.corner(f, (k + 1) % 3)]) >=
              3 * 0.7071f);
}

TEST_CASE(
    "texture: an edge that a split would make too short has rank 0, and so has all without a shortest edge") {
  Sampled s(one_triangle({0, 0}, {1, 0}, {0, 1}), surface_of(plane));
  s.position[1] = s.position[0] + Vec3{0, 10, 0};  // the ends of the subdivision edge
  TextureOptions options;
  options.score = [](void*, Vec2) { return 2.0f; };
  const auto rank = [&](float shortest_edge_mm) {
    options.shortest_edge_mm = shortest_edge_mm;
    return compute_rank(options, s.shape(), s.box.mesh.triangle(0));
  };
  CHECK(rank(4) == doctest::Approx(2 * 1.25 * 1.25));
  CHECK(rank(5) == 2);
  CHECK(rank(5.01f) == 0);
  CHECK(rank(0) == 0);
  CHECK(rank(-1) == 0);
}

TEST_CASE("either of two criteria asks for a face, both must let a vertex go") {
  Sampled s(shapes::block_grid(2), surface_of(roof), 2000, 4000);
  TextureOptions texture;
  texture.score = [](void*, Vec2 uv) { return uv.y > 0.75f ? 1.0f : 0.0f; };
  const ContourOptions contour{0.5f, 2, 0};
  const EitherOf both{criterion_of(texture), criterion_of(contour)};
  const Criterion c = criterion_of(both);
  (void)adapt(s, c);
  for (const FaceId f : s.box.mesh.faces()) {
    CHECK(compute_rank(texture, s.shape(), s.box.mesh.triangle(f)) <= 1);
    CHECK(compute_rank(contour, s.shape(), s.box.mesh.triangle(f)) <= 1);
    CHECK(c.refine_rank(c.context, s.shape(), f) ==
          max(compute_rank(texture, s.shape(), s.box.mesh.triangle(f)),
              compute_rank(contour, s.shape(), s.box.mesh.triangle(f))));
  }
}

TEST_CASE("a criterion without a number for a face leaves the face to the other of two") {
  Criterion nothing;
  nothing.refine_rank = [](const void*, const Shape&, FaceId) { return std::nanf(""); };
  nothing.weld_rank = [](const void*, const Shape&, VertexId) { return std::nanf(""); };
  const ContourOptions contour{0.01f, 0, 0};
  int splits[2] = {};
  for (const bool is_first : {true, false}) {
    Sampled s(shapes::block_grid(2), surface_of(paraboloid), 2000, 4000);
    EitherOf both{nothing, criterion_of(contour)};
    if (!is_first) both = {both.second, both.first};
    splits[is_first] = adapt(s, criterion_of(both));
  }
  CHECK(splits[0] > 10);
  CHECK(splits[1] == splits[0]);
}

}  // namespace criteria_test
