// Each option of the estimator has an effect.
#include <doctest/doctest.h>

#include <algorithm>
#include <limits>

#include "estimator_scene.hpp"

namespace estimator_options_test {

using namespace estimator_scene;

namespace {

/// The estimator after frames in which the egg turns and opens its jaw.
struct Tracked {
  Scene scene;
  InArena<Estimator> estimator;
  FrameResult result;
  std::vector<float> truth = scene.q;

  explicit Tracked(const EstimatorOptions& options, const EstimatorLimits& limits = Scene().limits)
      : estimator(scene.model, limits) {
    scene.start(estimator.object, 0, options);
  }
  void frame(int k, float turn, float jaw, float noise_px = 0.1f) {
    truth[5] = jaw;
    estimator->begin(k * std::int64_t{33'000'000});
    auto seen = scene.observe(turn, truth, noise_px);
    estimator->solve(span(seen));
    result = estimator->end();
    CHECK(result.state == TrackState::tracking);
  }
  /// Largest distance of a vertex from the surface, mm.
  float vertex_error() {
    float most = 0;
    for (VertexId v : estimator->mesh().vertices())
      most = max(
          most, length(estimator->vertex_positions()[v] - estimator->surface_point(estimator->mesh().uv(v))));
    return most;
  }
};

}  // namespace

TEST_CASE("iterations: a solve takes no more steps a minimisation than it may") {
  EstimatorOptions options;
  options.iterations = 1;
  options.rejection = Rejection::weights;
  Tracked one(options);
  one.frame(1, 0.12f, 0.3f);
  CHECK(one.result.iterations == 2);
  options.iterations = 4;
  Tracked four(options);
  four.frame(1, 0.12f, 0.3f);
  CHECK(four.result.iterations > 2);
  CHECK(four.result.iterations <= 8);
  CHECK(four.result.rms_px <= one.result.rms_px);
}

TEST_CASE("model_error_mm: the larger it is, the larger are the standard deviations of the result") {
  float sd[2];
  for (const bool large : {false, true}) {
    EstimatorOptions options;
    options.model_error_mm = large ? 2.0f : 0.2f;
    Tracked tracked(options);
    tracked.frame(1, 0, 0);
    State state;
    tracked.estimator->save(&state);
    sd[large] = state.pose_sd[kTurnY];
  }
  CHECK(sd[1] > 2 * sd[0]);
}

TEST_CASE("mesh_error_mm: a smaller error takes more vertices") {
  EstimatorOptions options;
  options.mesh_error_mm = 5;
  Tracked coarse(options);
  options.mesh_error_mm = 0.3f;
  Tracked fine(options);
  CHECK(fine.estimator->mesh().vertex_count() > coarse.estimator->mesh().vertex_count());
  options.mesh_error_mm = 0;
  Tracked base(options);
  CHECK(static_cast<std::size_t>(base.estimator->mesh().vertex_count()) ==
        base.estimator->model().base_uv().count);
}

TEST_CASE("options out of their bounds are refused, and nothing changes; at their bounds all stays finite") {
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinite = std::numeric_limits<float>::infinity();
  const auto with = [](auto change) {
    EstimatorOptions options;
    change(options);
    return options;
  };
  Tracked tracked({});
  const auto start = [&](const EstimatorOptions& options) {
    Scene& s = tracked.scene;
    return tracked.estimator->start(s.camera, kWidth, kHeight, s.pose(0), s.q.data(), nullptr, options);
  };
  for (const float bad : {nan, infinite, -infinite, -0.1f, 1e30f}) {
    CHECK(start(with([&](auto& o) { o.cue_scale_rate = bad; })) == Status::bad_argument);
    CHECK(start(with([&](auto& o) { o.model_error_mm = bad; })) == Status::bad_argument);
    if (!is_finite(bad)) CHECK(start(with([&](auto& o) { o.mesh_error_mm = bad; })) == Status::bad_argument);
  }
  CHECK(start(with([](auto& o) { o.cue_scale_rate = 100; })) == Status::bad_argument);
  CHECK(start(with([](auto& o) { o.iterations = -1; })) == Status::bad_argument);
  CHECK(start(with([](auto& o) { o.iterations = 1001; })) == Status::bad_argument);
  CHECK(start(with([](auto& o) { o.rejection = static_cast<Rejection>(5); })) == Status::bad_argument);
  tracked.frame(1, 0.02f, 0.1f);  // still started, with its points

  const EstimatorOptions extremes[] = {
      with([](auto& o) { o.cue_scale_rate = 1; }),      with([](auto& o) { o.model_error_mm = 0; }),
      with([](auto& o) { o.model_error_mm = 1e-30f; }), with([](auto& o) { o.model_error_mm = 1000; }),
      with([](auto& o) { o.mesh_error_mm = 1e-30f; }),  with([](auto& o) { o.mesh_error_mm = 1e30f; }),
      with([](auto& o) { o.iterations = 0; }),          with([](auto& o) { o.iterations = 1000; })};
  for (const EstimatorOptions& options : extremes) {
    CAPTURE(&options - extremes);
    Scene scene;
    InArena<Estimator> estimator{scene.model, scene.limits};
    scene.start(estimator.object, 0, options);
    for (int k = 1; k < 6; ++k) {
      estimator->begin(k * std::int64_t{33'000'000});
      auto seen = scene.observe(0.02f * float(k), scene.q, 2);
      estimator->solve(span(seen));
      const FrameResult result = estimator->end();
      CHECK(is_finite(result.pose));
      CHECK(is_finite(result.rms_px));
      CHECK(is_finite(estimator->cue_scale(Cue::patch)));
    }
    for (const float value : estimator->parameters()) CHECK(is_finite(value));
  }
}

TEST_CASE("a mesh that follows the view is valid and in its budget, whatever tolerance and budget are") {
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinite = std::numeric_limits<float>::infinity();
  for (const float px : {0.01f, 0.0f, -1.0f, nan, infinite, -infinite, 1e30f, 1e-45f})
    for (const int budget : {0, 1, 180, 65535}) {
      CAPTURE(px);
      CAPTURE(budget);
      EstimatorOptions options;
      options.mesh_operations = 12;
      options.mesh_error_px = px;
      options.vertex_budget = static_cast<std::uint16_t>(budget);
      Tracked tracked(options);
      for (int k = 1; k < 6; ++k) tracked.frame(k, 0.02f * float(k), 0);
      const Mesh& mesh = tracked.estimator->mesh();
      const int base = static_cast<int>(tracked.estimator->model().base_uv().count);
      CHECK(mesh.validate().invariant == 0);
      const int capacity = mesh.limits().vertices, most = budget == 0 ? capacity : std::min(budget, capacity);
      CHECK(mesh.vertex_count() <= std::max(most, base));
      const bool refines = px > 0 && px < 0.1f && budget != 1;  // other tolerances leave the base mesh
      CHECK((mesh.vertex_count() > base) == refines);
    }
}

TEST_CASE("predicts_motion: a steady motion is predicted where it goes") {
  float off[2];
  for (const bool predicts : {false, true}) {
    EstimatorOptions options;
    options.predicts_motion = predicts;
    Tracked tracked(options);
    for (int k = 1; k < 15; ++k) tracked.frame(k, 0.02f * float(k), 0);
    tracked.estimator->begin(15 * std::int64_t{33'000'000});
    off[predicts] = turn_error(tracked.estimator.object, 0.02f * 15);
  }
  CHECK(off[1] < 0.4f * off[0]);
}

TEST_CASE("a measured motion takes the place of the predicted one") {
  EstimatorOptions options;
  options.predicts_motion = true;
  Tracked tracked(options);
  for (int k = 1; k < 15; ++k) tracked.frame(k, 0.02f * float(k), 0);
  Estimator& e = tracked.estimator.object;
  const auto middle = [&] { return e.view().c + e.view().s * e.view().tau; };
  const Vec2 before = middle();
  e.begin(15 * std::int64_t{33'000'000});
  for (const Vec2 by : {Vec2{8, 3}, Vec2{-20, 0}}) {  // measured again, it is not added
    e.translate(by);
    CHECK(length(middle() - before - by) < 1e-2f);
  }
  View key = e.view();
  key.tau = {0.1f * key.tau.x + 3, key.tau.y};
  e.propose(key);
  const Vec2 proposed = middle();
  e.translate({5, 5});
  CHECK(length(middle() - proposed - Vec2{5, 5}) < 1e-2f);
}

TEST_CASE("smooths: the smoothed pose lags behind the pose, and is missing without the option") {
  EstimatorOptions options;
  options.smooths = true;
  Tracked smooth(options), rough({});
  for (int k = 1; k < 8; ++k) {
    smooth.frame(k, 0.02f * float(k), 0.02f * float(k));
    rough.frame(k, 0.02f * float(k), 0.02f * float(k));
  }
  const auto turn_of = [](const Pose& p) { return length(log_rotation(p.q)); };
  CHECK(turn_of(smooth.result.smoothed_pose) < turn_of(smooth.result.pose));
  CHECK(smooth.estimator->smoothed_parameters()[5] < smooth.estimator->parameters()[5]);
  CHECK(turn_of(rough.result.smoothed_pose) == 0);
}

TEST_CASE("vertex_interval_frames: with 1 all vertices are exact in every frame, with 4 some lag") {
  float error[2];
  for (const bool all : {false, true}) {
    EstimatorOptions options;
    options.vertex_interval_frames = all ? 1 : 4;
    Tracked tracked(options);
    for (int k = 1; k < 6; ++k) tracked.frame(k, 0, 0.02f * float(k));
    error[all] = tracked.vertex_error();
  }
  CHECK(error[1] < 0.05f);
  CHECK(error[0] > 0.2f);
}

TEST_CASE("tangent_interval_frames: with 1 all tangents follow the jaw in every frame, with 4 some lag") {
  int changed[2] = {};
  for (const bool all : {false, true}) {
    EstimatorOptions options;
    options.tangent_interval_frames = all ? 1 : 4;
    Tracked tracked(options), still(options);
    tracked.frame(1, 0, 0.3f, 0);
    // The state is now that of the open jaw; the tangents are those of `begin`, one frame later.
    tracked.estimator->begin(2 * std::int64_t{33'000'000});
    State state;
    std::vector<float> q(tracked.truth.size());
    state.q = q.data();
    tracked.estimator->save(&state);
    REQUIRE(still.scene.model.parameters().count == q.size());
    REQUIRE(still.estimator->start(still.scene.camera, kWidth, kHeight, state.pose, q.data(), nullptr,
                                   options) == Status::ok);
    for (std::size_t i = 0; i < tracked.scene.uv.size(); ++i) {
      std::uint16_t id;
      REQUIRE(still.estimator->add_point(tracked.scene.uv[i], &id) == Status::ok);
      const Prediction a = tracked.estimator->predict(tracked.scene.ids[i]), b = still.estimator->predict(id);
      changed[all] += magnitude(a.jacobian.d - b.jacobian.d) > 1;
    }
  }
  CHECK(changed[1] == 0);
  CHECK(changed[0] > 5);
}

TEST_CASE("the rejection takes no larger sample than it has room for") {
  const Scene scene;
  EstimatorLimits most = scene.limits;
  most.points = 8000;
  most.rejection_sample = 4096;
  EstimatorLimits more = most;
  more.rejection_sample = 5000;
  CHECK(measured_bytes<Estimator>(scene.model, more) == measured_bytes<Estimator>(scene.model, most));
}

TEST_CASE(
    "without a mesh that follows the view its operations are refused, and the mesh of the start is the "
    "same") {
  Tracked usual({});
  const Scene scene;
  InArena<Estimator> estimator(scene.model, without_mesh_following(scene.limits));
  const auto start = [&](const EstimatorOptions& options) {
    return estimator->start(scene.camera, kWidth, kHeight, Scene::pose(0), scene.q.data(), nullptr, options);
  };
  EstimatorOptions follows;
  follows.mesh_operations = 1;
  CHECK(start(follows) == Status::capacity);
  REQUIRE(start({}) == Status::ok);
  CHECK(estimator->mesh().vertex_count() == usual.estimator->mesh().vertex_count());
}

namespace {

/// Tries to create an estimator that borrows memory, which is too small, not aligned, or right; then `lend` has set it so.
/// \param needed  bytes.
template <class Lend>
void check_borrowed(const Scene& scene, EstimatorLimits& limits, AlignedBlock& memory, std::size_t needed,
                    const Lend& lend) {
  AlignedBlock block(measured_bytes<Estimator>(scene.model, limits));
  const auto create = [&](unsigned char* data, std::size_t bytes) {
    lend(limits, {data, bytes});
    Arena arena(block.data(), block.size());
    Estimator estimator;
    const Status status = create_in(arena, estimator, scene.model, limits);
    CHECK((measured_bytes<Estimator>(scene.model, limits) > 0) == (status == Status::ok));
    CHECK((arena.used_bytes() > 0) == (status == Status::ok));
    return status;
  };
  CHECK(create(memory.data(), 1) == Status::bad_argument);
  CHECK(create(memory.data(), needed - 1) == Status::bad_argument);
  CHECK(create(memory.data() + 1, needed) == Status::bad_argument);
  CHECK(create(nullptr, needed) == Status::bad_argument);
  CHECK(create(nullptr, 0) == Status::ok);
  REQUIRE(create(memory.data(), needed) == Status::ok);
}

}  // namespace

TEST_CASE(
    "memory for adaptation that is too small or not aligned is refused; enough of it gives the same mesh") {
  const Scene scene;
  EstimatorLimits limits = scene.limits;
  const std::size_t needed = adaptation_bytes(limits.vertices);
  AlignedBlock adaptation(needed + 1);
  check_borrowed(scene, limits, adaptation, needed,
                 [](EstimatorLimits& l, Span<unsigned char> m) { l.adaptation_memory = m; });
  Tracked own({});
  Scene other;
  InArena<Estimator> shared(other.model, limits);
  other.start(shared.object, 0);
  CHECK(shared->mesh().vertex_count() == own.estimator->mesh().vertex_count());
  CHECK(shared->mesh().vertex_count() > other.model.base_uv().count);
}

TEST_CASE(
    "memory of the solves that others write to from an end to the next solve gives the same bits, and is not "
    "taken") {
  const Scene scene;
  EstimatorLimits limits = scene.limits;
  const std::size_t needed = solve_bytes(scene.model, limits),
                    own_bytes = measured_bytes<Estimator>(scene.model, limits);
  AlignedBlock lent(needed + 1);
  check_borrowed(scene, limits, lent, needed,
                 [](EstimatorLimits& l, Span<unsigned char> m) { l.solve_memory = m; });
  CHECK(measured_bytes<Estimator>(scene.model, limits) == own_bytes - needed);
  Tracked own({}), borrowing({}, limits);
  for (int k = 1; k <= 4; ++k) {
    for (Tracked* t : {&own, &borrowing})
      t->frame(k, 0.05f * static_cast<float>(k), 0.1f * static_cast<float>(k));
    std::fill_n(lent.data(), needed, static_cast<unsigned char>(0xA5));
    State a, b;
    own.estimator->save(&a);
    borrowing.estimator->save(&b);
    CHECK(a.pose.t.x == b.pose.t.x);
    CHECK(a.pose_sd[kTurnY] == b.pose_sd[kTurnY]);
    CHECK(own.result.iterations == borrowing.result.iterations);
  }
}

}  // namespace estimator_options_test
