#include "pliant/face_detector.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "aligned_block.hpp"
#include "detector_pattern.hpp"
#include "texture.hpp"

namespace face_detector_test {

using namespace pliant;
using detector_pattern::Bytes;
using texture::Picture;

namespace {

struct Rig {
  AlignedBlock block;
  Bytes table = detector_pattern::table();
  FaceDetector detector;

  explicit Rig(FaceDetectorLimits limits = {})
      : block(measured_bytes<FaceDetector>(detector_pattern::table().span(), limits)) {
    Arena arena(block.data(), block.size());
    REQUIRE(create_in(arena, detector, table.span(), limits) == Status::ok);
    REQUIRE(detector.status() == Status::ok);
  }
  std::vector<DetectedFace> find(const Picture& picture) {
    DetectedFace faces[16];
    std::size_t count = 0;
    REQUIRE(detector.find(picture.frame(), {faces, 16}, &count) == Status::ok);
    return {faces, faces + count};
  }
  // In parts of `work` cells, until complete.
  std::vector<DetectedFace> search(const Picture& picture, std::uint32_t work, int* calls) {
    std::vector<DetectedFace> all;
    bool is_complete = false;
    for (*calls = 0; !is_complete; ++*calls) {
      DetectedFace faces[16];
      std::size_t count = 0;
      REQUIRE(detector.search(picture.frame(), work, {faces, 16}, &count, &is_complete) == Status::ok);
      all.insert(all.end(), faces, faces + count);
    }
    return all;
  }
};

bool is_at(const DetectedFace& face, double x, double y, double side) {
  const double dx = static_cast<double>(face.box.center.x) - x,
               dy = static_cast<double>(face.box.center.y) - y;
  return std::hypot(dx, dy) < 0.1 * side &&
         std::abs(std::log(static_cast<double>(face.box.side) / side)) < 0.15;
}

}  // namespace

TEST_CASE("a pattern is found at any place and size, once, and nothing else is") {
  Rig rig;
  for (const double side : {50.0, 71.0, 100.0, 143.0, 190.0})
    for (const double x : {100.0, 159.0, 214.0}) {
      CAPTURE(side);
      CAPTURE(x);
      Picture p(320, 240, 120);
      detector_pattern::draw(&p, x, 118, side);
      const auto faces = rig.find(p);
      REQUIRE(faces.size() == 1);
      CHECK(is_at(faces[0], x, 118, side));
      CHECK(faces[0].score > 0.5f);
    }
}

TEST_CASE("several patterns are found, the clearest first") {
  Rig rig;
  Picture p(320, 240, 120);
  detector_pattern::draw(&p, 60, 70, 60);
  detector_pattern::draw(&p, 220, 130, 110);
  const auto faces = rig.find(p);
  REQUIRE(faces.size() == 2);
  CHECK(faces[0].score >= faces[1].score);
  const std::size_t large = faces[0].box.side > 80 ? 0 : 1;
  CHECK(is_at(faces[large], 220, 130, 110));
  CHECK(is_at(faces[1 - large], 60, 70, 60));
}

TEST_CASE("in a crowd as many patterns are found as the limits keep hits for") {
  constexpr int kAcross = 12, kDown = 9, kStep = 70;
  Picture p(kAcross * kStep, kDown * kStep, 120);
  for (int k = 0; k < kAcross * kDown; ++k)
    detector_pattern::draw(&p, kStep * (k % kAcross) + 35, kStep * (k / kAcross) + 35, 50);
  for (const std::uint16_t hits : {std::uint16_t{0}, std::uint16_t{20}, std::uint16_t{5000}}) {
    CAPTURE(hits);
    FaceDetectorLimits limits{840, 630, 48, hits};
    Rig rig(limits);
    DetectedFace faces[200];
    std::size_t count = 0;
    REQUIRE(rig.detector.find(p.frame(), {faces, 200}, &count) == Status::ok);
    CHECK((hits == 5000 ? count == kAcross * kDown : count >= 1 && count <= (hits > 0 ? hits : std::size_t{1})));
  }
}

TEST_CASE("nothing is found in pictures without the pattern, of any size from 1 x 1 on") {
  FaceDetectorLimits limits;
  limits.width = limits.height = 8192;
  Rig rig(limits);
  for (const int width : {1, 2, 39, 40, 47, 48, 100, 353})
    for (const int height : {1, 40, 49, 121}) CHECK(rig.find(Picture(width, height, 77)).empty());
  CHECK(rig.find(texture::noise(200, 160, 5)).empty());
}

TEST_CASE("memory does not grow with the frame beyond 320 px") {
  const Bytes table = detector_pattern::table();
  FaceDetectorLimits small, large;
  large.width = large.height = 8192;
  CHECK(measured_bytes<FaceDetector>(table.span(), small) ==
        measured_bytes<FaceDetector>(table.span(), large));
  CHECK(measured_bytes<FaceDetector>(table.span(), small) < 40000);
}

TEST_CASE("a frame wider than a strip is searched to its ends") {
  FaceDetectorLimits limits;
  limits.width = 1500;
  Rig rig(limits);
  for (int x = 40; x <= 1460; x += 71) {
    CAPTURE(x);
    Picture p(1500, 100, 120);
    detector_pattern::draw(&p, x, 50, 52);
    const auto faces = rig.find(p);
    REQUIRE(faces.size() == 1);
    CHECK(is_at(faces[0], x, 50, 52));
  }
}

TEST_CASE("a frame of 8192 x 8192 px is searched; a large pattern is found in it") {
  FaceDetectorLimits limits;
  limits.width = limits.height = 8192;
  limits.smallest_px = 2000;
  Rig rig(limits);
  Picture p(8192, 8192, 120);
  detector_pattern::draw(&p, 3000, 4000, 2900);
  const auto faces = rig.find(p);
  REQUIRE(faces.size() == 1);
  CHECK(is_at(faces[0], 3000, 4000, 2900));
}

TEST_CASE("a pattern that the frame's border cuts is found") {
  Rig rig;
  Picture p(320, 240, 120);
  detector_pattern::draw(&p, 60, 26, 62);
  const auto faces = rig.find(p);
  REQUIRE(faces.size() == 1);
  CHECK(is_at(faces[0], 60, 26, 62));
}

TEST_CASE("a search in parts meets what a whole search finds, and costs as many cells") {
  Rig rig;
  Picture p(320, 240, 120);
  detector_pattern::draw(&p, 90, 70, 60);
  detector_pattern::draw(&p, 220, 130, 110);
  for (const std::uint32_t work : {1u, 300u, 2000u, 1000000u}) {
    int calls = 0;
    const auto parts = rig.search(p, work, &calls);
    if (work == 1000000) CHECK(calls == 1);
    if (work == 2000) CHECK(calls > 4);
    const auto met = [&](double x, double y, double side) {
      return std::any_of(parts.begin(), parts.end(),
                         [&](const DetectedFace& f) { return is_at(f, x, y, side); });
    };
    CHECK(met(90, 70, 60));
    CHECK(met(220, 130, 110));
  }
  int calls = 0;
  const auto parts = rig.search(p, 1000000, &calls);
  const auto whole = rig.find(p);
  REQUIRE(parts.size() == whole.size());
  CHECK(std::memcmp(parts.data(), whole.data(), parts.size() * sizeof(DetectedFace)) == 0);
}

TEST_CASE("near a box of another size the pattern's own box is found, and where there is none nothing") {
  Rig rig;
  Picture p(320, 240, 120);
  detector_pattern::draw(&p, 150, 110, 70);
  for (const float ratio : {0.75f, 1.0f, 1.33f}) {
    CAPTURE(ratio);
    DetectedFace face;
    REQUIRE(rig.detector.search_near(p.frame(), {{155, 104}, 70 * ratio}, &face) == Status::ok);
    CHECK(is_at(face, 150, 110, 70));
    CHECK(face.score == rig.find(p)[0].score);
  }
  DetectedFace face{{{1, 2}, 3}, 4};
  CHECK(rig.detector.search_near(p.frame(), {{240, 110}, 70}, &face) == Status::not_found);
  CHECK(rig.detector.search_near(p.frame(), {{150, 110}, 140}, &face) == Status::not_found);
  CHECK(face.score == 4);
}

TEST_CASE("a search in parts goes on after a search near a box as if there had been none") {
  Picture p(320, 240, 120);
  detector_pattern::draw(&p, 90, 70, 60);
  detector_pattern::draw(&p, 220, 130, 110);
  for (const std::uint32_t work : {1u, 300u, 2000u}) {
    Rig plain, interrupted;
    bool is_complete = false;
    while (!is_complete) {
      DetectedFace faces[2][16], near;
      std::size_t count[2] = {};
      REQUIRE(plain.detector.search(p.frame(), work, {faces[0], 16}, &count[0], &is_complete) == Status::ok);
      REQUIRE(interrupted.detector.search(p.frame(), work, {faces[1], 16}, &count[1], &is_complete) ==
              Status::ok);
      REQUIRE(count[0] == count[1]);
      CHECK(std::memcmp(faces[0], faces[1], count[0] * sizeof(DetectedFace)) == 0);
      REQUIRE(interrupted.detector.search_near(p.frame(), {{90, 70}, 60}, &near) == Status::ok);
    }
  }
}

TEST_CASE("the same pixels in another memory layout give the same bits") {
  Rig rig;
  Picture p(318, 201, 120);
  detector_pattern::draw(&p, 130, 90, 77);
  const auto plain = rig.find(p);
  REQUIRE(plain.size() == 1);
  for (const int step : {1, 2}) {
    const std::size_t stride = 318 * static_cast<std::size_t>(step) + 13;
    std::vector<std::uint8_t> bytes(stride * 201, 9);
    for (std::size_t y = 0; y < 201; ++y)
      for (std::size_t x = 0; x < 318; ++x)
        bytes[y * stride + x * static_cast<std::size_t>(step)] = p.pixels[y * 318 + x];
    FrameView frame = p.frame();
    frame.data = bytes.data();
    frame.stride_bytes = stride;
    frame.pixel_step_bytes = step;
    DetectedFace face;
    std::size_t count = 0;
    REQUIRE(rig.detector.find(frame, {&face, 1}, &count) == Status::ok);
    REQUIRE(count == 1);
    CHECK(std::memcmp(&face, plain.data(), sizeof face) == 0);
  }
}

TEST_CASE("bad input gets a status") {
  Rig rig;
  DetectedFace face;
  std::size_t count = 7;
  const Picture large(400, 300, 0), right(320, 240, 0);
  CHECK(rig.detector.find(large.frame(), {&face, 1}, &count) == Status::size_mismatch);
  CHECK(rig.detector.find({}, {&face, 1}, &count) == Status::bad_argument);
  CHECK(rig.detector.find(right.frame(), {nullptr, 1}, &count) == Status::bad_argument);
  CHECK(rig.detector.find(right.frame(), {&face, 1}, nullptr) == Status::bad_argument);
  CHECK(rig.detector.search(right.frame(), 1, {&face, 1}, &count, nullptr) == Status::bad_argument);
  CHECK(rig.detector.search_near(large.frame(), {{50, 50}, 60}, &face) == Status::size_mismatch);
  CHECK(rig.detector.search_near(right.frame(), {{50, 50}, 60}, nullptr) == Status::bad_argument);
  for (const float bad : {0.0f, -1.0f, 1e30f, std::nanf("")}) {
    CHECK(rig.detector.search_near(right.frame(), {{50, 50}, bad}, &face) == Status::bad_argument);
    if (bad != 0 && bad != -1)
      CHECK(rig.detector.search_near(right.frame(), {{50, bad}, 60}, &face) == Status::bad_argument);
  }
  CHECK(count == 7);
  CHECK(rig.detector.find(right.frame(), {}, &count) == Status::ok);
  CHECK(count == 0);
  FaceDetector nothing;
  CHECK(nothing.find(right.frame(), {&face, 1}, &count) == Status::not_found);
}

}  // namespace face_detector_test
