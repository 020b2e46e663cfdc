// A rendered person who is not the neutral one, at 640 x 480: tracked from 68 landmarks with half a pixel of noise, who it
// is unknown, and compared with what was drawn.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "face_film.hpp"
#include "model_builder.hpp"
#include "pliant/tracker.hpp"
#include "random.hpp"
#include "track/landmark_fit.hpp"

namespace pose_truth_test {

using namespace pliant;

namespace {

constexpr int kWidth = 640, kHeight = 480, kFrames = 72;

float wave(float turns) {
  return std::sin(6.2831853f * turns);
}
float rise(float turns) {  // 0 at the start, 1 at half a turn
  return 0.5f - 0.5f * std::cos(6.2831853f * turns);
}

/// 35 degrees of yaw to either side with a nod; talks, smiles, raises the brows.
const FaceFilm& film() {
  static const FaceFilm* one = new FaceFilm(
      kWidth, kHeight, kFrames,
      [](float s, Pose& pose, auto& q) {
        pose.q = exp_rotation({0.15f * wave(1.7f * s), 0, 0}) * exp_rotation({0, 0.61f * wave(s), 0});
        pose.t = pose.t + Vec3{20 * wave(0.9f * s), 8 * wave(1.3f * s), 40 * wave(0.7f * s)};
        FaceFilm::set(q, "faceWidth", 0.8f);
        FaceFilm::set(q, "lowerFaceHeight", -0.7f);
        FaceFilm::set(q, "jawWidth", 1.1f);
        FaceFilm::set(q, "noseLength", 0.9f);
        FaceFilm::set(q, "noseProtrusion", 0.7f);
        FaceFilm::set(q, "mouthWidth", 0.6f);
        FaceFilm::set(q, "jawOpen", 0.25f * rise(4 * s));
        for (const char* name : {"mouthSmileLeft", "mouthSmileRight"}) FaceFilm::set(q, name, 0.6f * rise(s));
        for (const char* name :
             {"browInnerUpLeft", "browInnerUpRight", "browOuterUpLeft", "browOuterUpRight"})
          FaceFilm::set(q, name, 0.6f * rise(2 * s));
      },
      0.6f);
  return *one;
}

struct Result {
  std::vector<float> turn, relative;  // degrees, ascending
  std::vector<float> expression;      // mean absolute error of each, in ranges
  std::size_t tracking = 0;
};

float degrees(const Quat& q) {
  return 57.29578f * length(log_rotation(q));
}

std::vector<float> landmarks_start(Camera* camera, Pose* pose) {
  const Model& model = baked_face().model;
  Random random(5);
  std::vector<Correspondence> points;
  for (const Landmark& l : model.landmarks())
    if (std::string(l.name).rfind("ibug", 0) == 0)
      points.push_back(
          {l.uv(), film().truth(l.name, 0) + Vec2{0.5f * random.normal(), 0.5f * random.normal()}, 1, false});
  FitOptions options;
  options.width = kWidth;
  options.height = kHeight;
  options.focal_px = film().camera.f;
  std::vector<float> q(model.parameters().count);
  InArena<LandmarkFit> fit(model, points.size());
  REQUIRE(fit->fit({points.data(), points.size()}, options, q.data()) == Status::ok);
  *camera = camera_of(fit->report().view);
  *pose = pose_of(fit->report().view);
  return q;
}

Result run() {
  const Model& model = baked_face().model;
  Camera camera;
  Pose pose;
  const std::vector<float> q = landmarks_start(&camera, &pose);
  InArena<Tracker> tracker(model, profile_l());
  REQUIRE(tracker->start_from_pose(film().view(0), camera, pose, q.data()) == Status::ok);
  const Quat offset = conjugate(film().poses[0].q) * pose.q;
  Result r;
  r.expression.assign(model.parameters().count, 0.0f);
  for (std::size_t k = 1; k < kFrames; ++k) {
    FrameResult result;
    REQUIRE(tracker->update(film().view(k), &result) == Status::ok);
    r.tracking += result.state == TrackState::tracking;
    r.turn.push_back(film().turn_error(result.pose, k));
    r.relative.push_back(degrees(conjugate(film().poses[k].q) * result.pose.q * conjugate(offset)));
    for (std::size_t i = 0; i < r.expression.size(); ++i) {
      const Parameter& p = model.parameters()[i];
      if (p.group != Group::expression) continue;
      r.expression[i] += magnitude(tracker->estimator().parameters()[i] - film().parameters[k][i]) /
                         ((p.maximum - p.minimum) * static_cast<float>(kFrames - 1));
    }
  }
  std::sort(r.turn.begin(), r.turn.end());
  std::sort(r.relative.begin(), r.relative.end());
  return r;
}

float at(const std::vector<float>& ascending, float fraction) {
  return ascending[static_cast<std::size_t>(fraction * static_cast<float>(ascending.size() - 1))];
}

}  // namespace

TEST_CASE("an unknown head is tracked through 35 degrees, with its expressions") {
  const Result r = run();
  MESSAGE("rotation, frame 0's error taken out: median "
          << at(r.relative, 0.5f) << ", 95 % " << at(r.relative, 0.95f)
          << " degrees; as it is: " << at(r.turn, 0.5f) << ", " << at(r.turn, 0.95f));
  CHECK(r.tracking == kFrames - 1);
  CHECK(at(r.relative, 0.5f) < 0.5f);
  CHECK(at(r.relative, 0.95f) < 1.5f);
  float sum = 0, count = 0;
  for (std::size_t i = 0; i < r.expression.size(); ++i) {
    const Parameter& p = baked_face().model.parameters()[i];
    if (p.group != Group::expression) continue;
    sum += r.expression[i];
    ++count;
    if (r.expression[i] > 0.1f) MESSAGE(p.name << " is off by " << r.expression[i] << " of its range");
    CHECK(r.expression[i] < 0.1f);
  }
  CHECK(sum / count < 0.06f);
}

}  // namespace pose_truth_test
