#pragma once
// The scene of the tests of the estimator: an egg, seen by a camera.
#include <doctest/doctest.h>

#include <vector>

#include "open_model.hpp"
#include "pliant/estimator.hpp"
#include "random.hpp"

namespace estimator_scene {

using namespace pliant;

constexpr int kWidth = 640, kHeight = 480;

/// An estimator on the egg, and a second one, posed by hand, that says what would be seen.
struct Scene : OpenedEgg {
  EstimatorLimits limits;
  Camera camera = centred_camera(kWidth, kHeight, 800);
  std::vector<Vec2> uv;
  std::vector<std::uint16_t> ids;
  Random random{11};

  Scene() : OpenedEgg(3) {
    q[0] = 0.8f;
    limits.points = 60;
    limits.vertices = 300;
    for (int i = 0; i < 49; ++i)
      uv.push_back({0.14f + 0.12f * static_cast<float>(i % 7), 0.14f + 0.12f * static_cast<float>(i / 7)});
  }

  static Pose pose(float turn) {
    return {exp_rotation({0.3f * turn, turn, 0.2f * turn}), {20 * turn, 5, 700}};
  }

  void start(Estimator& e, float turn, const EstimatorOptions& options = {}) {
    REQUIRE(e.start(camera, kWidth, kHeight, pose(turn), q.data(), nullptr, options) == Status::ok);
    ids.resize(uv.size());
    for (std::size_t i = 0; i < uv.size(); ++i) REQUIRE(e.add_point(uv[i], &ids[i]) == Status::ok);
  }

  /// What a camera would see of the points at a pose and parameters.
  std::vector<Observation> observe(float turn, const std::vector<float>& truth, float noise_px) {
    InArena<Cascade> cascade(model);
    const Projector projector(view_of(pose(turn), camera), true);
    std::vector<Observation> out;
    for (std::size_t i = 0; i < uv.size(); ++i) {
      Observation o;
      o.id = ids[i];
      REQUIRE(projector.project(cascade->surface_point(uv[i], truth.data()), &o.x));
      o.x = o.x + Vec2{noise_px * random.normal(), noise_px * random.normal()};
      o.information = {25, 0, 25};
      out.push_back(o);
    }
    return out;
  }
};

inline Span<Observation> span(std::vector<Observation>& o) {
  return {o.data(), o.size()};
}

inline float turn_error(const Estimator& e, float turn) {
  return length(log_rotation(e.view().q * conjugate(normalised(Scene::pose(turn).q))));
}

}  // namespace estimator_scene
