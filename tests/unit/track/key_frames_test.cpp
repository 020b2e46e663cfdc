// Key frames by themselves: which views are kept, which one is replaced, and what thumbnails tell of the motion.
#include "track/key_frames.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "face_film.hpp"
#include "model_builder.hpp"
#include "pliant/tracker_profiles.hpp"
#include "random.hpp"
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
  const CoarseMotion motion = rig.keys->find_motion(0);
  CHECK_FALSE(motion.is_found);
  CHECK(motion.compared_pixels > 0);  // it was work all the same
}

TEST_CASE("a frame that resembles the last good one a little has no translation") {
  Rig rig;
  std::vector<std::uint8_t> noisy(320 * 240);
  Random random(3);
  const FrameView of = film().view(0);
  for (std::size_t y = 0; y < 240; y += 8)
    for (std::size_t x = 0; x < 320; x += 8) {
      const int noise = random.below(200);
      for (std::size_t k = 0; k < 64; ++k) {
        const std::size_t at = (y + k / 8) * 320 + x + k % 8;
        noisy[at] = static_cast<std::uint8_t>((of.data[at] + 4 * noise) / 5);
      }
    }
  rig.keys->take(view_of_pixels(noisy, 320, 240, 1));
  CHECK_FALSE(rig.keys->find_motion(0).is_found);
}

TEST_CASE("a search expects the shift that the last one has found, since the last good frame") {
  Rig rig;
  const auto moved_by = [](float dx) {  // a pattern that repeats every 40 px
    std::vector<std::uint8_t> pixels;
    for (int k = 0; k < 320 * 240; ++k)
      pixels.push_back(
          static_cast<std::uint8_t>(128 + 100 * std::sin(0.15708f * (static_cast<float>(k % 320) - dx)) *
                                              std::sin(0.15708f * static_cast<float>(k / 320))));
    return pixels;
  };
  const std::vector<std::uint8_t> before = moved_by(0);
  rig.keys->take(view_of_pixels(before, 320, 240, 0));
  rig.keys->trust(rig.estimator.object);
  for (const float dx : {12.0f, 24.0f, 32.0f}) {  // 24 is -16, too
    const std::vector<std::uint8_t> now = moved_by(dx);
    rig.keys->take(view_of_pixels(now, 320, 240, 1));
    CHECK(rig.keys->find_motion(0).by_px.x == doctest::Approx(static_cast<double>(dx)).epsilon(0.1));
  }
}

TEST_CASE("the middle of the model is that of its vertices in the image, to a pixel of the thumbnail") {
  Rig rig;
  Vec2 low{1e9f, 1e9f}, high{-1e9f, -1e9f};
  for (const VertexId v : rig.estimator->mesh().vertices()) {
    low = min(low, rig.estimator->vertex_seen(v));
    high = max(high, rig.estimator->vertex_seen(v));
  }
  CHECK(length(rig.keys->middle_of(rig.estimator.object) - 0.5f * (low + high)) < 4);
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

TEST_CASE("each key frame in use has its turn, from its own picture and its own place") {
  TrackerLimits limits;
  limits.key_frames = 1;
  Rig rig(limits);
  rig.keys->keep(0, rig.turned(0), 0.3f, 0);
  rig.keys->take(film().view(1));
  rig.start(film().poses[1]);
  rig.keys->trust(rig.estimator.object);
  rig.keys->keep(1, rig.turned(0.5f), 0.3f, 1);
  Pose away = film().poses[1];
  away.t.x += 10 * away.t.z;  // the last good place tells nothing
  rig.start(away);
  rig.keys->trust(rig.estimator.object);
  rig.keys->take(film().view(0));
  for (const int bad_frames : {2, 5}) {
    const CoarseMotion of_first = rig.keys->find_motion(bad_frames),
                       of_second = rig.keys->find_motion(bad_frames + 1);
    REQUIRE(of_first.is_found);
    CHECK(of_first.from == rig.keys->view_of(0));
    CHECK(length(of_first.by_px) < 1);
    REQUIRE(of_second.is_found);
    CHECK(of_second.from == rig.keys->view_of(1));
    CHECK(of_second.by_px.x == doctest::Approx(-24).epsilon(0.1));
    CHECK_FALSE(rig.keys->find_motion(bad_frames + 2).is_found);
  }
}

TEST_CASE("a search after a bad frame reaches farther: 44 instead of 36 px") {
  const FrameView of = film().view(0);
  std::vector<std::uint8_t> moved(320 * 240);
  for (std::size_t k = 0; k < moved.size(); ++k) moved[k] = of.data[k - (k % 320 < 44 ? k % 320 : 44)];
  for (const int bad_frames : {0, 1}) {
    Rig rig;
    rig.keys->take(view_of_pixels(moved, 320, 240, 1));
    const CoarseMotion motion = rig.keys->find_motion(bad_frames);
    CHECK((motion.is_found && magnitude(motion.by_px.x - 44) < 3) == (bad_frames == 1));
  }
}

TEST_CASE("a turn of the model turns all key frames, and where they saw it from") {
  Rig rig;
  rig.keys->keep(0, rig.turned(0), 0.3f, 0);
  rig.keys->keep(1, rig.turned(0.5f), 0.3f, 0);
  const Quat turn = exp_rotation({0.2f, -0.1f, 0.4f});
  const Vec3 point{30, -50, 20};
  const Vec3 in_camera_axes = rotation_matrix(turn) * Vec3{point.x, -point.y, -point.z};
  const Vec3 turned{in_camera_axes.x, -in_camera_axes.y, -in_camera_axes.z};
  Vec2 before[2];
  for (std::size_t k = 0; k < 2; ++k)
    REQUIRE(Projector(*rig.keys->view_of(k), true).project(turned, &before[k]));
  rig.keys->turn(turn);
  for (std::size_t k = 0; k < 2; ++k) {
    Vec2 now;
    REQUIRE(Projector(*rig.keys->view_of(k), true).project(point, &now));
    CHECK(length(now - before[k]) < 0.01f);
    CHECK(length(rig.keys->direction_of(k) - camera_direction(*rig.keys->view_of(k))) < 1e-6f);
  }
}

TEST_CASE("a view shows the depth of a key frame as the motion of a point that moves away from its camera") {
  Rig rig;
  rig.keys->keep(0, rig.turned(0), 0.3f, 0);
  rig.keys->keep(1, rig.turned(0.5f), 0.3f, 0);
  View now = rig.turned(0.2f);
  now.tau = {};  // on the optical axis, where perspective moves nothing
  const KeyDepths depths{&rig.keys.object, &now};
  for (std::size_t k = 0; k < 2; ++k) {
    Vec2 at, farther;
    const Projector projector(now, true);
    REQUIRE(projector.project({}, &at));
    REQUIRE(projector.project(-1.0f * camera_direction(*rig.keys->view_of(k)), &farther));
    CHECK(length(depths.of(k) - (farther - at)) < 0.02f * length(farther - at));
    CHECK(length(depths.of(k)) > 0.1f);
  }
  CHECK(length(depths.of(2)) == 0);  // not in use
  CHECK(length(KeyDepths{}.of(0)) == 0);
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

TEST_CASE(
    "all key frames of the limits are used before one is replaced, the one kept first if none was near") {
  TrackerLimits limits;
  limits.key_frames = 2;
  Rig rig(limits);
  rig.keys->keep(0, rig.turned(0), 0.3f, 0);
  rig.keys->keep(1, rig.turned(1.0f), 0.3f, 20);
  CHECK(rig.keys->choose(rig.turned(-0.5f), rig.good, 25) == 2);
  rig.keys->keep(2, rig.turned(1.5f), 0.3f, 10);
  CHECK(rig.keys->choose(rig.turned(-0.5f), rig.good, 30) == 2);
}

TEST_CASE("what residual is doubtful grows with the frame's width") {
  for (const std::uint16_t width : {std::uint16_t{320}, std::uint16_t{640}}) {
    TrackerLimits limits;
    limits.width = width;
    limits.height = static_cast<std::uint16_t>(width * 3 / 4);
    const Rig of_views;
    FrameResult good = of_views.good;
    InArena<KeyFrames> keys(limits);
    keys->keep(0, of_views.turned(0), 0, 0);
    keys->keep(1, of_views.turned(0.5f), 1.5f, 1);
    CHECK(keys->choose(of_views.turned(0.4f), good, 2) == (width == 320 ? 1 : 0));
  }
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
