#include "pliant/estimator.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "estimator_scene.hpp"

namespace estimator_test {
using namespace estimator_scene;

TEST_CASE("pose and expressions are tracked through a motion, the identity stays") {
  Scene scene;
  InArena<Estimator> e(scene.model, scene.limits);
  scene.start(e.object, 0);
  std::vector<float> truth = scene.q;
  for (int frame = 1; frame <= 40; ++frame) {
    const float turn = 0.01f * static_cast<float>(frame);
    truth[5] = 0.4f * static_cast<float>(frame % 20) / 20;  // jawOpen
    truth[3] = 0.5f;                                        // bumpLeft jumps at once
    e->begin(frame * std::int64_t{40'000'000});
    auto seen = scene.observe(turn, truth, 0.1f);
    e->solve(span(seen));
    const FrameResult result = e->end();
    CHECK(result.state == TrackState::tracking);
    CHECK(result.inliers > 40);
    CHECK(turn_error(e.object, turn) < 0.02f);
    if (frame > 2) CHECK(e->parameters()[5] == doctest::Approx(double(truth[5])).epsilon(0.05).scale(1));
    CHECK(e->parameters()[0] == 0.8f);
  }
  CHECK(e->parameters()[3] == doctest::Approx(0.5).epsilon(0.1).scale(1));
}

TEST_CASE("a third of wild observations is rejected and named") {
  Scene scene;
  InArena<Estimator> e(scene.model, scene.limits);
  scene.start(e.object, 0.1f);
  e->begin(1);
  auto seen = scene.observe(0.13f, scene.q, 0.1f);
  for (std::size_t i = 0; i < seen.size(); i += 3) seen[i].x = seen[i].x + Vec2{30, -25};
  e->solve(span(seen));
  CHECK(e->end().state == TrackState::tracking);
  CHECK(turn_error(e.object, 0.13f) < 0.02f);
  for (std::size_t i = 0; i < seen.size(); ++i)
    CHECK(seen[i].reason == (i % 3 == 0 ? Reason::rejected : Reason::found));
}

TEST_CASE(
    "a prediction is the projection of its point, and its Jacobian is that of the image along u and v") {
  Scene scene;
  InArena<Estimator> e(scene.model, scene.limits);
  scene.start(e.object, 0.2f);
  for (const Prediction& p : e->predict()) {
    Vec2 x;
    const Vec2 uv = e->point_uv(p.id);
    REQUIRE(e->project(uv, &x));
    CHECK(length(x - p.x) < 1e-3f);
    const float h = 2e-3f;
    Vec2 a, b, c, d;
    REQUIRE(e->project({uv.x - h, uv.y}, &a));
    REQUIRE(e->project({uv.x + h, uv.y}, &b));
    REQUIRE(e->project({uv.x, uv.y - h}, &c));
    REQUIRE(e->project({uv.x, uv.y + h}, &d));
    CHECK(length((0.5f / h) * (b - a) - Vec2{p.jacobian.a, p.jacobian.c}) < 12);  // of about 170 px
    CHECK(length((0.5f / h) * (d - c) - Vec2{p.jacobian.b, p.jacobian.d}) < 12);
    CHECK(p.visible);
    CHECK(p.covariance.xx > 0);
  }
}

TEST_CASE("a point that is turned away from the camera or outside the picture is not visible") {
  Scene scene;
  InArena<Estimator> e(scene.model, scene.limits);
  scene.start(e.object, 0);
  // A strong turn: the right side of the surface turns away.
  REQUIRE(e->start(scene.camera, kWidth, kHeight, {exp_rotation({0, 1.2f, 0}), {0, 0, 700}}, scene.q.data(),
                   nullptr, {}) == Status::ok);
  std::uint16_t near_side, far_side;
  REQUIRE(e->add_point({0.95f, 0.5f}, &near_side) == Status::ok);
  REQUIRE(e->add_point({0.05f, 0.5f}, &far_side) == Status::ok);
  const Prediction a = e->predict(near_side), b = e->predict(far_side);
  CHECK(a.visible != b.visible);
  CHECK(a.facing * b.facing < 0);
  REQUIRE(e->start(scene.camera, kWidth, kHeight, {{}, {400, 0, 700}}, scene.q.data(), nullptr, {}) ==
          Status::ok);
  REQUIRE(e->add_point({0.5f, 0.5f}, &near_side) == Status::ok);
  CHECK_FALSE(e->predict(near_side).visible);
  // So near that the nose, 62 mm in front of the model's origin, is behind the camera.
  REQUIRE(e->start(scene.camera, kWidth, kHeight, {{}, {0, 0, 60}}, scene.q.data(), nullptr, {}) ==
          Status::ok);
  Vec2 x;
  CHECK_FALSE(e->project({0.5f, 0.45f}, &x));
  CHECK(e->project({0.02f, 0.02f}, &x));
}

TEST_CASE("surface_at gives back the point that was projected, and the nearest one beside the surface") {
  Scene scene;
  InArena<Estimator> e(scene.model, scene.limits);
  scene.start(e.object, 0.25f);
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    const Vec2 uv{random.uniform(0.1f, 0.9f), random.uniform(0.1f, 0.9f)};
    Vec2 x, back, again;
    REQUIRE(e->project(uv, &x));
    REQUIRE(e->surface_at(x, &back) == 0);
    REQUIRE(e->project(back, &again));
    CHECK(length(again - x) < 0.05f);
    CHECK(length(back - uv) < 0.01f);
  }
  Vec2 uv;
  CHECK(e->surface_at({5, 5}, &uv) > 50);
  CHECK(e->surface_at({-1e6f, 200}, &uv) > 1e5f);
}

TEST_CASE(
    "without observations the state is degraded, then lost, and nothing is claimed; with them it comes "
    "back") {
  Scene scene;
  InArena<Estimator> e(scene.model, scene.limits);
  scene.start(e.object, 0.1f);
  const Quat before = e->view().q;
  TrackState expected[5] = {TrackState::degraded, TrackState::degraded, TrackState::lost, TrackState::lost,
                            TrackState::lost};
  std::vector<Observation> none;
  for (int frame = 0; frame < 5; ++frame) {
    e->begin(frame * std::int64_t{40'000'000});
    e->solve(span(none));
    CHECK(e->end().state == expected[frame]);
  }
  CHECK(e->view().q.y == before.y);
  e->begin(1'000'000'000);
  auto seen = scene.observe(0.12f, scene.q, 0.1f);
  e->solve(span(seen));
  CHECK(e->end().state == TrackState::tracking);
  CHECK(turn_error(e.object, 0.12f) < 0.02f);
}

TEST_CASE("contradictory observations do not pass for tracking") {
  Scene scene;
  InArena<Estimator> e(scene.model, scene.limits);
  scene.start(e.object, 0.1f);
  e->begin(1);
  auto seen = scene.observe(0.1f, scene.q, 0);
  for (Observation& o : seen) o.x = {scene.random.uniform(0, 640), scene.random.uniform(0, 480)};
  e->solve(span(seen));
  CHECK(e->end().state != TrackState::tracking);
  CHECK(turn_error(e.object, 0.1f) < 1e-3f);
}

TEST_CASE("calls before a start, bad starts and full capacities return their status") {
  Scene scene;
  InArena<Estimator> e(scene.model, scene.limits);
  std::uint16_t id = 0;
  CHECK(e->add_point({0.5f, 0.5f}, &id) == Status::not_started);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<float> q = scene.q;
  const auto start = [&](Camera c, int w, Pose p, const float* values) {
    return e->start(c, w, kHeight, p, values, nullptr, {});
  };
  CHECK(start(scene.camera, 0, Scene::pose(0), q.data()) == Status::bad_argument);
  CHECK(start({0, 1, 1}, kWidth, Scene::pose(0), q.data()) == Status::bad_argument);
  CHECK(start(scene.camera, kWidth, {{}, {0, 0, nan}}, q.data()) == Status::bad_argument);
  CHECK(start(scene.camera, kWidth, {{}, {0, 0, -5}}, q.data()) == Status::bad_argument);
  CHECK(start(scene.camera, kWidth, Scene::pose(0), nullptr) == Status::bad_argument);
  q[2] = nan;
  CHECK(start(scene.camera, kWidth, Scene::pose(0), q.data()) == Status::bad_argument);
  CHECK_FALSE(e->is_started());
  scene.start(e.object, 0);
  CHECK(e->add_point({1.5f, 0.5f}, &id) == Status::bad_argument);
  for (std::size_t i = scene.uv.size(); i < scene.limits.points; ++i)
    CHECK(e->add_point({0.5f, 0.5f}, &id) == Status::ok);
  CHECK(e->add_point({0.5f, 0.5f}, &id) == Status::capacity);
  e->remove_point(17);
  REQUIRE(e->add_point({0.5f, 0.5f}, &id) == Status::ok);
  CHECK(id == 17);
}

TEST_CASE(
    "with vertices read from the tables and the least capacities, tracking gives the same result in less "
    "memory") {
  Scene scene;
  InArena<Estimator> full(scene.model, scene.limits);
  scene.limits.samples_vertices = false;
  scene.limits.free_parameters = 1;
  InArena<Estimator> none(scene.model, scene.limits);
  CHECK(none->start(scene.camera, kWidth, kHeight, Scene::pose(0), scene.q.data(), nullptr, {}) ==
        Status::capacity);
  InArena<Cascade> cascade(scene.model);
  cascade->set_free(Group::expression);
  scene.limits.free_parameters = static_cast<std::uint16_t>(cascade->column_count());
  scene.limits.samples_per_point = static_cast<std::uint16_t>(cascade->samples_per_point());
  InArena<Estimator> small(scene.model, scene.limits);
  CHECK(small.arena.used_bytes() < full.arena.used_bytes());
  for (Estimator* e : {&full.object, &small.object}) {
    scene.random = Random{5};
    scene.start(*e, 0);
    for (int k = 1; k < 4; ++k) {
      auto seen = scene.observe(0.03f * static_cast<float>(k), scene.q, 0.2f);
      e->begin(k * std::int64_t{33'000'000});
      e->predict();
      e->solve(span(seen));
      CHECK(e->end().state == TrackState::tracking);
    }
    e->refresh_vertices();
  }
  CHECK(full->view().q.y == small->view().q.y);
  float most = 0;
  for (VertexId v : full->mesh().vertices())
    most = max(most, length(full->vertex_positions()[v] - small->vertex_positions()[v]));
  CHECK(most < 1e-3f);
}

TEST_CASE("limits without a table of rejection give the same memory and bits as a sample of 0") {
  float turn[2] = {};
  std::size_t bytes[2] = {};
  for (int named = 0; named < 2; ++named) {
    Scene scene;
    const std::size_t with_room = measured_bytes<Estimator>(scene.model, scene.limits);
    scene.limits.rejection_sample = 0;
    if (!named) scene.limits = without_rejection(scene.limits);
    InArena<Estimator> e(scene.model, scene.limits);
    bytes[named] = e.arena.used_bytes();
    CHECK(bytes[named] < with_room);
    EstimatorOptions options;
    options.rejection = Rejection::forces_readmitted;
    scene.start(e.object, 0, options);
    for (int frame = 1; frame < 4; ++frame) {
      e->begin(frame * std::int64_t{33'000'000});
      auto seen = scene.observe(0.02f * static_cast<float>(frame), scene.q, 0.3f);
      e->solve(span(seen));
      CHECK(e->end().state == TrackState::tracking);
    }
    turn[named] = e->view().q.y;
  }
  CHECK(bytes[0] == bytes[1]);
  CHECK(turn[0] == turn[1]);
}

TEST_CASE("two runs give the same bits") {
  Scene scene;
  float turn[2] = {};
  for (float& t : turn) {
    Scene fresh;
    InArena<Estimator> e(fresh.model, fresh.limits);
    fresh.start(e.object, 0);
    for (int frame = 1; frame < 6; ++frame) {
      e->begin(frame * std::int64_t{33'000'000});
      auto seen = fresh.observe(0.02f * static_cast<float>(frame), fresh.q, 0.3f);
      e->solve(span(seen));
      e->end();
    }
    t = e->view().q.y;
  }
  CHECK(turn[0] == turn[1]);
}

TEST_CASE("time that repeats, jumps or runs backwards: the state stays sound, with and without prediction") {
  for (bool predicts : {false, true}) {
    Scene scene;
    InArena<Estimator> e(scene.model, scene.limits);
    EstimatorOptions options;
    options.predicts_motion = predicts;
    options.smooths = true;
    scene.start(e.object, 0, options);
    const std::int64_t ms[] = {40, 80, 120, 120, 120, 160, 5000, 5040, 40, 80, 81, 120, 3000000};
    float turn = 0;
    std::int64_t before = 0;
    for (std::int64_t t : ms) {
      if (t - before >= 40 && t - before < 1000) turn += 0.012f;
      before = t;
      e->begin(t * 1'000'000);
      auto seen = scene.observe(turn, scene.q, 0.1f);
      e->solve(span(seen));
      const FrameResult result = e->end();
      CHECK(result.state == TrackState::tracking);
      CHECK(turn_error(e.object, turn) < 0.01f);
      CHECK(is_finite(result.smoothed_pose));
      CHECK(length(log_rotation(result.smoothed_pose.q * conjugate(result.pose.q))) < 0.03f);
      CHECK(e->smoothed_parameters().count == scene.q.size());
    }
    e->begin(std::numeric_limits<std::int64_t>::min());
    e->begin(std::numeric_limits<std::int64_t>::max());
    CHECK(is_finite(pose_of(e->view())));
  }
}

TEST_CASE("the covariance of predictions grows with time since the last frame and with frames lost") {
  Scene scene;
  InArena<Estimator> e(scene.model, scene.limits);
  scene.start(e.object, 0);
  std::int64_t t = 0;
  const auto frame = [&](std::int64_t step) {
    t += step;
    e->begin(t);
    const float variance = e->predict(scene.ids[24]).covariance.xx;
    auto seen = scene.observe(0, scene.q, 0.1f);
    e->solve(span(seen));
    e->end();
    return variance;
  };
  for (int k = 0; k < 20; ++k) frame(33'000'000);
  const float usual = frame(33'000'000), late = frame(200'000'000);
  CHECK(late > 4 * usual);
  for (int k = 0; k < 10; ++k) frame(33'000'000);
  t += 33'000'000;
  e->begin(t);
  std::vector<Observation> none;
  e->solve(span(none));
  CHECK(e->end().state == TrackState::degraded);
  CHECK(frame(33'000'000) > 3 * usual);
}

TEST_CASE(
    "a frame with few patches, low correlation, or edges that do not determine the pose is not tracked") {
  Scene scene;
  const auto state_of = [&](auto change) {
    InArena<Estimator> e(scene.model, scene.limits);
    scene.start(e.object, 0.1f);
    e->begin(33'000'000);
    auto seen = scene.observe(0.1f, scene.q, 0.1f);
    for (std::size_t i = 0; i < seen.size(); ++i) change(i, seen[i]);
    e->solve(span(seen));
    return e->end();
  };
  CHECK(state_of([](std::size_t, Observation&) {}).state == TrackState::tracking);
  // Most points are tracked from frame to frame only, and no template is found: an occluder would cause that.
  CHECK(state_of([](std::size_t i, Observation& o) {
          if (i < 30)
            o.cue = Cue::flow;
          else
            o.reason = Reason::low_correlation;
        }).state == TrackState::degraded);
  CHECK(state_of([](std::size_t, Observation& o) { o.score = 0.3f; }).state == TrackState::degraded);
  CHECK(state_of([](std::size_t, Observation& o) { o.score = 0.9f; }).score == doctest::Approx(0.9));
  const FrameResult open = state_of([](std::size_t, Observation& o) { o.information = {25, 0, 0}; });
  CHECK_FALSE(open.pose_is_observed);
  CHECK(open.state == TrackState::degraded);
}

TEST_CASE("a mesh that follows the view keeps its budget and does not change the result") {
  Scene scenes[2];
  EstimatorOptions options;
  InArena<Estimator> still(scenes[0].model, scenes[0].limits), adapts(scenes[1].model, scenes[1].limits);
  scenes[0].start(still.object, 0, options);
  options.mesh_operations = 12;
  options.vertex_budget = 180;
  options.mesh_error_px = 0.1f;
  options.texture.score = [](void*, Vec2 uv) { return 0.5f * uv.x; };
  options.texture.shortest_edge_mm = 4;
  scenes[1].start(adapts.object, 0, options);
  const auto places_of = [&adapts] {
    std::vector<float> places;
    for (VertexId v : adapts->mesh().vertices())
      places.insert(places.end(), {adapts->mesh().uv(v).x, adapts->mesh().uv(v).y});
    return places;
  };
  int changes = 0;
  std::vector<float> places = places_of();
  for (int frame = 1; frame <= 30; ++frame) {
    const float turn = 0.02f * static_cast<float>(frame);
    for (int k = 0; k < 2; ++k) {
      Estimator& e = k == 0 ? still.object : adapts.object;
      std::vector<float> truth = scenes[k].q;
      truth[5] = 0.01f * static_cast<float>(frame);
      e.begin(frame * std::int64_t{33'000'000});
      auto seen = scenes[k].observe(turn, truth, 0.1f);
      e.solve(span(seen));
      CHECK(e.end().state == TrackState::tracking);
    }
    for (const Vec2 uv : scenes[0].uv) {
      Vec2 a, b;
      REQUIRE(still->project(uv, &a));
      REQUIRE(adapts->project(uv, &b));
      CHECK(length(a - b) < 0.01f);
    }
    CHECK(adapts->mesh().vertex_count() <= 180);
    changes += places_of() != places;
    places = places_of();
  }
  CHECK(adapts->mesh().validate().invariant == 0);
  InArena<Cascade> cascade(scenes[1].model);
  adapts->refresh_vertices();
  for (VertexId v : adapts->mesh().vertices())
    CHECK(length(adapts->vertex_positions()[v] -
                 cascade->surface_point(adapts->mesh().uv(v), adapts->parameters().data)) < 0.01f);
  CHECK(changes > 3);
}

TEST_CASE("a personalised model is tracked to the same state, and costs the memory of its field") {
  Scene scene;
  scene.q[0] = 1.2f;
  Vec3 truth[2];
  std::size_t bytes[2];
  for (int personalised = 0; personalised < 2; ++personalised) {
    EstimatorLimits limits = scene.limits;
    if (personalised) limits.personal_field = {64, 64};
    bytes[personalised] = measured_bytes<Estimator>(scene.model, limits);
    InArena<Estimator> e(scene.model, limits);
    scene.random = Random{11};
    scene.start(e.object, 0);
    e->begin(33'000'000);
    auto observations = scene.observe(0.05f, scene.q, 0.1f);
    e->predict();
    e->solve({observations.data(), observations.size()});
    CHECK(e->end().state == TrackState::tracking);
    truth[personalised] = e->vertex_positions()[5];
    CHECK(length(log_rotation(e->view().q * conjugate(Scene::pose(0.05f).q))) < 0.005f);
  }
  CHECK(length(truth[1] - truth[0]) < 0.2f);
  CHECK(bytes[1] >= bytes[0] + 64 * 64 * 6);
}

TEST_CASE("an observation whose information would overflow is not used, and harms no other") {
  Scene scene;
  InArena<Estimator> e(scene.model, scene.limits);
  scene.start(e.object, 0.1f);
  e->begin(1);
  auto seen = scene.observe(0.13f, scene.q, 0.1f);
  seen[0].information = {1e20f, 0, 1e20f};
  seen[1].information = {1, 1e20f, 1};
  e->solve(span(seen));
  CHECK(e->end().state == TrackState::tracking);
  CHECK(turn_error(e.object, 0.13f) < 0.02f);
  CHECK(seen[0].reason == Reason::not_visible);
  CHECK(seen[1].reason == Reason::not_visible);
  CHECK(seen[2].reason == Reason::found);
}

TEST_CASE("the first frame may be solved without `begin`") {
  Scene scene;
  InArena<Estimator> e(scene.model, scene.limits);
  scene.start(e.object, 0.1f);
  auto seen = scene.observe(0.13f, scene.q, 0.1f);
  e->predict();
  e->solve(span(seen));
  CHECK(e->end().state == TrackState::tracking);
  CHECK(turn_error(e.object, 0.13f) < 0.02f);
}

TEST_CASE("what a solve with too few observations says is of these, not of the solve before") {
  Scene scene;
  InArena<Estimator> e(scene.model, scene.limits);
  scene.start(e.object, 0.1f);
  e->begin(1);
  auto seen = scene.observe(0.13f, scene.q, 0.1f);
  e->solve(span(seen));
  auto few = scene.observe(0.13f, scene.q, 0.1f);
  few.resize(2);
  e->solve(span(few));
  const FrameResult result = e->end();
  CHECK(result.inliers == 0);
  CHECK(result.rms_px == 0);
  CHECK_FALSE(result.pose_is_observed);
}

TEST_CASE("an expression whose range is empty stays at 0, and the others are tracked") {
  ModelBuilder b = egg_model(3);
  const std::uint16_t empty = b.parameter("empty", Group::expression, 0, 0, 0.4f);
  b.record(Operation::add_vector, {b.last()}, {empty}, b.field(3, 2, 2, [](float, float) {
    return Vec3{1, 0, 0};
  }));
  Scene scene;
  scene.words = b.table();
  REQUIRE(Model::open(scene.words.data(), scene.words.size() * 4, &scene.model) == Status::ok);
  scene.q.push_back(0);
  InArena<Estimator> e(scene.model, scene.limits);
  scene.start(e.object, 0.1f);
  std::vector<float> truth = scene.q;
  truth[3] = 0.5f;
  for (int frame = 1; frame < 6; ++frame) {
    e->begin(frame * std::int64_t{40'000'000});
    auto seen = scene.observe(0.13f, truth, 0.1f);
    e->solve(span(seen));
    CHECK(e->end().state == TrackState::tracking);
  }
  CHECK(turn_error(e.object, 0.13f) < 0.02f);
  CHECK(e->parameters()[3] == doctest::Approx(0.5).epsilon(0.1).scale(1));
  CHECK(e->parameters()[empty] == 0);
}
}  // namespace estimator_test
