// What a start leaves behind must not show in the next one, nor what its memory held before; and what a state that is put
// in place changes.
#include <doctest/doctest.h>

#include <limits>

#include "estimate/visible_surface.hpp"
#include "estimator_scene.hpp"

namespace estimator_restart_test {

using namespace estimator_scene;

namespace {

/// A sheet whose bend counts more with another size: a product of a parameter that is frozen and one that is free.
ModelBuilder bent_sheet() {
  ModelBuilder m;
  const std::uint16_t size = m.parameter("size", Group::identity, -3, 3, 1),
                      bend = m.parameter("bend", Group::expression, -2, 2, 1);
  m.record(Operation::constant, {}, {}, m.field(3, 9, 9, [](float u, float v) {
    const float x = 2 * u - 1, y = 2 * v - 1;
    return Vec3{100 * (u - 0.5f), 100 * (0.5f - v), -30 * (x * x + y * y)};
  }));
  m.record(Operation::add_vector, {m.last()}, {bend}, m.field(3, 33, 33, [](float u, float v) {
    return Vec3{0, 10 * u * u, 5 * v};
  }));
  m.record(Operation::product, {m.last()}, {size, bend}, m.field(3, 33, 33, [](float u, float v) {
    return Vec3{0, 0, 20 * u * v};
  }));
  m.grid_mesh(4);
  return m;
}

/// A start far away, from where the egg comes so near that the mesh is refined.
/// \param keeps_mesh  of the start before.
void approach(Scene& scene, Estimator& e, const std::uint8_t* is_free, std::int64_t* time,
              bool keeps_mesh = false) {
  EstimatorOptions options;
  options.mesh_operations = 40;
  options.mesh_error_px = 0.05f;
  options.mesh_error_mm = keeps_mesh ? -1.0f : 0.0f;
  InArena<Cascade> cascade(scene.model);
  float distance = 3000;
  const auto pose = [&distance] { return Pose{{}, {0, 0, distance}}; };
  options.time_ns = *time;
  REQUIRE(e.start(scene.camera, kWidth, kHeight, pose(), scene.q.data(), is_free, options) == Status::ok);
  scene.ids.resize(scene.uv.size());
  for (std::size_t i = 0; i < scene.uv.size(); ++i)
    REQUIRE(e.add_point(scene.uv[i], &scene.ids[i]) == Status::ok);
  for (int k = 0; k < 60; ++k) {
    distance = max(0.93f * distance, 250);
    const Projector projector(view_of(pose(), scene.camera), true);
    std::vector<Observation> seen;
    for (std::size_t i = 0; i < scene.uv.size(); ++i) {
      Observation o;
      o.id = scene.ids[i];
      o.information = {25, 0, 25};
      REQUIRE(projector.project(cascade->surface_point(scene.uv[i], scene.q.data()), &o.x));
      seen.push_back(o);
    }
    e.begin(*time += 33'000'000);
    e.predict();
    e.solve(span(seen));
    e.end();
  }
}

}  // namespace

TEST_CASE("a frozen parameter has its value in every trial step, whatever the memory held") {
  const OpenModel sheet(bent_sheet());
  const Model& model = sheet.model;
  EstimatorLimits limits;
  limits.points = 60;
  limits.vertices = 300;
  InArena<Cascade> cascade(model);
  const Camera camera = centred_camera(kWidth, kHeight, 800);
  const Pose pose{{}, {0, 0, 500}};
  const float at_start[] = {1, 0}, truth[] = {1, 0.6f};
  for (const int before : {0x00, 0x41, 0xFF}) {
    AlignedBlock block(measured_bytes<Estimator>(model, limits));
    std::fill_n(block.data(), block.size(), static_cast<unsigned char>(before));
    Arena arena(block.data(), block.size());
    Estimator e;
    REQUIRE(create_in(arena, e, model, limits) == Status::ok);
    REQUIRE(e.start(camera, kWidth, kHeight, pose, at_start, nullptr, {}) == Status::ok);
    std::vector<Observation> seen;
    for (int i = 0; i < 49; ++i) {
      const Vec2 uv{0.1f + 0.13f * static_cast<float>(i % 7), 0.1f + 0.13f * static_cast<float>(i / 7)};
      Observation o;
      REQUIRE(e.add_point(uv, &o.id) == Status::ok);
      REQUIRE(Projector(view_of(pose, camera), true).project(cascade->surface_point(uv, truth), &o.x));
      o.information = {25, 0, 25};
      seen.push_back(o);
    }
    for (int k = 1; k < 4; ++k) {
      std::vector<Observation> again = seen;
      e.begin(k * std::int64_t{33'000'000});
      e.predict();
      e.solve(span(again));
      e.end();
    }
    CHECK(e.parameters()[0] == 1);
    CHECK(e.parameters()[1] == doctest::Approx(0.6).epsilon(0.02));
  }
}

TEST_CASE("a mesh that was refined for another person is that of the present one after a new start") {
  Scene scene;
  scene.limits.vertices = 600;
  InArena<Estimator> e(scene.model, scene.limits);
  std::int64_t time = 0;
  std::vector<std::uint8_t> is_free(scene.q.size(), 1);
  for (int round = 0; round < 4; ++round) {
    for (std::size_t k = 0; k < is_free.size(); ++k) {
      const bool is_odd = (static_cast<std::size_t>(round) + k) % 2 != 0;
      is_free[k] = is_odd && scene.model.parameters()[k].group == Group::expression;
    }
    scene.q[0] = 2 - 0.2f * static_cast<float>(round);
    approach(scene, e.object, is_free.data(), &time);
    e->refresh_vertices();
    CHECK(e->mesh().vertex_count() > 100);
    float worst = 0;
    for (VertexId v : e->mesh().vertices())
      worst = max(worst, length(e->vertex_positions()[v] - e->surface_point(e->mesh().uv(v))));
    CHECK(worst < 0.1f);
  }
}

TEST_CASE("a mesh that follows the view and is kept has no vertex of the person before") {
  Scene scene;
  scene.limits.vertices = 600;
  InArena<Estimator> e(scene.model, scene.limits);
  std::int64_t time = 0;
  std::vector<std::uint8_t> is_free;  // the person is not: samples have it in them
  for (const Parameter& p : scene.model.parameters()) is_free.push_back(p.group == Group::expression);
  for (int round = 0; round < 4; ++round) {
    scene.q[0] = 2 - static_cast<float>(round);
    approach(scene, e.object, is_free.data(), &time, round > 0);
    CHECK(e->mesh().vertex_count() > 100);
    for (VertexId v : e->mesh().vertices())
      CHECK(length(e->vertex_positions()[v] - e->surface_point(e->mesh().uv(v))) < 1);
    e->refresh_vertices();
    for (VertexId v : e->mesh().vertices())
      CHECK(length(e->vertex_positions()[v] - e->surface_point(e->mesh().uv(v))) < 0.1f);
  }
}

TEST_CASE("a new start keeps the mesh if it is told to, with the vertices where the present person has them") {
  Scene scene;
  scene.limits.vertices = 600;
  InArena<Estimator> e(scene.model, scene.limits);
  EstimatorOptions refining, keeping;
  refining.mesh_error_mm = 0.1f;
  keeping.mesh_error_mm = -1;
  scene.start(e.object, 0.1f, keeping);  // nothing to keep yet
  const int base = e->mesh().vertex_count();
  scene.start(e.object, 0.1f, refining);
  std::vector<Vec2> uv;
  for (const VertexId v : e->mesh().vertices()) uv.push_back(e->mesh().uv(v));
  REQUIRE(e->mesh().vertex_count() > base);
  scene.q[0] += 1;
  scene.start(e.object, 0.2f, keeping);
  REQUIRE(static_cast<std::size_t>(e->mesh().vertex_count()) == uv.size());
  const auto farthest = [&] {
    float most = 0;
    for (const VertexId v : e->mesh().vertices())
      most = max(most, length(e->vertex_positions()[v] - e->surface_point(e->mesh().uv(v))));
    return most;
  };
  for (const VertexId v : e->mesh().vertices()) {
    CHECK(e->mesh().uv(v).x == uv[v].x);
    CHECK(e->mesh().uv(v).y == uv[v].y);
  }
  CHECK(farthest() > 0.1f);
  for (std::size_t k = 0; k < kVisibleSurfaceTuning.renewal_frames; ++k) {
    std::vector<Observation> seen = scene.observe(0.2f, scene.q, 0);
    e->begin(static_cast<std::int64_t>(k) * 33'000'000);
    e->predict();
    e->solve(span(seen));
    REQUIRE(e->end().state == TrackState::tracking);
  }
  CHECK(farthest() < 0.1f);
}

TEST_CASE("a model without parameters starts without values for them, and its pose is found") {
  ModelBuilder rigid;
  rigid.record(Operation::constant, {}, {}, rigid.field(3, 9, 9, [](float u, float v) {
    return Vec3{100 * (u - 0.5f), 100 * (0.5f - v), -30 * u * v};
  }));
  rigid.grid_mesh(4);
  const OpenModel sheet(rigid);
  const Model& model = sheet.model;
  EstimatorLimits limits;
  limits.points = 60;
  limits.vertices = 300;
  InArena<Estimator> e(model, limits);
  InArena<Cascade> cascade(model);
  const Camera camera = centred_camera(kWidth, kHeight, 800);
  REQUIRE(e->start(camera, kWidth, kHeight, {{}, {0, 0, 500}}, nullptr, nullptr, {}) == Status::ok);
  const Pose truth{exp_rotation({0.02f, 0.03f, 0}), {3, 2, 500}};
  std::vector<Observation> seen;
  for (int i = 0; i < 49; ++i) {
    const Vec2 uv{0.1f + 0.13f * static_cast<float>(i % 7), 0.1f + 0.13f * static_cast<float>(i / 7)};
    Observation o;
    REQUIRE(e->add_point(uv, &o.id) == Status::ok);
    REQUIRE(Projector(view_of(truth, camera), true).project(cascade->surface_point(uv, nullptr), &o.x));
    o.information = {25, 0, 25};
    seen.push_back(o);
  }
  e->begin(33'000'000);
  e->predict();
  e->solve(span(seen));
  CHECK(e->end().state == TrackState::tracking);
  CHECK(length(log_rotation(e->view().q * conjugate(truth.q))) < 0.002f);
}

TEST_CASE("the smoothed result begins with the start") {
  Scene scene;
  EstimatorOptions options;
  options.smooths = true;
  InArena<Estimator> e(scene.model, scene.limits);
  for (const float size : {0.8f, -0.5f}) {
    scene.q[0] = size;
    scene.start(e.object, 0.1f, options);
    CHECK(e->smoothed_parameters()[0] == size);
    CHECK(e->smoothed_parameters()[5] == scene.q[5]);
  }
}

TEST_CASE("after a state is restored, surface_at finds the surface of its expression at once") {
  Scene scene;
  InArena<Estimator> e(scene.model, scene.limits), there(scene.model, scene.limits);
  scene.start(e.object, 0.1f);
  std::vector<float> q = scene.q;
  q[5] = scene.model.parameters()[5].maximum;  // the jaw
  REQUIRE(there->start(scene.camera, kWidth, kHeight, Scene::pose(0.1f), q.data(), nullptr, {}) ==
          Status::ok);
  State state;
  state.pose = Scene::pose(0.1f);
  state.q = q.data();
  REQUIRE(e->restore(state) == Status::ok);
  for (int k = 0; k < 20; ++k) {
    const Vec2 uv{0.3f + 0.02f * static_cast<float>(k), 0.85f};
    Vec2 x, back;
    REQUIRE(there->project(uv, &x));
    REQUIRE(e->surface_at(x, &back) == 0);
    CHECK(length(back - uv) < 2e-3f);
  }
}

TEST_CASE("revise corrects the rotation and what is not free, within limits; the free parameters stay") {
  Scene scene;
  InArena<Estimator> e(scene.model, scene.limits);
  scene.q[5] = 0.2f;
  scene.start(e.object, 0.1f);
  const Quat before = e->view().q, turn = exp_rotation({0, 0.05f, 0.02f});
  std::vector<float> q(scene.q.size(), 0.1f);
  q[0] = 1e3f;
  q[1] = -0.7f;
  CHECK(e->revise(nullptr, turn) == Status::bad_argument);
  q[2] = std::numeric_limits<float>::quiet_NaN();
  CHECK(e->revise(q.data(), turn) == Status::bad_argument);
  q[2] = 0;
  CHECK(e->revise(q.data(), {1, 0, std::numeric_limits<float>::infinity(), 0}) == Status::bad_argument);
  for (const float w : {0.0f, 1e-30f, 2.0f, 1e30f})
    CHECK(e->revise(q.data(), {w, 0, 0, 0}) == Status::bad_argument);
  CHECK(e->parameters()[0] == scene.q[0]);
  REQUIRE(e->revise(q.data(), turn) == Status::ok);
  CHECK(e->parameters()[0] == scene.model.parameters()[0].maximum);
  CHECK(e->parameters()[1] == -0.7f);
  for (std::size_t k = 3; k < q.size(); ++k) CHECK(e->parameters()[k] == scene.q[k]);
  CHECK(length(log_rotation(e->view().q * conjugate(before * turn))) < 1e-3f);
  // The same after a bad frame, which goes back to the last good state.
  e->begin(33'000'000);
  e->end();
  CHECK(e->parameters()[1] == -0.7f);
  CHECK(length(log_rotation(e->view().q * conjugate(before * turn))) < 1e-3f);
}

}  // namespace estimator_restart_test
