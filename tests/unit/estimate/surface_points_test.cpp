#include "estimate/surface_points.hpp"

#include <doctest/doctest.h>

#include <limits>

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
  CHECK(rig.add(PointKind::curve, {0.5f, 0.5f}, &id, {std::numeric_limits<float>::infinity(), 0}) ==
        Status::bad_argument);
  CHECK(rig.add(PointKind::surface, {0.5f, 0.5f}, nullptr) == Status::bad_argument);
  CHECK(id == 99);
  for (std::uint16_t k = 0; k < 20; ++k) CHECK_FALSE(rig.points->has(k));
  for (const Vec2 corner : {Vec2{0, 0}, Vec2{1, 1}})
    CHECK(rig.add(PointKind::surface, corner, &id) == Status::ok);
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

TEST_CASE("points of a curve are as far apart on the surface as is asked for, the first after half of that") {
  Rig rig;
  const Vec2 line[] = {{0.1f, 0.25f}, {0.5f, 0.3f}, {0.6f, 0.15f}, {0.95f, 0.2f}};  // above the nose
  // The length of the curve at small steps, and where it is.
  std::vector<Vec2> at;
  std::vector<float> length_at;
  float all = 0;
  for (int k = 0; k < 3; ++k)
    for (int n = 0; n < 2000; ++n) {
      const Vec2 uv = line[k] + (static_cast<float>(n) / 2000) * (line[k + 1] - line[k]);
      if (!at.empty())
        all += length(rig.egg.cascade->surface_point(uv, rig.egg.state.q) -
                      rig.egg.cascade->surface_point(at.back(), rig.egg.state.q));
      at.push_back(uv);
      length_at.push_back(all);
    }
  const float spacing = all / 15;
  std::vector<std::uint16_t> ids(20);
  std::size_t count = 0;
  const std::vector<float> other(rig.egg.q.size(), 0.4f);
  rig.egg.cascade->select(other.data());  // whatever was selected before
  REQUIRE(rig.points->add_curve({line, 4}, spacing, rig.egg.cascade.object, rig.egg.state.q,
                                {ids.data(), ids.size()}, &count) == Status::ok);
  REQUIRE(count == 15);
  for (std::size_t k = 0; k < count; ++k) {
    std::size_t nearest = 0;
    for (std::size_t i = 0; i < at.size(); ++i)
      if (length(at[i] - rig.points->uv(ids[k])) < length(at[nearest] - rig.points->uv(ids[k]))) nearest = i;
    CHECK(length(at[nearest] - rig.points->uv(ids[k])) < 1e-3f);
    // In a piece, 10 mm at most, the speed along the curve changes by a tenth, of which a place between is an eighth off: 0.12 mm.
    // A piece is the chord of a curvature of 40 mm: 0.03 mm less, a fiftieth of a point's way.
    CHECK(magnitude(length_at[nearest] - spacing * (static_cast<float>(k) + 0.5f)) < 0.3f);
  }
  CHECK(rig.points->add_curve({line, 4}, spacing, rig.egg.cascade.object, rig.egg.state.q, {ids.data(), 3},
                              &count) == Status::capacity);
  CHECK(count == 3);
}

TEST_CASE("a prediction's covariance is that of the pose's unknowns, and its facing a cosine") {
  Rig rig;
  std::uint16_t id;
  REQUIRE(rig.add(PointKind::surface, {0.3f, 0.65f}, &id) == Status::ok);
  const Prediction p = rig.predict(id);
  const float* const variance = rig.expected.motion->expected().pose_variance;
  const View view = rig.egg.state.view;
  double xx = 0, xy = 0, yy = 0;
  for (int k = 0; k < kPoseUnknowns; ++k) {
    Vec2 at[2];
    const float h = k < kShiftX ? 2e-3f : 0.5f;
    for (const int side : {0, 1}) {
      float step[kPoseUnknowns] = {};
      step[k] = side == 0 ? -h : h;
      rig.egg.state.view = moved(view, step, kPoseUnknowns);
      at[side] = rig.egg.image_of({0.3f, 0.65f});
    }
    const double dx = double(at[1].x - at[0].x) / double(2 * h),
                 dy = double(at[1].y - at[0].y) / double(2 * h);
    xx += double(variance[k]) * dx * dx;
    xy += double(variance[k]) * dx * dy;
    yy += double(variance[k]) * dy * dy;
  }
  rig.egg.state.view = view;
  // Differences of images to 1e-4 px, of steps that move them by more than 0.1 px.
  CHECK(double(p.covariance.xx) == doctest::Approx(xx).epsilon(0.01));
  CHECK(double(p.covariance.yy) == doctest::Approx(yy).epsilon(0.01));
  CHECK(magnitude(p.covariance.xy - static_cast<float>(xy)) < 0.01f * static_cast<float>(xx + yy));
  const SurfaceFrame frame = rig.egg.cascade->surface_frame({0.3f, 0.65f}, rig.egg.state.q);
  const Projector projector(view, true);
  const Vec3 outward = normalised(projector.rotated(cross(frame.pv, frame.pu)));
  CHECK(p.facing ==
        doctest::Approx(double(-dot(outward, normalised(projector.to_camera(frame.p))))).epsilon(1e-3));
  Prediction flat = p;
  flat.facing = 0.29f;
  CHECK_FALSE(rig.points->is_turned_to_camera(flat));
  flat.facing = 0.31f;
  CHECK(rig.points->is_turned_to_camera(flat));
}

TEST_CASE("points on a whole contour keep their order around it, and lose their places with it") {
  Rig rig;
  std::uint16_t id[8];
  for (std::uint16_t& i : id) REQUIRE(rig.add(PointKind::silhouette, {0.5f, 0.5f}, &i) == Status::ok);
  std::vector<SilhouettePoint> contour(64);
  for (int k = 0; k < 64; ++k) {
    const Vec3 turned = rotation_matrix(exp_rotation({0, 0, 0.0981748f * float(k)})) * Vec3{1, 0, 0};
    SilhouettePoint& p = contour[static_cast<std::size_t>(k)];
    p.x = Vec2{300, 200} + Vec2{100 * turned.x, 100 * turned.y};
    p.normal = {turned.x, turned.y};
    p.uv = {0.5f + 0.4f * turned.x, 0.5f + 0.4f * turned.y};
  }
  rig.points->place_silhouette({contour.data(), 64}, rig.egg.cascade.object, rig.egg.state.q);
  for (int k = 0; k < 8; ++k) {  // two in each quarter, one after the other
    const Vec2 here = rig.predict(id[k]).normal, next = rig.predict(id[(k + 1) % 8]).normal;
    CHECK(here.x * next.y - here.y * next.x > 0.3f);
    CHECK((here.x > 0) == (k < 2 || k > 5));
    CHECK((here.y > 0) == (k < 4));
    const SurfaceFrame frame = rig.points->frame(id[k], rig.egg.cascade.object, rig.egg.state.q);
    CHECK(length(frame.pu) + length(frame.pv) == 0);
  }
  rig.points->place_silhouette({}, rig.egg.cascade.object, rig.egg.state.q);
  for (const std::uint16_t i : id) CHECK_FALSE(rig.points->is_turned_to_camera(rig.predict(i)));
  rig.points->clear(rig.egg.samples());
  CHECK(rig.points->silhouette_count() == 0);
}

TEST_CASE("a point that is sampled again is where the person has it who has changed") {
  Rig rig;
  std::uint16_t id;
  REQUIRE(rig.add(PointKind::surface, {0.4f, 0.6f}, &id) == Status::ok);
  rig.egg.q[0] = rig.egg.q[1] = 2;
  const auto off = [&] {
    return length(rig.points->frame(id, rig.egg.cascade.object, rig.egg.state.q).p -
                  rig.egg.cascade->surface_point(rig.points->uv(id), rig.egg.state.q));
  };
  CHECK(off() > 0.5f);
  rig.points->slide_to(id, {0.45f, 0.55f});
  rig.points->sample_again(id, {}, rig.egg.cascade.object, rig.egg.state.q);
  CHECK(rig.points->uv(id).x == 0.45f);
  CHECK(off() < 0.05f);
}

}  // namespace surface_points_test
