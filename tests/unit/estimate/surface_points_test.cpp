#include "estimate/surface_points.hpp"

#include <doctest/doctest.h>

#include "posed_egg.hpp"
#include "random.hpp"

namespace surface_points_test {

using namespace pliant;

namespace {

struct Rig {
  PosedEgg egg{0.2f};
  ExpectedEgg expected{egg};
  InArena<SurfacePoints> points{std::size_t{20}, std::size_t{8}, egg.samples()};

  Rig() { points->clear(egg.samples()); }
  Status add(PointKind kind, Vec2 uv, std::uint16_t* id, Vec2 along = {1, 0}) {
    return points->add(kind, uv, along, egg.cascade.object, egg.state.q, id);
  }
  Prediction predict(std::uint16_t id) {
    Prediction p;
    Vec3 at;
    REQUIRE(points->predict(
        id, {egg.cascade.object, expected.motion->expected(), egg.state, Projector(egg.state.view, true)}, &p,
        &at));
    CHECK(length(at - egg.cascade->surface_point(points->uv(id), egg.state.q)) < 0.05f);
    return p;
  }
};

}  // namespace

TEST_CASE("ids are the lowest free ones, stay, and are used again") {
  Rig rig;
  std::uint16_t id = 0;
  for (std::uint16_t k = 0; k < 20; ++k) {
    REQUIRE(rig.add(PointKind::surface, {0.04f * float(k), 0.5f}, &id) == Status::ok);
    CHECK(id == k);
  }
  CHECK(rig.add(PointKind::surface, {0.5f, 0.5f}, &id) == Status::capacity);
  rig.points->remove(7);
  CHECK_FALSE(rig.points->has(7));
  CHECK(rig.points->has(8));
  REQUIRE(rig.add(PointKind::curve, {0.5f, 0.5f}, &id) == Status::ok);
  CHECK(id == 7);
  rig.points->clear(rig.egg.samples());
  CHECK_FALSE(rig.points->has(0));
}

TEST_CASE("points outside the chart, curves without direction and null ids are refused and take no id") {
  Rig rig;
  std::uint16_t id = 99;
  CHECK(rig.add(PointKind::surface, {1.1f, 0.5f}, &id) == Status::bad_argument);
  CHECK(rig.add(PointKind::curve, {0.5f, 0.5f}, &id, {0, 0}) == Status::bad_argument);
  CHECK(rig.add(PointKind::surface, {0.5f, 0.5f}, nullptr) == Status::bad_argument);
  CHECK(id == 99);
  for (std::uint16_t k = 0; k < 20; ++k) CHECK_FALSE(rig.points->has(k));
}

TEST_CASE("a prediction is the projection of the point, with the derivatives of the image along u and v") {
  Rig rig;
  Random random(4);
  for (int k = 0; k < 20; ++k) {
    std::uint16_t id;
    const Vec2 uv{random.uniform(0.2f, 0.8f), random.uniform(0.2f, 0.8f)};
    REQUIRE(rig.add(PointKind::surface, uv, &id) == Status::ok);
    const Prediction p = rig.predict(id);
    CHECK(length(p.x - rig.egg.image_of(uv)) < 0.05f);
    const float h = 2e-3f;
    const Vec2 du = (0.5f / h) * (rig.egg.image_of({uv.x + h, uv.y}) - rig.egg.image_of({uv.x - h, uv.y}));
    CHECK(length(du - Vec2{p.jacobian.a, p.jacobian.c}) < 12);  // of about 170 px
    CHECK(p.covariance.xx > 0);
    CHECK(rig.points->is_turned_to_camera(p));
  }
}

TEST_CASE("a point behind the camera is told, and predicted far from the image") {
  Rig rig;
  std::uint16_t id;
  REQUIRE(rig.add(PointKind::surface, {0.5f, 0.5f}, &id) == Status::ok);
  rig.egg.state.view.rho = 2e-2f;
  Prediction p;
  Vec3 at;
  const bool in_front = rig.points->predict(id,
                                            {rig.egg.cascade.object, rig.expected.motion->expected(),
                                             rig.egg.state, Projector(rig.egg.state.view, true)},
                                            &p, &at);
  CHECK_FALSE(in_front);
  CHECK(p.x.x == kBehind.x);
}

TEST_CASE("the camera sees the tangents of a model that has turned as it did before") {
  Rig rig;
  std::uint16_t id;
  REQUIRE(rig.add(PointKind::surface, {0.4f, 0.6f}, &id) == Status::ok);
  const Mat2 before = rig.predict(id).jacobian;
  const Quat turn = exp_rotation({0.05f, 0.1f, -0.07f});
  rig.points->sample_again(id, turn, rig.egg.cascade.object, rig.egg.state.q);
  rig.egg.state.view.q = rig.egg.state.view.q * turn;
  const Mat2 after = rig.predict(id).jacobian;  // the point moves a little towards or away from the camera
  CHECK(length(Vec2{after.a - before.a, after.c - before.c}) < 2);
  CHECK(length(Vec2{after.b - before.b, after.d - before.d}) < 2);
}

TEST_CASE("one point in the interval gets new tangents in a frame, all of them after the interval") {
  Rig rig;
  std::uint16_t id;
  for (int k = 0; k < 8; ++k)
    REQUIRE(rig.add(PointKind::surface, {0.3f + 0.05f * float(k), 0.85f}, &id) == Status::ok);
  rig.egg.q[5] = 0.5f;  // jawOpen turns the lower half
  std::vector<Mat2> before;
  for (std::uint16_t k = 0; k < 8; ++k) before.push_back(rig.predict(k).jacobian);
  const auto count_updated = [&] {
    int updated = 0;
    for (std::uint16_t k = 0; k < 8; ++k) updated += rig.predict(k).jacobian.d != before[k].d;
    return updated;
  };
  rig.points->update_tangents(rig.egg.cascade.object, rig.egg.state.q, 4, 4);
  CHECK(count_updated() == 2);
  for (std::uint32_t frame = 5; frame < 8; ++frame)
    rig.points->update_tangents(rig.egg.cascade.object, rig.egg.state.q, frame, 4);
  CHECK(count_updated() == 8);
}

TEST_CASE("silhouette points go to the contour in their own sector; one without contour has no normal") {
  Rig rig;
  std::uint16_t id[8];
  for (std::uint16_t& i : id) REQUIRE(rig.add(PointKind::silhouette, {0.5f, 0.5f}, &i) == Status::ok);
  std::uint16_t more;
  CHECK(rig.add(PointKind::silhouette, {0.5f, 0.5f}, &more) == Status::capacity);
  CHECK(rig.points->silhouette_count() == 8);
  std::vector<SilhouettePoint> contour;
  for (int k = 0; k < 32; ++k) {  // half a circle
    const float angle = 3.1f * float(k) / 32;
    const Vec3 turned = rotation_matrix(exp_rotation({0, 0, angle})) * Vec3{1, 0, 0};
    SilhouettePoint p;
    p.x = {100 * turned.x, 100 * turned.y};
    p.normal = {turned.x, turned.y};
    p.uv = {0.5f + 0.4f * turned.x, 0.5f + 0.4f * turned.y};
    contour.push_back(p);
  }
  rig.points->place_silhouette({contour.data(), contour.size()}, rig.egg.cascade.object, rig.egg.state.q);
  int placed = 0;
  for (std::uint16_t i : id) {
    const Prediction p = rig.predict(i);
    if (!rig.points->is_turned_to_camera(p)) continue;
    ++placed;
    const Vec2 uv = rig.points->uv(i);
    CHECK(dot(p.normal, uv - Vec2{0.5f, 0.5f}) > 0.39f);
  }
  CHECK(placed >= 5);
  CHECK(placed < 8);
}

}  // namespace surface_points_test
