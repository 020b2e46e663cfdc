#include "estimate/motion_model.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "posed_egg.hpp"

namespace motion_model_test {

using namespace pliant;

namespace {

constexpr std::int64_t kFrame = 33'000'000;

/// Runs frames in which the egg moves sideways by `step` mm each; the solves find it exactly.
struct Run {
  PosedEgg egg;
  InArena<MotionModel> motion{egg.parameters()};
  std::vector<float> variance = std::vector<float>(kPoseUnknowns + 4, 1e-4f);
  std::int64_t time;  // of the last frame; at first that of the start

  explicit Run(bool predicts, bool smooths = false, std::int64_t start = 0) : time(start) {
    EstimatorOptions options;
    options.predicts_motion = predicts;
    options.smooths = smooths;
    options.time_ns = start;
    REQUIRE(motion->start(egg.cascade.object, egg.state, options) == Status::ok);
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

TEST_CASE(
    "parameters may miss what their motion leads to by 2.2 ranges a second; frozen ones are expected where "
    "they are") {
  Run run(false);
  run.frame(0);
  const ExpectedState& expected = run.motion->expected();
  const float range = run.egg.model.parameters()[5].maximum - run.egg.model.parameters()[5].minimum;
  CHECK(expected.parameter_sd[5] == doctest::Approx(double(2.2f * range * 0.033f)).epsilon(1e-3));
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

TEST_CASE("the first smoothed step takes the time since the start, whatever came before it") {
  for (const std::int64_t wait : {kFrame, 3 * kFrame}) {
    Run run(false, true);
    run.frame(3);
    run.motion->predict(run.time += 5 * kFrame, 1, run.egg.cascade.object,
                        &run.egg.state);  // a bad frame: no sample
    EstimatorOptions options;
    options.smooths = true;
    options.time_ns = run.time;
    REQUIRE(run.motion->start(run.egg.cascade.object, run.egg.state, options) == Status::ok);
    InArena<Smoother> reference(std::size_t{run.egg.parameters()});
    const auto add = [&](float seconds) {
      return reference->add(pose_of(run.egg.state.view), run.egg.state.q, run.motion->filter().ranges(),
                            run.egg.parameters(), seconds);
    };
    REQUIRE(add(0) == Status::ok);
    run.time += wait - kFrame;  // `frame` adds one
    run.frame(5);
    REQUIRE(add(static_cast<float>(wait) * 1e-9f) == Status::ok);
    CHECK(run.motion->smoothed_pose().t.x == reference->pose().t.x);
  }
}

TEST_CASE("the smoothed pose allows for the time of bad frames, which give no sample") {
  // The same samples at the same times: once with frames between them that are bad, once without.
  Run dropped(false, true), bad(false, true);
  for (int k = 0; k < 10; ++k) {
    dropped.frame(2);
    bad.frame(2);
  }
  for (int k = 0; k < 2; ++k) {
    dropped.time += kFrame;
    bad.time += kFrame;
    bad.motion->predict(bad.time, k, bad.egg.cascade.object, &bad.egg.state);
  }
  dropped.frame(6);
  bad.frame(6);
  CHECK(bad.motion->smoothed_pose().t.x ==
        doctest::Approx(double(dropped.motion->smoothed_pose().t.x)).epsilon(1e-5));
}

TEST_CASE(
    "where the time of the start is not known, the first frame counts as a thirtieth of a second later") {
  Run known(false), unknown(false, false, kNoTime);
  for (Run* run : {&known, &unknown}) {
    run->time = 10'000'000'000 - kFrame;
    run->frame(0);
  }
  const auto sd = [](Run& run) { return run.motion->expected().parameter_sd[5]; };
  CHECK(sd(unknown) * 0.033f == doctest::Approx(double(sd(known) / 30)).epsilon(0.02));
}

TEST_CASE("times may have any origin: later ones give the same prediction") {
  Run early(true), late(true, false, 10'000'000'000);
  for (int k = 0; k < 5; ++k) {
    early.frame(3);
    late.frame(3);
    CHECK(late.egg.state.view.tau.x == early.egg.state.view.tau.x);
    CHECK(late.motion->expected().pose_variance[kShiftX] == early.motion->expected().pose_variance[kShiftX]);
    CHECK(late.motion->expected().mean.view.tau.x == early.motion->expected().mean.view.tau.x);
  }
}

TEST_CASE(
    "a parameter that moves is expected where its velocity leads, within its range, also where the frame "
    "starts at the last one") {
  Run run(false);
  const Parameter& jaw = run.egg.model.parameters()[5];
  const auto& expected = run.motion->expected();
  const float step = 0.05f * (jaw.maximum - jaw.minimum);
  for (int k = 1; k <= 12; ++k) {
    run.egg.q[5] = jaw.minimum + step * static_cast<float>(k);
    run.frame(0);
  }
  const float here = run.egg.q[5];
  run.motion->predict(run.time + kFrame, 0, run.egg.cascade.object, &run.egg.state);
  CHECK(run.egg.state.q[5] == here);
  CHECK(expected.mean.q[5] - here == doctest::Approx(double(step)).epsilon(0.25));
  run.motion->predict(run.time + 2 * kFrame, 1, run.egg.cascade.object, &run.egg.state);
  CHECK(expected.mean.q[5] == here);
  for (int k = 13; k <= 20; ++k) {
    run.egg.q[5] = jaw.minimum + step * static_cast<float>(k);
    run.frame(0);
  }
  REQUIRE(run.egg.q[5] == doctest::Approx(double(jaw.maximum)));
  run.motion->predict(run.time + kFrame, 0, run.egg.cascade.object, &run.egg.state);
  CHECK(expected.mean.q[5] == jaw.maximum);
}

TEST_CASE(
    "a free parameter has its range in the filter, a frozen one none; each is corrected by its own "
    "variance") {
  Run run(false);
  const Span<const Parameter> parameters = run.egg.model.parameters();
  for (std::size_t k = 0; k < parameters.count; ++k) {
    const Parameter& p = parameters[k];
    CHECK(run.motion->filter().ranges()[k] == (p.group == Group::expression ? p.maximum - p.minimum : 0));
  }
  const std::uint16_t bump = run.egg.model.find_parameter("bumpLeft"),
                      jaw = run.egg.model.find_parameter("jawOpen");
  run.variance[kPoseUnknowns + run.egg.cascade->column_of(jaw)] = 100;  // almost not seen
  run.egg.q[bump] = run.egg.q[jaw] = 0.3f;
  run.frame(0);
  CHECK(run.motion->filter().parameters()[bump] > 0.2f);
  CHECK(run.motion->filter().parameters()[jaw] < 0.05f);
}

TEST_CASE("a result that is not finite, and a lost track, end the motion: the next frame starts at rest") {
  for (const bool is_lost : {false, true}) {
    CAPTURE(is_lost);
    Run run(true);
    for (int k = 0; k < 20; ++k) run.frame(3);
    ModelState& state = run.egg.state;
    state.view.tau.x -= 40;
    const ModelState trusted = state;
    if (is_lost) {
      run.motion->rest(trusted);
    } else {
      ModelState broken = state;
      broken.view.tau.x = std::numeric_limits<float>::quiet_NaN();
      run.motion->correct(run.egg.cascade.object, broken, run.variance.data(), trusted);
    }
    CHECK(run.motion->predict(run.time += kFrame, 0, run.egg.cascade.object, &state));
    CHECK(state.view.tau.x == trusted.view.tau.x);
    CHECK(run.motion->filter().pose(kShiftX).velocity == 0);
  }
}

TEST_CASE(
    "after a pause of two seconds, and where time goes back, the motion is forgotten: a frame starts where "
    "it was") {
  for (const std::int64_t step : {kMotionModelTuning.jump_ns, std::int64_t{-5} * kFrame}) {
    Run run(true);
    for (int k = 0; k < 20; ++k) run.frame(3);
    const float here = run.egg.state.view.tau.x;
    CHECK_FALSE(run.motion->predict(run.time += step, 0, run.egg.cascade.object, &run.egg.state));
    CHECK(run.egg.state.view.tau.x == here);
    CHECK(run.motion->filter().pose(kShiftX).velocity == 0);
  }
  Run run(true);
  for (int k = 0; k < 20; ++k) run.frame(3);
  CHECK(run.motion->predict(run.time += kMotionModelTuning.jump_ns - 1, 0, run.egg.cascade.object,
                            &run.egg.state));
}

TEST_CASE(
    "a frame that repeats the time of the one before keeps the motion; steps of less than a millisecond add "
    "up") {
  Run run(true, true), reference(true, true);
  for (Run* each : {&run, &reference})
    for (int k = 0; k < 20; ++k) each->frame(3);
  const float velocity = run.motion->filter().pose(kShiftX).velocity;
  // 0.4 ms more each: the third one is 1.2 ms after the last that counted.
  constexpr std::int64_t kShort = 400'000;
  for (int k = 1; k <= 3; ++k)
    CHECK(run.motion->predict(run.time + k * kShort, 0, run.egg.cascade.object, &run.egg.state) == (k == 3));
  CHECK(velocity > 0);
  reference.motion->predict(run.time + 3 * kShort, 0, reference.egg.cascade.object, &reference.egg.state);
  CHECK(run.motion->filter().pose(kShiftX).velocity == reference.motion->filter().pose(kShiftX).velocity);
  CHECK(run.egg.state.view.tau.x == reference.egg.state.view.tau.x);
  // The smoothed output has had as much time, too.
  for (Run* each : {&run, &reference}) each->time += 3 * kShort;
  for (Run* each : {&run, &reference}) each->frame(3);
  CHECK(run.motion->smoothed_pose().t.x == reference.motion->smoothed_pose().t.x);
}

TEST_CASE(
    "where the clock stands still, or a frame is measured in another way, a smoothed sample counts once, as "
    "usual") {
  for (const bool is_moved : {false, true}) {
    Run run(false, true);
    InArena<Smoother> reference(std::size_t{run.egg.parameters()});
    const auto add = [&](float seconds) {
      REQUIRE(reference->add(pose_of(run.egg.state.view), run.egg.state.q, run.motion->filter().ranges(),
                             run.egg.parameters(), seconds) == Status::ok);
      CHECK(run.motion->smoothed_pose().t.x == reference->pose().t.x);
    };
    add(0);
    run.frame(3);
    add(static_cast<float>(kFrame) * 1e-9f);
    for (int k = 0; k < 3; ++k) {
      run.egg.state.view.tau.x += 3;
      if (is_moved)
        run.motion->move(run.egg.state);
      else
        run.motion->correct(run.egg.cascade.object, run.egg.state, run.variance.data(), run.egg.state);
      add(kMotionModelTuning.nominal_step);
    }
    if (is_moved) {
      run.motion->predict(run.time += kFrame, 0, run.egg.cascade.object, &run.egg.state);
      run.motion->move(run.egg.state);
      add(static_cast<float>(kFrame) * 1e-9f);
    }
    run.frame(3);
    add(static_cast<float>(kFrame) * 1e-9f);
  }
}

TEST_CASE("a state that is measured in another way, and a model that turns, continue at rest from there") {
  const Quat by = exp_rotation({0.1f, -0.2f, 0.05f});
  for (const bool turns : {false, true}) {
    Run run(true, true);
    for (int k = 0; k < 20; ++k) run.frame(3);
    ModelState& state = run.egg.state;
    const Quat smoothed = run.motion->smoothed_pose().q;
    state.view.tau.x += 50;
    if (turns) {
      state.view.q = normalised(state.view.q * by);
      run.motion->turn(state, by);
      CHECK(length(log_rotation(run.motion->smoothed_pose().q * conjugate(smoothed * by))) < 1e-5f);
    } else {
      run.motion->move(state);
    }
    const View there = state.view;
    CHECK(run.motion->predict(run.time += kFrame, 0, run.egg.cascade.object, &state));
    CHECK(state.view.tau.x == there.tau.x);
    CHECK(length(log_rotation(state.view.q * conjugate(there.q))) < 1e-6f);
  }
}

TEST_CASE("the first sample after a lost track is smoothed with none of the track before") {
  Run run(false, true);
  for (int k = 0; k < 10; ++k) run.frame(3);
  run.motion->rest(run.egg.state);
  run.frame(80);
  CHECK(run.motion->smoothed_pose().t.x == pose_of(run.egg.state.view).t.x);
}

TEST_CASE(
    "the time over which a parameter may change is at most half a second, and is not that of a track "
    "before") {
  Run run(false);
  const auto sd = [&](float seconds_more) {
    run.motion->predict(run.time += static_cast<std::int64_t>(1e9f * seconds_more), 0, run.egg.cascade.object,
                        &run.egg.state);
    return run.motion->expected().parameter_sd[5];
  };
  const float longest = sd(0.5f);
  CHECK(sd(0.25f) == doctest::Approx(0.5 * double(longest)));
  CHECK(sd(1.5f) == longest);
  EstimatorOptions options;
  options.time_ns = run.time;
  REQUIRE(run.motion->start(run.egg.cascade.object, run.egg.state, options) == Status::ok);
  CHECK(run.motion->expected().parameter_sd[5] == doctest::Approx(double(longest) / 15));
}

}  // namespace motion_model_test
