#include "estimate/motion_model.hpp"

#include <doctest/doctest.h>

#include "posed_egg.hpp"

using namespace pliant;

namespace {

constexpr std::int64_t kFrame = 33'000'000;

/// Runs frames in which the egg moves sideways by `step` mm each; the solves find it exactly.
struct Run {
  PosedEgg egg;
  InArena<MotionModel> motion{egg.parameters()};
  std::vector<float> variance = std::vector<float>(kPoseUnknowns + 4, 1e-4f);
  std::int64_t time = 0;

  explicit Run(bool predicts, bool smooths = false) {
    REQUIRE(motion->start(egg.cascade.object, egg.state, predicts, smooths) == Status::ok);
  }
  bool frame(float step, int bad_frames = 0) {
    const float there = egg.state.view.tau.x + step;
    time += kFrame;
    const bool moved = motion->predict(time, bad_frames, egg.cascade.object, &egg.state);
    egg.state.view.tau.x = there;
    motion->correct(egg.cascade.object, egg.state, variance.data(), egg.state);
    return moved;
  }
};

}  // namespace

TEST_CASE("with prediction a frame starts where the motion leads, without it where the last frame was") {
  for (const bool predicts : {false, true}) {
    Run run(predicts);
    for (int k = 0; k < 20; ++k) CHECK(run.frame(3) == predicts);
    const float here = run.egg.state.view.tau.x;
    run.motion->predict(run.time + kFrame, 0, run.egg.cascade.object, &run.egg.state);
    CHECK(run.egg.state.view.tau.x - here == doctest::Approx(predicts ? 3 : 0).epsilon(0.1).scale(1));
    CHECK(run.motion->expected().mean.view.tau.x == run.egg.state.view.tau.x);
  }
}

TEST_CASE("after a bad frame the state stays, and the expected state is less certain") {
  Run run(true);
  for (int k = 0; k < 20; ++k) run.frame(0);
  const float usual = run.motion->expected().pose_variance[kShiftX];
  const float here = run.egg.state.view.tau.x;
  CHECK_FALSE(run.motion->predict(run.time + kFrame, 1, run.egg.cascade.object, &run.egg.state));
  CHECK(run.egg.state.view.tau.x == here);
  CHECK(run.motion->expected().pose_variance[kShiftX] > 3.9f * usual);
}

TEST_CASE("a motion that is not predicted is uncertain instead") {
  Run still(false), moving(false);
  for (int k = 0; k < 20; ++k) {
    still.frame(0);
    moving.frame(15);
  }
  CHECK(moving.motion->expected().pose_variance[kShiftX] >
        2 * still.motion->expected().pose_variance[kShiftX]);
}

TEST_CASE("parameters may change by three ranges a second; frozen ones are expected where they are") {
  Run run(false);
  run.frame(0);
  const ExpectedState& expected = run.motion->expected();
  const float range = run.egg.model.parameters()[5].maximum - run.egg.model.parameters()[5].minimum;
  CHECK(expected.parameter_sd[5] == doctest::Approx(double(3 * range * 0.033f)).epsilon(1e-3));
  CHECK(run.motion->filter().ranges()[0] == 0);
  run.motion->expect(5, 0.25f);
  CHECK(expected.mean.q[5] == 0.25f);
}

TEST_CASE("the smoothed pose follows slowly, only where it is asked for") {
  Run rough(false), smooth(false, true);
  for (int k = 0; k < 10; ++k) {
    rough.frame(0);
    smooth.frame(0);
  }
  const float before = smooth.motion->smoothed_pose().t.x;
  smooth.frame(2);
  rough.frame(2);
  CHECK(smooth.motion->smoothed_pose().t.x > before);
  CHECK(smooth.motion->smoothed_pose().t.x < smooth.egg.state.view.tau.x);
  CHECK(rough.motion->smoothed_pose().t.x == Pose{}.t.x);
}
