// Alignment of frames whose pixels are not square. The tables, made by hand, do not look at the picture.
#include <doctest/doctest.h>

#include "aligner_pattern.hpp"
#include "baked_face.hpp"
#include "model_builder.hpp"
#include "pliant/face_aligner.hpp"

namespace aligner_aspect_test {

using namespace pliant;

namespace {

constexpr int kWidth = 320, kHeight = 240;

/// An alignment of a frame that is `aspect` times as high as one with square pixels, and its results.
struct Aligned {
  aligner_pattern::Bytes table = aligner_pattern::table(3, 2);
  InArena<FaceAligner> aligner{baked_face().model, table.span()};
  float aspect;
  Camera camera;
  std::vector<std::uint8_t> pixels;
  FrameView frame;
  AlignedFace face;
  std::vector<float> q = baked_face().rest();
  std::vector<Vec2> landmarks = std::vector<Vec2>(baked_face().model.landmarks().count);

  explicit Aligned(float of_aspect) : aspect(of_aspect) {
    const int height = static_cast<int>(aspect * kHeight);
    camera = centred_camera(kWidth, kHeight, 448);
    camera.aspect = aspect;
    camera.cy *= aspect;
    pixels.assign(static_cast<std::size_t>(kWidth * height), 90);
    frame = {pixels.data(), kWidth, height, std::size_t{kWidth}};
  }
  Status align(FaceBox box) {
    box.center.y *= aspect;
    return aligner->align(frame, box, camera, &face, q.data(), {landmarks.data(), landmarks.size()});
  }
  Status refine(const Pose& from) {
    return aligner->refine(frame, camera, from, &face, q.data(), {landmarks.data(), landmarks.size()});
  }
};

constexpr float kAspects[] = {0.5f, 0.75f, 1.5f, 2};

}  // namespace

TEST_CASE(
    "pixels that are not square: the same pose and person, landmarks that are as much higher or lower") {
  const FaceBox box{{190, 80}, 90};
  Aligned square(1);
  REQUIRE(square.align(box) == Status::ok);
  for (const float aspect : kAspects) {
    CAPTURE(aspect);
    Aligned other(aspect);
    REQUIRE(other.align(box) == Status::ok);
    CHECK(other.face.camera.aspect == aspect);
    CHECK(length(other.face.pose.t - square.face.pose.t) < 1e-3f * square.face.pose.t.z);
    CHECK(length(log_rotation(other.face.pose.q) - log_rotation(square.face.pose.q)) < 1e-3f);
    for (std::size_t k = 0; k < square.landmarks.size(); ++k)
      CHECK(length(other.landmarks[k] - Vec2{square.landmarks[k].x, aspect * square.landmarks[k].y}) < 0.1f);
  }
}

TEST_CASE("pixels that are not square: a pose is as far outside of the frame as with square ones") {
  Aligned square(1);
  for (const float aspect : kAspects) {
    CAPTURE(aspect);
    Aligned other(aspect);
    int outside = 0;
    for (float y_mm = -900; y_mm <= 900; y_mm += 20) {
      const Pose pose{{}, {0, y_mm, 800}};
      const Status status = square.refine(pose);
      CHECK(other.refine(pose) == status);
      outside += status == Status::not_found;
    }
    CHECK(outside > 10);
    CHECK(outside < 80);
  }
}

}  // namespace aligner_aspect_test
