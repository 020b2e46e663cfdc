#pragma once
// An egg in front of a camera: what the tests of the estimator's parts work on.
#include <doctest/doctest.h>

#include "estimate/motion_model.hpp"
#include "open_model.hpp"

/// The model, its cascade with the expressions free, and a state.
struct PosedEgg : OpenedEgg {
  InArena<pliant::Cascade> cascade{model};
  pliant::Camera camera = pliant::centred_camera(640, 480, 800);
  pliant::ModelState state;

  explicit PosedEgg(float turn = 0) : OpenedEgg(3) {
    cascade->set_free(pliant::Group::expression);
    state.q = q.data();
    pose({pliant::exp_rotation({0, turn, 0}), {0, 5, 700}});
  }
  void pose(const pliant::Pose& at) { state.view = pliant::view_of(at, camera); }
  std::size_t parameters() const { return q.size(); }
  std::size_t samples() const { return cascade.object.samples_per_point(); }
  pliant::Vec2 image_of(pliant::Vec2 uv) {
    pliant::Vec2 x;
    REQUIRE(pliant::Projector(state.view, true).project(cascade->surface_point(uv, state.q), &x));
    return x;
  }
};

/// A motion model that expects the egg's state.
struct ExpectedEgg {
  InArena<pliant::MotionModel> motion;

  explicit ExpectedEgg(PosedEgg& egg) : motion(egg.parameters()) {
    pliant::EstimatorOptions options;
    options.time_ns = 0;
    REQUIRE(motion->start(egg.cascade.object, egg.state, options) == pliant::Status::ok);
    motion->predict(1, 0, egg.cascade.object, &egg.state);
  }
};
