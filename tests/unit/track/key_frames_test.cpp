// Key frames by themselves: which views are kept, which one is replaced, and what thumbnails tell of the motion.
#include "track/key_frames.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "face_film.hpp"
#include "model_builder.hpp"
#include "pliant/tracker_profiles.hpp"
#include "track/tracker_sizes.hpp"

namespace key_frames_test {

using namespace pliant;

namespace {

/// Two views of a face: the second one is moved by (24, 8) px.
const FaceFilm& film() {
  static const FaceFilm* one = new FaceFilm(320, 240, 2, [](float s, Pose& pose, auto&) {
    const float mm_per_px = pose.t.z / 400;
    pose.t = pose.t + mm_per_px * Vec3{24 * s, 8 * s, 0};
  });
  return *one;
}

struct Rig {
  TrackerLimits limits;
  InArena<Estimator> estimator{baked_face().model, EstimatorLimits{}};
  InArena<KeyFrames> keys;
  FrameResult good;

  explicit Rig(const TrackerLimits& l = {}) : limits(l), keys(l) {
    keys->clear();
    start(film().poses[0]);
    keys->take(film().view(0));
    keys->trust(estimator.object);
    good.tracked = good.inliers = 100;
    good.rms_px = 0.3f;
  }
  void start(const Pose& pose) {
    REQUIRE(estimator->start(film().camera, 320, 240, pose, film().parameters[0].data(), nullptr, {}) ==
            Status::ok);
  }
  View turned(float yaw) const {
    Pose pose = film().poses[0];
    pose.q = exp_rotation({0, yaw, 0});
    return view_of(pose, film().camera);
  }
};

}  // namespace

TEST_CASE("the translation between two thumbnails is the model's, in pixels of the frame") {
  Rig rig;
  rig.keys->take(film().view(1));
  const CoarseMotion motion = rig.keys->find_motion(0);
  REQUIRE(motion.is_found);
  CHECK(motion.from == nullptr);
  CHECK(motion.compared_pixels > 0);
  CHECK(motion.by_px.x == doctest::Approx(24).epsilon(0.1));
  CHECK(motion.by_px.y == doctest::Approx(8).epsilon(0.2));
}

TEST_CASE("bands of light that move over the picture are not taken for the model's motion") {
  Rig rig;
  const auto lit = [](int view, double phase) {
    std::vector<std::uint8_t> pixels(320 * 240);
    const FrameView from = film().view(static_cast<std::size_t>(view));
    for (std::size_t k = 0; k < pixels.size(); ++k)
      pixels[k] = static_cast<std::uint8_t>(std::min(
          255.0, from.data[k] * (1 + 0.35 * std::sin(6.28 * (static_cast<double>(k / 320) / 140 + phase)))));
    return pixels;
  };
  const std::vector<std::uint8_t> before = lit(0, 0);
  rig.keys->take(view_of_pixels(before, 320, 240, 0));
  rig.keys->trust(rig.estimator.object);
  for (const double phase : {0.1, 0.27, 0.4}) {
    const std::vector<std::uint8_t> now = lit(1, phase);
    rig.keys->take(view_of_pixels(now, 320, 240, 1));
    const CoarseMotion motion = rig.keys->find_motion(0);
    REQUIRE(motion.is_found);
    CHECK(motion.by_px.x == doctest::Approx(24).epsilon(0.1));
    CHECK(motion.by_px.y == doctest::Approx(8).epsilon(0.25));
  }
}

TEST_CASE("a black frame has no translation") {
  Rig rig;
  const std::vector<std::uint8_t> black(320 * 240, 0);
  rig.keys->take(view_of_pixels(black, 320, 240, 1));
  CHECK_FALSE(rig.keys->find_motion(0).is_found);
}

TEST_CASE("a cut is another picture than the last good one, for two frames") {
  const FaceFilm cut(320, 240, 1, [](float, Pose& pose, auto&) {
    pose.t = 1.4f * pose.t + Vec3{80, -40, 0};
  });
  const FrameView other = cut.view(0);
  const std::vector<std::uint8_t> black(320 * 240, 0);
  const FrameView nothing = view_of_pixels(black, 320, 240, 1);
  const auto is_cut = [](Rig& rig, const FrameView& frame) {
    rig.keys->take(frame);
    return rig.keys->is_lasting_cut();
  };
  Rig rig;
  SUBCASE("told in the second one") {
    CHECK_FALSE(is_cut(rig, other));
    CHECK(rig.keys->shows_another_picture());
    CHECK(is_cut(rig, other));
    rig.keys->trust(rig.estimator.object);
    CHECK_FALSE(is_cut(rig, other));
    CHECK_FALSE(is_cut(rig, film().view(0)));
    CHECK(is_cut(rig, film().view(0)));
  }
  SUBCASE("a flash is none, nor is a picture that goes on") {
    CHECK_FALSE(is_cut(rig, other));
    CHECK_FALSE(is_cut(rig, film().view(0)));
    CHECK_FALSE(is_cut(rig, film().view(1)));
  }
  SUBCASE("black frames are none") {
    for (int k = 0; k < 3; ++k) CHECK_FALSE(is_cut(rig, nothing));
  }
  SUBCASE("nor are they told without second looks") {
    Rig small(profile_s());
    for (int k = 0; k < 3; ++k) CHECK_FALSE(is_cut(small, other));
  }
}

TEST_CASE("after two bad frames the key frames take turns with the last good frame, over the whole image") {
  Rig rig;
  rig.keys->keep(0, rig.turned(0), 0.3f, 0);
  rig.keys->take(film().view(1));
  const CoarseMotion from_last = rig.keys->find_motion(1);
  CHECK(from_last.from == nullptr);
  const CoarseMotion from_key = rig.keys->find_motion(2);  // turn 1: key frame 0
  REQUIRE(from_key.from != nullptr);
  CHECK(from_key.compared_pixels > 3 * from_last.compared_pixels);
  CHECK(from_key.by_px.x == doctest::Approx(24).epsilon(0.1));
  CHECK(rig.keys->find_motion(3).from == nullptr);  // key frame 1 is not in use
}

TEST_CASE("a view is kept when it is far from all key frames and the frame is good") {
  Rig rig;
  rig.keys->keep(0, rig.turned(0), 0.3f, 0);
  CHECK(rig.keys->count() == 1);
  CHECK(rig.keys->choose(rig.turned(0.3f), rig.good, 1) == 0);
  CHECK(rig.keys->choose(rig.turned(0.4f), rig.good, 1) == 1);
  FrameResult bad = rig.good;
  bad.inliers = 70;
  CHECK(rig.keys->choose(rig.turned(0.4f), bad, 1) == 0);
  // A roll about the optical axis shows nothing new.
  Pose rolled = film().poses[0];
  rolled.q = exp_rotation({0, 0, 0.8f});
  CHECK(rig.keys->choose(view_of(rolled, film().camera), rig.good, 1) == 0);
}

TEST_CASE(
    "a key frame with a large residual is replaced by the first better frame of its side, and only once") {
  Rig rig;
  rig.keys->keep(0, rig.turned(0), 0, 0);
  FrameResult doubtful = rig.good;
  doubtful.rms_px = 1.5f;
  CHECK(rig.keys->choose(rig.turned(0.4f), doubtful, 1) == 1);
  rig.keys->keep(1, rig.turned(0.4f), doubtful.rms_px, 1);
  CHECK(rig.keys->choose(rig.turned(0.5f), doubtful, 2) == 0);  // no better
  CHECK(rig.keys->choose(rig.turned(0.1f), rig.good, 3) == 0);  // nearer to frame 0
  CHECK(rig.keys->choose(rig.turned(0.3f), rig.good, 4) == 1);
  rig.keys->keep(1, rig.turned(0.3f), rig.good.rms_px, 4);
  CHECK(rig.keys->choose(rig.turned(0.4f), rig.good, 5) == 0);
  CHECK(rig.keys->count() == 2);
}

TEST_CASE("without a free key frame the one that was nearest longest ago is replaced, never frame 0") {
  TrackerLimits limits;
  limits.key_frames = 2;
  Rig rig(limits);
  rig.keys->keep(0, rig.turned(0), 0.3f, 0);
  rig.keys->keep(1, rig.turned(0.5f), 0.3f, 10);
  rig.keys->keep(2, rig.turned(-0.5f), 0.3f, 20);
  CHECK(rig.keys->choose(rig.turned(1.0f), rig.good, 30) == 2);   // key frame 1 is the nearest now
  CHECK(rig.keys->choose(rig.turned(-1.0f), rig.good, 40) == 1);  // and key frame 2
  CHECK(rig.keys->count() == 3);
}

TEST_CASE("a view is kept when the face is larger or smaller than in all key frames from its side") {
  Rig rig;
  const auto scaled = [&rig](float ratio, float yaw) {
    View view = rig.turned(yaw);
    view.s *= ratio;
    return view;
  };
  rig.keys->keep(0, scaled(1, 0), 0.3f, 0);
  CHECK(rig.keys->choose(scaled(1.4f, 0), rig.good, 1) == 0);
  CHECK(rig.keys->choose(scaled(0.7f, 0), rig.good, 1) == 0);
  CHECK(rig.keys->choose(scaled(0.6f, 0), rig.good, 1) == 1);
  CHECK(rig.keys->choose(scaled(1.6f, 0), rig.good, 1) == 1);
  rig.keys->keep(1, scaled(1.6f, 0), 0.3f, 1);
  CHECK(rig.keys->choose(scaled(2.3f, 0), rig.good, 2) == 0);
  CHECK(rig.keys->choose(scaled(2.3f, 0.4f), rig.good, 2) == 2);  // nor from this side
  CHECK(rig.keys->choose(scaled(2.5f, 0), rig.good, 2) == 2);
}

TEST_CASE("without room for its templates no key frame is kept") {
  TrackerLimits limits;
  limits.key_patches = 0;
  Rig rig(limits);
  rig.keys->keep(0, rig.turned(0), 0.3f, 0);
  CHECK(rig.keys->choose(rig.turned(1), rig.good, 1) == 0);
}

}  // namespace key_frames_test
