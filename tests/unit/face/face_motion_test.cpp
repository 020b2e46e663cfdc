// How far a face has moved between two pictures of one part of the frame.
#include "face/face_motion.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "aligned_block.hpp"
#include "texture.hpp"

namespace face_motion_test {

using namespace pliant;
using texture::Picture;

namespace {

constexpr int kWidth = 480, kHeight = 400;
constexpr Vec2 kCentre{240, 200};

/// \param stretch  of the texture, whose shortest wave is 6 px.
Picture frame_moved_by(Vec2 by, float stretch) {
  static const texture::Texture texture(1);
  texture::Motion motion;
  motion.a = motion.d = double(stretch);
  motion.tx = double(by.x);
  motion.ty = double(by.y);
  return texture::render(texture, motion, kWidth, kHeight);
}

/// Pictures of one part of each frame that it is shown.
class Watcher {
 public:
  explicit Watcher(float ratio) : ratio_(ratio) {
    Arena arena(block_.data(), block_.size());
    picture_.lay_out(arena);
    REQUIRE(!arena.exhausted());
  }
  void keep(const Picture& frame) { motion_.keep(take(frame)); }
  Vec2 since_kept(const Picture& frame) { return motion_.since_kept(take(frame)); }

 private:
  const FacePicture& take(const Picture& frame) {
    picture_.take(frame.frame(), kCentre, ratio_, columns_.data());
    return picture_;
  }

  float ratio_;
  AlignedBlock block_{1 << 15};
  FacePicture picture_;
  FaceMotion motion_;
  std::vector<int> columns_ = std::vector<int>(
      static_cast<std::size_t>(kFacePictureTuning.side_px * kFacePictureTuning.most_samples));
};

}  // namespace

TEST_CASE("a motion within the range is found to a quarter of a pixel compared, in px of the frame") {
  constexpr float kRange = static_cast<float>(kFaceMotionTuning.range * kFaceMotionTuning.factor);
  for (const float ratio : {1.0f, 1.7f, 2.0f}) {
    Watcher watcher(ratio);
    const float pixel = static_cast<float>(kFaceMotionTuning.factor) * ratio;
    for (const Vec2 part : {Vec2{0, 0}, Vec2{0.13f, -0.07f}, Vec2{-0.4f, 0.3f}, Vec2{0.9f, 0.9f}}) {
      const Vec2 by = kRange * ratio * part;
      CAPTURE(ratio);
      CAPTURE(by.x);
      watcher.keep(frame_moved_by({}, 3 * ratio));
      const Vec2 found = watcher.since_kept(frame_moved_by(by, 3 * ratio));
      CHECK(magnitude(found.x - by.x) < 0.25f * pixel);
      CHECK(magnitude(found.y - by.y) < 0.25f * pixel);
    }
  }
}

TEST_CASE("of two pictures of different things no motion is told") {
  Watcher watcher(1);
  watcher.keep(texture::noise(kWidth, kHeight, 1));
  const Vec2 found = watcher.since_kept(texture::noise(kWidth, kHeight, 2));
  CHECK(found.x == 0);
  CHECK(found.y == 0);
  watcher.keep(frame_moved_by({}, 3));
  CHECK(length(watcher.since_kept(Picture(kWidth, kHeight, 90))) == 0);  // nothing to compare
}

TEST_CASE("bands of light that run over a face at rest are no motion, and neither is a change of light") {
  Watcher watcher(1);
  const auto lit = [](float phase, float gain) {
    Picture p = frame_moved_by({}, 3);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const float band = 1 - 0.3f * (1 + std::sin(static_cast<float>(y) / 9 + phase));
        p.at(x, y) = static_cast<std::uint8_t>(gain * band * static_cast<float>(p.at(x, y)));
      }
    return p;
  };
  watcher.keep(lit(0, 0.9f));
  CHECK(length(watcher.since_kept(lit(2, 0.5f))) < 0.25f * static_cast<float>(kFaceMotionTuning.factor));
}

}  // namespace face_motion_test
