// Edge points of the estimator on curves of the model and on its silhouette, and what their observations determine.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "open_model.hpp"
#include "pliant/estimator.hpp"
#include "random.hpp"

namespace estimator_edges_test {

using namespace pliant;

namespace {

constexpr int kWidth = 640, kHeight = 480;

/// The egg with three curves across it and three down it.
ModelBuilder lined_egg() {
  ModelBuilder b = egg_model(2);
  for (int k = 0; k < 3; ++k) {
    const float at = 0.25f + 0.25f * static_cast<float>(k);
    b.curve("across" + std::to_string(k), CurveKind::lip, {{0.1f, at}, {0.35f, at}, {0.65f, at}, {0.9f, at}});
    b.curve("down" + std::to_string(k), CurveKind::lid, {{at, 0.1f}, {at, 0.5f}, {at, 0.9f}});
  }
  return b;
}

/// An ellipsoid over longitudes to 100 degrees to either side and latitudes to 80.
ModelBuilder ellipsoid() {
  ModelBuilder b;
  const auto at = [](float u, float v) {
    const double a = 3.5 * (double(u) - 0.5), c = 2.8 * (0.5 - double(v));
    return Vec3{float(70 * std::sin(a) * std::cos(c)), float(90 * std::sin(c)),
                float(60 * std::cos(a) * std::cos(c))};
  };
  b.record(Operation::constant, {}, {}, b.field(3, 129, 129, at));
  const std::uint16_t q = b.parameter("swell", Group::expression, -0.5f, 0.5f, 0.2f);
  b.record(Operation::scale, {b.last()}, {q});
  b.grid_mesh(12);
  b.landmark("middle", 0.5f, 0.5f);
  return b;
}

struct Scene : OpenModel {
  EstimatorLimits limits;
  Camera camera = centred_camera(kWidth, kHeight, 800);
  std::vector<float> q;
  std::vector<std::uint16_t> ids;

  explicit Scene(const ModelBuilder& builder) : OpenModel(builder) {
    q.assign(model.parameters().count, 0);
    limits.points = 150;
    limits.vertices = 500;
    limits.silhouette_points = 32;
  }
  static Pose pose(float turn, Vec2 shift = {}) {
    return {exp_rotation({0.3f * turn, turn, 0.2f * turn}), {shift.x, 5 + shift.y, 700}};
  }
  void start(Estimator& e, const Pose& at) {
    REQUIRE(e.start(camera, kWidth, kHeight, at, q.data(), nullptr, {}) == Status::ok);
  }
  void add_curves(Estimator& e, const std::string& prefix, float spacing_mm) {
    for (std::size_t c = 0; c < model.curves().count; ++c) {
      if (std::string(model.curves()[c].name).rfind(prefix, 0) != 0) continue;
      std::uint16_t id[60];
      std::size_t n = 0;
      REQUIRE(e.add_curve(c, spacing_mm, {id, 60}, &n) == Status::ok);
      ids.insert(ids.end(), id, id + n);
    }
  }
  Vec2 image_at(const Pose& at, Vec2 uv) {
    InArena<Cascade> cascade(model);
    Vec2 x;
    REQUIRE(Projector(view_of(at, camera), true).project(cascade->surface_point(uv, q.data()), &x));
    return x;
  }
  /// The edges through the points as they lie at a pose; each is found anywhere along its tangent, up to `slide` px.
  std::vector<Observation> edges_at(Estimator& e, const Pose& at, float slide) {
    InArena<Estimator> truth(model, limits);
    start(truth.object, at);
    Random random(3);
    std::vector<Observation> out;
    for (std::uint16_t id : ids) {
      std::uint16_t copy;
      // The direction follows from the model: a curve's point and its neighbour a little further on.
      const Vec2 uv = e.point_uv(id), along = direction(uv);
      REQUIRE(truth->add_edge_point(uv, along, &copy) == Status::ok);
      const Prediction p = truth->predict(copy);
      Observation o;
      o.id = id;
      o.cue = Cue::edge;
      o.x = p.x + random.uniform(-slide, slide) * Vec2{-p.normal.y, p.normal.x};
      const Vec2 n = 5.0f * p.normal;
      o.information = {n.x * n.x, n.x * n.y, n.y * n.y};
      out.push_back(o);
    }
    return out;
  }
  /// Direction of the curve through uv: each curve has one constant coordinate.
  static Vec2 direction(Vec2 uv) {
    const float across = magnitude(4 * uv.y - static_cast<float>(static_cast<int>(4 * uv.y + 0.5f)));
    return across < 1e-3f ? Vec2{1, 0} : Vec2{0, 1};
  }
};

/// The direction that an information of rank one measures along.
Vec2 normalised_rank_one(Sym2 w) {
  const Vec2 n = w.xx > w.yy ? Vec2{w.xx, w.xy} : Vec2{w.xy, w.yy};
  return (1 / length(n)) * n;
}

Span<Observation> span(std::vector<Observation>& o) {
  return {o.data(), o.size()};
}

}  // namespace

TEST_CASE("an edge point's normal is perpendicular to its curve in the image, and stays on its side") {
  Scene scene(lined_egg());
  InArena<Estimator> e(scene.model, scene.limits);
  for (float turn : {0.0f, 0.35f}) {
    scene.start(e.object, Scene::pose(turn));
    for (Vec2 along : {Vec2{1, 0}, Vec2{0.3f, 0.8f}, Vec2{-2, 0.5f}}) {
      std::uint16_t id;
      const Vec2 uv{0.45f, 0.3f};
      REQUIRE(e->add_edge_point(uv, along, &id) == Status::ok);
      const Prediction p = e->predict(id);
      Vec2 a, b;
      REQUIRE(e->project(uv - 2e-3f * along, &a));
      REQUIRE(e->project(uv + 2e-3f * along, &b));
      const Vec2 t = (1 / length(b - a)) * (b - a);
      CHECK(length(p.normal) == doctest::Approx(1));
      CHECK(magnitude(dot(p.normal, t)) < 0.06f);
      CHECK(t.x * p.normal.y - t.y * p.normal.x > 0.9f);  // clockwise on the screen, where y is down
      CHECK(p.visible);
    }
  }
  std::uint16_t id;
  REQUIRE(e->add_point({0.4f, 0.5f}, &id) == Status::ok);
  CHECK(length(e->predict(id).normal) == 0);
}

TEST_CASE("points of a curve are as far apart on the surface as asked; full lists return capacity") {
  Scene scene(lined_egg());
  InArena<Estimator> e(scene.model, scene.limits);
  scene.start(e.object, Scene::pose(0));
  scene.add_curves(e.object, "down1", 10);
  REQUIRE(scene.ids.size() > 12);
  InArena<Cascade> cascade(scene.model);
  for (std::size_t k = 1; k < scene.ids.size(); ++k) {
    const Vec2 a = e->point_uv(scene.ids[k - 1]), b = e->point_uv(scene.ids[k]);
    CHECK(a.x == doctest::Approx(0.5));
    CHECK(b.y > a.y);
    const float apart =
        length(cascade->surface_point(b, scene.q.data()) - cascade->surface_point(a, scene.q.data()));
    CHECK(apart > 8.5f);
    CHECK(apart < 13);
  }
  std::uint16_t ids[200];
  std::size_t n = 99;
  CHECK(e->add_curve(0, 10, {ids, 3}, &n) == Status::capacity);
  CHECK(n == 3);
  CHECK(e->add_curve(0, 0.5f, {ids, 200}, &n) == Status::capacity);  // the estimator is full
  CHECK(e->has_point(ids[n - 1]));
  CHECK(e->add_curve(6, 10, {ids, 3}, &n) == Status::bad_argument);
  CHECK(e->add_curve(0, 0, {ids, 3}, &n) == Status::bad_argument);
  CHECK(e->add_edge_point({0.5f, 0.5f}, {0, 0}, ids) == Status::bad_argument);
  InArena<Estimator> fresh(scene.model, scene.limits);
  CHECK(fresh->add_edge_point({0.5f, 0.5f}, {1, 0}, ids) == Status::not_started);
  CHECK(fresh->add_curve(0, 5, {ids, 3}, &n) == Status::not_started);
  CHECK(fresh->add_silhouette_point(ids) == Status::not_started);
}

TEST_CASE("edges alone give the pose, wherever along its tangent each was found") {
  Scene scene(lined_egg());
  InArena<Estimator> e(scene.model, scene.limits);
  scene.start(e.object, Scene::pose(0.1f));
  scene.add_curves(e.object, "", 11);
  const Pose there = Scene::pose(0.13f, {2, -1});
  e->begin(33'000'000);
  std::vector<Observation> seen = scene.edges_at(e.object, there, 6);
  e->solve(span(seen));
  const FrameResult result = e->end();
  CHECK(result.state == TrackState::tracking);
  CHECK(length(log_rotation(e->view().q * conjugate(normalised(there.q)))) < 0.01f);
  for (Vec2 uv : {Vec2{0.3f, 0.3f}, Vec2{0.7f, 0.4f}, Vec2{0.5f, 0.8f}}) {
    Vec2 x;
    REQUIRE(e->project(uv, &x));
    CHECK(length(x - scene.image_at(there, uv)) < 1.0f);
  }
}

TEST_CASE(
    "edges do not determine motion along themselves: with vertical curves the height stays as predicted") {
  Scene scene(lined_egg());
  InArena<Estimator> e(scene.model, scene.limits);
  scene.start(e.object, Scene::pose(0));
  scene.add_curves(e.object, "down1", 8);  // a straight line in the image
  const Pose there = Scene::pose(0, {3, 4});
  e->begin(33'000'000);
  std::vector<Observation> seen = scene.edges_at(e.object, there, 0);
  e->solve(span(seen));
  CHECK(e->view().tau.x == doctest::Approx(3).epsilon(0.15));
  CHECK(magnitude(e->view().tau.y - 5) < 0.3f);
}

TEST_CASE("of alternatives the one that fits is taken, whichever stands first") {
  Scene scene(lined_egg());
  InArena<Estimator> e(scene.model, scene.limits);
  scene.start(e.object, Scene::pose(0.1f));
  scene.add_curves(e.object, "", 11);
  const Pose there = Scene::pose(0.13f, {2, -1});
  e->begin(33'000'000);
  const std::vector<Observation> right = scene.edges_at(e.object, there, 3);
  std::vector<Observation> seen;
  Random random(8);
  for (const Observation& o : right) {  // a second edge beside it, now on this, now on that side
    Observation wrong = o;
    const Sym2 w = o.information;
    const Vec2 n = normalised_rank_one(w);
    wrong.x = o.x + (random.uniform(0, 1) < 0.5f ? -9.0f : 9.0f) * n;
    const bool first = random.uniform(0, 1) < 0.5f;
    seen.push_back(first ? wrong : o);
    seen.push_back(first ? o : wrong);
  }
  e->solve(span(seen));
  const FrameResult result = e->end();
  CHECK(result.state == TrackState::tracking);
  CHECK(result.tracked == right.size());  // rows, not observations
  CHECK(length(log_rotation(e->view().q * conjugate(normalised(there.q)))) < 0.01f);
  std::size_t correct = 0, found = 0;
  for (std::size_t k = 0; k < seen.size(); ++k) {
    if (seen[k].reason != Reason::found) continue;
    ++found;
    correct += length(seen[k].x - right[k / 2].x) == 0;
  }
  CHECK(found <= right.size());
  CHECK(correct > right.size() * 9 / 10);
  CHECK(correct == found);
}

TEST_CASE("a cue that is switched off takes no part, and a noisy one loses weight as its residuals show") {
  Scene scene(lined_egg());
  EstimatorOptions options;
  options.cues = 1u << static_cast<unsigned>(Cue::patch);
  InArena<Estimator> e(scene.model, scene.limits);
  const auto patches_at = [&](const Pose& pose, float noise, std::vector<Observation>* out) {
    Random random(4);
    for (std::uint16_t id = 0; id < 36; ++id) {
      Observation o;
      o.id = id;
      o.x = scene.image_at(pose, e->point_uv(id)) + Vec2{noise * random.normal(), noise * random.normal()};
      o.information = {4, 0, 4};
      out->push_back(o);
    }
  };
  const auto start = [&] {
    REQUIRE(e->start(scene.camera, kWidth, kHeight, Scene::pose(0), scene.q.data(), nullptr, options) ==
            Status::ok);
    scene.ids.clear();
    for (int k = 0; k < 36; ++k) {
      std::uint16_t id;
      REQUIRE(e->add_point({0.2f + 0.12f * float(k % 6), 0.2f + 0.12f * float(k / 6)}, &id) == Status::ok);
    }
    scene.add_curves(e.object, "", 11);
  };
  start();
  e->begin(33'000'000);
  std::vector<Observation> seen;
  patches_at(Scene::pose(0), 0.2f, &seen);
  const std::vector<Observation> elsewhere = scene.edges_at(e.object, Scene::pose(0, {12, 0}), 0);
  seen.insert(seen.end(), elsewhere.begin(), elsewhere.end());
  e->solve(span(seen));
  CHECK(e->end().tracked == 36);
  CHECK(magnitude(e->view().tau.x) < 0.3f);
  for (std::size_t k = 36; k < seen.size(); ++k) CHECK(seen[k].reason == Reason::rejected);

  // Correct edges, and patches whose noise is far above their standard deviation.
  options.cues = 0x0f;
  for (bool learns : {false, true}) {
    options.cue_scale_rate = learns ? 0.5f : 0.0f;
    start();
    for (int frame = 1; frame < 8; ++frame) {
      e->begin(frame * std::int64_t{33'000'000});
      seen.clear();
      patches_at(Scene::pose(0), 4, &seen);
      e->solve(span(seen));
      REQUIRE(e->end().state == TrackState::tracking);
    }
    CHECK(e->cue_scale(Cue::edge) == 1);
    if (learns)
      CHECK(e->cue_scale(Cue::patch) > 2);
    else
      CHECK(e->cue_scale(Cue::patch) == 1);
  }
}

TEST_CASE("silhouette points lie where the surface turns away, each in its sector, with normals outwards") {
  Scene scene(ellipsoid());
  InArena<Estimator> e(scene.model, scene.limits);
  scene.start(e.object, Scene::pose(0));
  std::vector<std::uint16_t> ids(16);
  for (std::uint16_t& id : ids) REQUIRE(e->add_silhouette_point(&id) == Status::ok);
  Vec2 before[16] = {};
  for (int frame = 1; frame <= 4; ++frame) {
    State turned;
    turned.pose = Scene::pose(0.02f * static_cast<float>(frame));
    turned.q = scene.q.data();
    REQUIRE(e->restore(turned) == Status::ok);
    int visible = 0;
    const Pose pose = pose_of(e->view());
    for (std::size_t k = 0; k < ids.size(); ++k) {
      const Prediction p = e->predict(ids[k]);
      if (!p.visible) continue;
      ++visible;
      CHECK(length(p.normal) == doctest::Approx(1).epsilon(1e-4));
      // The ellipsoid's own normal there, perpendicular to the viewing ray.
      const Vec2 uv = e->point_uv(ids[k]);
      const double a = 3.5 * (double(uv.x) - 0.5), c = 2.8 * (0.5 - double(uv.y));
      const Vec3 n{float(std::sin(a) * std::cos(c) / 70), float(std::sin(c) / 90),
                   float(std::cos(a) * std::cos(c) / 60)};
      const Mat3 turn = rotation_matrix(pose.q);
      const Vec3 at{float(70 * std::sin(a) * std::cos(c)), float(90 * std::sin(c)),
                    float(60 * std::cos(a) * std::cos(c))};
      const Vec3 ray = turn * Vec3{at.x, -at.y, -at.z} + pose.t;
      const Vec3 out = turn * normalised(Vec3{n.x, -n.y, -n.z});
      CHECK(magnitude(dot(out, normalised(ray))) < 0.12f);
      CHECK(dot(Vec2{out.x, out.y}, p.normal) > 0.97f);
      if (frame > 1 && length(before[k]) > 0) CHECK(length(p.x - before[k]) < 25);
      before[k] = p.x;
    }
    CHECK(visible >= 14);
  }
  std::uint16_t id;
  for (int k = 16; k < 32; ++k) REQUIRE(e->add_silhouette_point(&id) == Status::ok);
  CHECK(e->add_silhouette_point(&id) == Status::capacity);
  e->remove_point(id);
  CHECK(e->add_silhouette_point(&id) == Status::ok);
}

TEST_CASE("a state that was saved is restored; one that is not finite changes nothing") {
  Scene scene(lined_egg());
  InArena<Estimator> e(scene.model, scene.limits);
  scene.q[4] = 0.2f;
  scene.start(e.object, Scene::pose(0.1f));
  scene.add_curves(e.object, "", 11);
  e->begin(33'000'000);
  std::vector<Observation> seen = scene.edges_at(e.object, Scene::pose(0.12f), 0);
  e->solve(span(seen));
  e->end();
  std::vector<float> q(scene.q.size()), sd(scene.q.size());
  State state;
  state.q = q.data();
  state.sd = sd.data();
  e->save(&state);
  CHECK(q[4] == e->parameters()[4]);
  CHECK(sd[0] == 0);
  CHECK(sd[4] > 0);
  CHECK((state.pose_sd[kTurnY] > 0 && state.pose_sd[kTurnY] < 0.05f));
  const View there = e->view();
  e->begin(66'000'000);
  e->translate({40, 30});
  REQUIRE(e->restore(state) == Status::ok);
  CHECK(e->view().tau.x == doctest::Approx(double(there.tau.x)));
  CHECK(e->view().s == doctest::Approx(double(there.s)));
  State bad = state;
  bad.pose.t.x = std::numeric_limits<float>::quiet_NaN();
  CHECK(e->restore(bad) == Status::bad_argument);
  bad = state;
  bad.pose.t.x = 3e38f;  // finite, and nowhere near a picture
  CHECK(e->restore(bad) == Status::bad_argument);
  bad = state;
  bad.q = nullptr;
  CHECK(e->restore(bad) == Status::bad_argument);
  q[3] = std::numeric_limits<float>::infinity();
  CHECK(e->restore(state) == Status::bad_argument);
  CHECK(e->view().tau.x == doctest::Approx(double(there.tau.x)));
}

TEST_CASE(
    "a state that the platform has measured takes the place of a bad frame's, and bad frames are counted "
    "anew") {
  Scene scene(lined_egg());
  InArena<Estimator> e(scene.model, scene.limits);
  EstimatorOptions options;
  options.smooths = true;
  const Pose before = Scene::pose(0.1f), now = Scene::pose(0.3f);
  REQUIRE(e->start(scene.camera, kWidth, kHeight, before, scene.q.data(), nullptr, options) == Status::ok);
  std::int64_t time = 0;
  const auto bad_frame = [&] {
    e->begin(time += 33'000'000);
    return e->end();
  };
  bad_frame();
  FrameResult result = bad_frame();
  REQUIRE(result.state == TrackState::degraded);
  std::vector<float> q = scene.q;
  q[0] = 1;     // not free
  q[4] = 0.2f;  // free
  State measured;
  measured.pose = now;
  measured.q = q.data();
  State bad = measured;
  bad.pose.t.z = -1;
  CHECK(e->accept(bad, &result) == Status::bad_argument);
  CHECK(result.state == TrackState::degraded);
  REQUIRE(e->accept(measured, &result) == Status::ok);
  CHECK(result.state == TrackState::tracking);
  CHECK(result.pose.q.y == doctest::Approx(double(now.q.y)));
  CHECK(result.smoothed_pose.q.y > before.q.y + 0.2f * (now.q.y - before.q.y));
  for (int k = 0; k < 2; ++k) {
    result = bad_frame();
    CHECK(result.state == TrackState::degraded);
    CHECK(result.pose.q.y == doctest::Approx(double(now.q.y)));
  }
  CHECK(bad_frame().state == TrackState::lost);
  CHECK(e->parameters()[0] == scene.q[0]);
  CHECK(e->parameters()[4] == 0.2f);
}

}  // namespace estimator_edges_test
