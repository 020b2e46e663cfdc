#include "pliant/filter.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "estimate/filter_tuning.hpp"
#include "model_builder.hpp"
#include "random.hpp"

namespace filter_test {

using namespace pliant;

namespace {

constexpr float kRange[2] = {1, 0.5f};
constexpr float kPoseVariance[kPoseUnknowns] = {1e-6f, 1e-6f, 1e-6f, 1e-6f, 1e-2f, 1e-2f};
constexpr float kVariance[2] = {1e-4f, 1e-4f};

struct Motion {
  View view;
  float q[2];
};

View view_at(float turn, Vec2 shift, float z) {
  return view_of({exp_rotation({0.2f * turn, turn, 0}), {shift.x, shift.y, z}},
                 centred_camera(320, 240, 400));
}

/// A steady motion: 0.6 rad/s, 90 mm/s, an expression that opens at half a range a second.
Motion steady(float t) {
  return {view_at(0.6f * t, {90 * t, -40 * t}, 600), {0.5f * t, 0.1f}};
}

struct Rig {
  InArena<MotionFilter> filter{std::size_t{2}};
  explicit Rig(const Motion& m) { REQUIRE(filter->start(m.view, m.q, kRange, 2) == Status::ok); }
  void see(const Motion& m) { REQUIRE(filter->correct(m.view, m.q, kPoseVariance, kVariance) == Status::ok); }
  float turn_off(const Motion& m) const {
    return length(log_rotation(filter.object.view().q * conjugate(m.view.q)));
  }
  float shift_off(const Motion& m) const { return length(filter.object.view().tau - m.view.tau); }
};

}  // namespace

TEST_CASE("a steady motion is predicted to a fifth of its step, at any frame rate") {
  for (const float mean_step : {1.0f / 60, 1.0f / 15}) {
    Rig rig(steady(0));
    Random random(2);
    float t = 0;
    for (int k = 0; k < 60; ++k) {
      const float step = mean_step * random.uniform(0.5f, 1.5f);  // no two frames alike
      t += step;
      rig.filter->predict(step);
      if (k > 20) {
        CHECK(rig.turn_off(steady(t)) < 0.2f * 0.6f * step);
        CHECK(rig.shift_off(steady(t)) < 0.2f * 98 * step);
        CHECK(std::fabs(rig.filter->parameters()[0] - 0.5f * t) < 0.5f * 0.5f * step);
      }
      rig.see(steady(t));
    }
  }
}

TEST_CASE("the covariance is that of the errors: noise at rest stays within three standard deviations") {
  Rig rig(steady(0));
  Random random(3);
  int beyond = 0;
  for (int k = 0; k < 200; ++k) {
    rig.filter->predict(1.0f / 30);
    Motion seen = steady(0);
    seen.view.tau.x += 0.1f * random.normal();
    const float sd = std::sqrt(rig.filter->pose(kShiftX).xx + kPoseVariance[kShiftX]);
    beyond += std::fabs(seen.view.tau.x - rig.filter->view().tau.x) > 3 * sd;
    if (k > 10) CHECK(sd < 8);
    rig.see(seen);
  }
  CHECK(beyond <= 4);
}

TEST_CASE("without measurements the covariance grows and the velocity decays") {
  Rig rig(steady(0));
  float t = 0;
  for (int k = 0; k < 30; ++k, t += 1.0f / 30) {
    rig.filter->predict(k == 0 ? 0 : 1.0f / 30);
    rig.see(steady(t));
  }
  float before = rig.filter->pose(kTurnY).xx, speed = rig.filter->pose(kTurnY).velocity;
  for (int k = 0; k < 20; ++k) {
    rig.filter->predict(1.0f / 30);
    CHECK(rig.filter->pose(kTurnY).xx > before);
    CHECK(std::fabs(rig.filter->pose(kTurnY).velocity) < std::fabs(speed));
    before = rig.filter->pose(kTurnY).xx;
    speed = rig.filter->pose(kTurnY).velocity;
  }
}

TEST_CASE("the variance of a velocity fades by the square of what the velocity fades by") {
  Rig rig(steady(0));
  for (int k = 1; k < 30; ++k) {
    rig.filter->predict(1.0f / 30);
    rig.see(steady(static_cast<float>(k) / 30));
  }
  // Each prediction adds the same, the acceleration's part.
  float velocity[4], variance[4];
  for (int k = 0; k < 4; ++k) {
    velocity[k] = rig.filter->pose(kShiftX).velocity;
    variance[k] = rig.filter->pose(kShiftX).vv;
    rig.filter->predict(0.2f);
  }
  const float fade = velocity[1] / velocity[0];
  REQUIRE(fade < 0.95f);
  const float added = variance[1] - fade * fade * variance[0];
  CHECK(added > 0);
  CHECK(variance[2] - fade * fade * variance[1] == doctest::Approx(double(added)).epsilon(0.01));
  CHECK(variance[3] - fade * fade * variance[2] == doctest::Approx(double(added)).epsilon(0.01));
}

TEST_CASE("a prediction from rest is that of a constant velocity with white acceleration (section 7.10)") {
  Rig rig(steady(0));
  const double t = 1.0 / 30, memory = double(kMotionTuning.pose_memory), fade = memory / (memory + t);
  const float accelerations[kPoseUnknowns] = {
      kMotionTuning.turn_acceleration,  kMotionTuning.turn_acceleration,
      kMotionTuning.turn_acceleration,  kMotionTuning.log_scale_acceleration,
      kMotionTuning.shift_acceleration, kMotionTuning.shift_acceleration};
  for (int k = 0; k < 3; ++k) rig.filter->predict(1.0f / 30);
  for (int unknown = 0; unknown < kPoseUnknowns; ++unknown) {
    const double a = double(accelerations[unknown]), v0 = double(kMotionTuning.start_time) * a;
    double xx = 0, xv = 0, vv = v0 * v0;
    for (int k = 0; k < 3; ++k) {
      xx += 2 * t * xv + t * t * vv + a * a * t * t * t * t / 4;
      xv = fade * (xv + t * vv) + a * a * t * t * t / 2;
      vv = fade * fade * vv + a * a * t * t;
    }
    const MotionState& s = rig.filter->pose(unknown);
    CHECK(double(s.xx) == doctest::Approx(xx).epsilon(1e-5));
    CHECK(double(s.xv) == doctest::Approx(xv).epsilon(1e-5));
    CHECK(double(s.vv) == doctest::Approx(vv).epsilon(1e-5));
  }
}

TEST_CASE(
    "a measurement is weighed by Kalman's gain; one without error, and one far beyond, is taken as it is") {
  Rig rig(steady(0));
  rig.filter->predict(1.0f / 30);
  const MotionState before = rig.filter->pose(kShiftX);
  Motion seen = steady(0);
  const double was = double(rig.filter->view().tau.x);
  seen.view.tau.x += 10;
  const float variance[kPoseUnknowns] = {1, 1, 1, 1, 2 * before.xx, 1};
  REQUIRE(rig.filter->correct(seen.view, seen.q, variance, kVariance) == Status::ok);
  const MotionState after = rig.filter->pose(kShiftX);
  const double all = 3 * double(before.xx), gain = double(before.xx) / all,
               of_speed = double(before.xv) / all;
  CHECK(double(rig.filter->view().tau.x) - was == doctest::Approx(10 * gain).epsilon(1e-4));
  CHECK(double(after.velocity) == doctest::Approx(10 * of_speed).epsilon(1e-4));
  CHECK(double(after.xx) == doctest::Approx((1 - gain) * double(before.xx)).epsilon(1e-5));
  CHECK(double(after.xv) == doctest::Approx((1 - gain) * double(before.xv)).epsilon(1e-5));
  CHECK(double(after.vv) == doctest::Approx(double(before.vv) - of_speed * double(before.xv)).epsilon(1e-5));
  const float here = rig.filter->view().tau.x;
  rig.filter->predict(1.0f / 30);
  CHECK(double(rig.filter->view().tau.x - here) ==
        doctest::Approx(double(after.velocity) / 30).epsilon(1e-4));
  seen.view.tau.x += 2000;
  REQUIRE(rig.filter->correct(seen.view, seen.q, variance, kVariance) == Status::ok);
  CHECK(rig.filter->view().tau.x == doctest::Approx(double(seen.view.tau.x)));
  CHECK(rig.filter->pose(kShiftX).xx == variance[kShiftX]);
  CHECK(rig.filter->pose(kShiftX).xv == 0);
  const float none[kPoseUnknowns] = {}, none_of_parameters[2] = {};
  rig.filter->move_to(steady(0).view, steady(0).q);
  const Motion exact = steady(0.02f);
  REQUIRE(rig.filter->correct(exact.view, exact.q, none, none_of_parameters) == Status::ok);
  CHECK(rig.shift_off(exact) < 1e-4f);
  for (int i : {0, 1}) CHECK(rig.filter->parameters()[i] == exact.q[i]);  // the second is where it was
  const View nearer =
      view_at(0.012f, {1.8f, -0.8f}, 594);  // by a hundredth, of which the square does not count
  REQUIRE(rig.filter->correct(nearer, exact.q, none, none_of_parameters) == Status::ok);
  CHECK(magnitude(rig.filter->view().s / nearer.s - 1) < 1e-4f);
}

TEST_CASE("after a jump the filter is at the new place, at rest") {
  Rig rig(steady(0));
  for (int k = 0; k < 20; ++k) {
    rig.filter->predict(1.0f / 30);
    rig.see(steady(0));
  }
  Motion far = steady(0);
  far.view.tau.x += 400;
  rig.filter->predict(1.0f / 30);
  rig.see(far);
  CHECK(rig.shift_off(far) < 1);
  rig.filter->predict(1.0f / 30);
  CHECK(rig.shift_off(far) < 5);
}

TEST_CASE("a parameter without a range is as it was measured last, whatever the variance of that") {
  AlignedBlock block(measured_bytes<MotionFilter>(std::size_t{2}));
  Arena arena(block.data(), block.size());
  MotionFilter filter;
  REQUIRE(create_in(arena, filter, std::size_t{2}) == Status::ok);
  const View view = steady(0).view;
  const float range[2] = {1, 0}, at_start[2] = {0, 0}, measured[2] = {0.1f, 0.1f};
  REQUIRE(filter.start(view, at_start, range, 2) == Status::ok);
  for (const float variance : {1.0f, 1e-6f, 0.0f, 1.0f}) {
    const float of_pose[kPoseUnknowns] = {1, 1, 1, 1, 1, 1}, of_parameters[2] = {variance, variance};
    filter.predict(1.0f / 30);
    REQUIRE(filter.correct(view, measured, of_pose, of_parameters) == Status::ok);
    CHECK(filter.parameters()[1] == 0.1f);
    filter.move_to(view, at_start);
  }
}

TEST_CASE("time steps of zero, below zero and NaN change nothing, an infinite one counts as a second") {
  Rig rig(steady(0));
  rig.see(steady(0.1f));
  const View before = rig.filter->view();
  const float variance = rig.filter->pose(kTurnX).xx;
  for (float t : {0.0f, -1.0f, std::numeric_limits<float>::quiet_NaN()}) rig.filter->predict(t);
  CHECK(rig.filter->view().tau.x == before.tau.x);
  CHECK(rig.filter->pose(kTurnX).xx == variance);
  rig.filter->predict(std::numeric_limits<float>::infinity());
  CHECK(is_finite(rig.filter->view().tau));
  CHECK(rig.filter->view().s > 0);
}

TEST_CASE("values that are not finite are refused and change nothing; a restored state is at rest") {
  Rig rig(steady(0));
  rig.see(steady(0.05f));
  const View before = rig.filter->view();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Motion bad = steady(0.1f);
  bad.q[1] = nan;
  CHECK(rig.filter->correct(bad.view, bad.q, kPoseVariance, kVariance) == Status::bad_argument);
  bad = steady(0.1f);
  bad.view.q.x = nan;
  CHECK(rig.filter->correct(bad.view, bad.q, kPoseVariance, kVariance) == Status::bad_argument);
  float negative[kPoseUnknowns] = {-1};
  CHECK(rig.filter->correct(steady(0).view, steady(0).q, negative, kVariance) == Status::bad_argument);
  CHECK(rig.filter->correct(steady(0).view, nullptr, kPoseVariance, kVariance) == Status::bad_argument);
  for (float View::*const number : {&View::s, &View::rho})
    for (const float wrong : {0.0f, -1.0f}) {
      bad = steady(0.1f);
      bad.view.*number = wrong;
      CHECK(rig.filter->correct(bad.view, bad.q, kPoseVariance, kVariance) == Status::bad_argument);
    }
  CHECK(rig.filter->view().tau.x == before.tau.x);
  CHECK(rig.filter->start(before, bad.q, kRange, 3) == Status::capacity);
  CHECK(rig.filter->start(before, nullptr, kRange, 2) == Status::bad_argument);
  const Motion there = steady(2);
  rig.filter->move_to(there.view, there.q);
  rig.filter->predict(0.1f);
  CHECK(rig.shift_off(there) == 0);
  rig.see(steady(2.1f));
  rig.filter->forget_velocities();
  CHECK(rig.filter->pose(kShiftX).velocity == 0);
}

TEST_CASE(
    "smoothing is the One-Euro filter in shift, turn and parameters, each with its own speed (section "
    "7.10)") {
  InArena<Smoother> smooth(std::size_t{2});
  const SmoothingTuning t = kSmoothingTuning;
  const auto gain = [](double cutoff_hz, double seconds) {
    const double x = 2 * 3.14159265358979 * cutoff_hz * seconds;
    return x / (1 + x);
  };
  // Along one axis each, as the distance from the place at the start: all of them move alike but for their units.
  struct Track {
    double value, speed, per_speed;
  } shift{0, 0, double(t.shift_gain)}, turn{0, 0, double(t.turn_gain)},
      narrow{0, 0, double(t.parameter_gain) / double(kRange[1])};
  const auto follow = [&](Track& track, double target, double seconds) {
    const double step = target - track.value;
    track.speed += gain(double(t.speed_cutoff), seconds) * (step / seconds - track.speed);
    track.value += gain(double(t.least_cutoff) + track.per_speed * std::fabs(track.speed), seconds) * step;
  };
  const Quat start = exp_rotation({0.3f, -0.5f, 0.2f});
  const Vec3 axis{0, 0.6f, 0.8f};  // of the camera
  REQUIRE(smooth->add({start, {5, 5, 600}}, kRange, kRange, 2, 0) == Status::ok);
  const float way[] = {0.2f, 0.5f, 0.45f, 0.9f, 0.9f, 0.1f};
  int k = 0;
  for (const float at : way) {
    const float seconds = ++k % 2 == 0 ? 1.0f / 30 : 1.0f / 15;
    const float q[2] = {kRange[0], kRange[1] + 0.2f * at};
    const Pose pose{normalised(exp_rotation((0.8f * at) * axis) * start), {5, 5 + 40 * at, 600}};
    REQUIRE(smooth->add(pose, q, kRange, 2, seconds) == Status::ok);
    follow(shift, 40 * double(at), double(seconds));
    follow(turn, 0.8 * double(at), double(seconds));
    follow(narrow, 0.2 * double(at), double(seconds));
    CHECK(double(smooth->pose().t.y) - 5 == doctest::Approx(shift.value).epsilon(1e-4));
    const Vec3 turned = log_rotation(smooth->pose().q * conjugate(start));
    CHECK(length(turned - static_cast<float>(turn.value) * axis) < 1e-5f);
    CHECK(double(smooth->parameters()[1] - kRange[1]) == doctest::Approx(narrow.value).epsilon(1e-4));
    CHECK(smooth->parameters()[0] == kRange[0]);
  }
  // The next sample after a restart is taken unchanged, and so are the speeds: those of rest.
  InArena<Smoother> fresh(std::size_t{2});
  smooth->restart();
  for (const float x : {0.0f, 30.0f}) {
    const Pose pose{start, {x, 0, 600}};
    const float q[2] = {kRange[0], 0.1f + 0.01f * x};
    for (Smoother* each : {&smooth.object, &fresh.object})
      REQUIRE(each->add(pose, q, kRange, 2, 0.04f) == Status::ok);
    CHECK(smooth->pose().t.x == fresh->pose().t.x);
    CHECK(smooth->parameters()[1] == fresh->parameters()[1]);
  }
}

TEST_CASE("what is forgotten of a motion are the velocities: places and their variances stay") {
  Rig rig(steady(0));
  for (int k = 1; k < 20; ++k) {
    rig.filter->predict(1.0f / 30);
    rig.see(steady(static_cast<float>(k) / 30));
  }
  rig.filter->predict(1.0f / 30);
  const View view = rig.filter->view();
  const float q = rig.filter->parameters()[0], xx = rig.filter->pose(kTurnY).xx;
  REQUIRE(rig.filter->pose(kTurnY).velocity != 0);
  rig.filter->forget_velocities();
  CHECK(rig.filter->pose(kTurnY).velocity == 0);
  CHECK(rig.filter->pose(kTurnY).xv == 0);
  CHECK(rig.filter->pose(kTurnY).xx == xx);
  rig.filter->predict(1.0f / 30);
  CHECK(length(rig.filter->view().tau - view.tau) == 0);
  CHECK(rig.filter->parameters()[0] == q);
}

TEST_CASE("the scale of an approach is predicted as its logarithm") {
  const auto at = [](float t) { return Motion{view_at(0, {0, 0}, 600 * (1 - 0.5f * t)), {0, 0}}; };
  Rig rig(at(0));
  for (int k = 1; k <= 20; ++k) {
    const float t = static_cast<float>(k) / 60, before = rig.filter->view().s;
    rig.filter->predict(1.0f / 60);
    if (k >
        10) {  // it grows with the square of the distance's inverse: a sixth of a step is what a velocity lags behind
      const float step = at(t).view.s - at(t - 1.0f / 60).view.s;
      CHECK(magnitude(rig.filter->view().s - at(t).view.s) < 0.2f * step);
      CHECK(rig.filter->view().s > before);
    }
    rig.see(at(t));
  }
}

TEST_CASE("smoothing reduces noise at rest and lags little in motion") {
  InArena<Smoother> smooth(std::size_t{2});
  Random random(5);
  const float dt = 1.0f / 30;
  float raw = 0, shown = 0, lag = 0;
  Pose last = pose_of(steady(0).view), last_raw = last;
  for (int k = 0; k < 200; ++k) {
    const bool moves = k >= 120;
    const Motion m = steady(moves ? dt * static_cast<float>(k - 120) : 0);
    Pose noisy = pose_of(m.view);
    noisy.t.x += random.normal();
    const float q[2] = {m.q[0] + 0.01f * random.normal(), m.q[1]};
    REQUIRE(smooth->add(noisy, q, kRange, 2, dt) == Status::ok);
    if (k > 10 && !moves) {
      raw += std::fabs(noisy.t.x - last_raw.t.x);
      shown += std::fabs(smooth->pose().t.x - last.t.x);
    }
    if (k > 150) lag = max(lag, std::fabs(smooth->pose().t.x - m.view.tau.x));
    last = smooth->pose();
    last_raw = noisy;
  }
  CHECK(shown < 0.4f * raw);
  CHECK(lag < 90 * 0.12f);  // an eighth of a second
  const Pose before = smooth->pose();
  const float bad[2] = {std::numeric_limits<float>::infinity(), 0};
  CHECK(smooth->add(before, bad, kRange, 2, dt) == Status::bad_argument);
  CHECK(smooth->add(before, kRange, kRange, 2, 0) == Status::bad_argument);
  CHECK(smooth->add(before, kRange, kRange, 3, dt) == Status::capacity);
  CHECK(smooth->pose().t.x == before.t.x);
  smooth->restart();
  Pose far = before;
  far.t.x += 500;
  REQUIRE(smooth->add(far, kRange, kRange, 2, 0) == Status::ok);
  CHECK(smooth->pose().t.x == far.t.x);
}

TEST_CASE("a parameter that is held is not smoothed: it changes at once, as the pose does with it") {
  InArena<Smoother> smooth(std::size_t{2});
  const float range[2] = {1, 0}, before[2] = {0, 0}, after[2] = {1, 1};
  const Pose pose = pose_of(steady(0).view);
  REQUIRE(smooth->add(pose, before, range, 2, 1 / 30.0f) == Status::ok);
  REQUIRE(smooth->add(pose, after, range, 2, 1 / 30.0f) == Status::ok);
  CHECK(smooth->parameters()[0] < 0.9f);
  CHECK(smooth->parameters()[1] == 1);
}

TEST_CASE("the smoothed result stays finite, however short or long the time and however small a range") {
  constexpr float kNarrow[2] = {1, 1e-39f};
  for (const float seconds : {1e-45f, 1e-39f, 1e-30f, 1e-6f, 1e6f, 1e30f, 3e38f}) {
    CAPTURE(seconds);
    InArena<Smoother> smooth(std::size_t{2});
    for (int k = 0; k < 4; ++k) {
      const Motion m = steady(static_cast<float>(k));
      const Status status = smooth->add(pose_of(m.view), m.q, kNarrow, 2, seconds);
      CHECK(status == (k == 0 || seconds >= 1e-6f ? Status::ok : Status::bad_argument));
    }
    CHECK(is_finite(smooth->pose()));
    CHECK(std::isfinite(smooth->parameters()[0]));
    CHECK(std::isfinite(smooth->parameters()[1]));
  }
}

}  // namespace filter_test
