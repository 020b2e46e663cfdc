// Tracks of prints that repeat: templates and thumbnails look the same a period on.
#include <doctest/doctest.h>

#include <cmath>

#include "host/bake/bake.hpp"
#include "obj_folder.hpp"
#include "print_film.hpp"

namespace repeating_print_test {

using namespace pliant;
using namespace pliant::host;

namespace {

constexpr float kSideMm = 240;

/// A square sheet with checks. \param checks  along a side.
std::vector<std::uint8_t> checkered(int checks) {
  constexpr int kPixels = 480;
  const obj_folder::ObjFolder folder("checkered");
  folder.write("neutral", obj_folder::Shape([](float s, float t) {
                 return Vec3{kSideMm * (s - 0.5f), kSideMm * (t - 0.5f), 0};
               }));
  Image print(kPixels, kPixels, 1);
  for (int y = 0; y < kPixels; ++y)
    for (int x = 0; x < kPixels; ++x)
      print.pixels[static_cast<std::size_t>(y * kPixels + x)] =
          (x * checks / kPixels + y * checks / kPixels) % 2 == 0 ? 60 : 200;
  bake::BakeOptions options;
  options.source = folder.path.string();
  options.texture = folder.put("print.png", encode_png(print));
  std::vector<std::uint8_t> bytes;
  std::string error;
  REQUIRE_MESSAGE(bake::bake(options, bytes, error), error);
  return bytes;
}

/// Of a frame of a sheet that begins at rest and then moves to and fro, and turns a little.
Pose pose_of(int frame) {
  const float n = static_cast<float>(frame), begun = n < 15 ? n / 15 : 1;
  return {exp_rotation({0.05f, 0.1f + 0.1f * begun * std::sin(n / 11), 0}),
          {begun * 90 * std::sin(n / 8), begun * 25 * std::sin(n / 6), 600}};
}

}  // namespace

TEST_CASE("a checkerboard that moves by less than a period a frame is tracked where it is") {
  constexpr float kMostPxOff = 1;
  for (const int checks : {8, 12}) {
    const std::vector<std::uint8_t> bytes = checkered(checks);
    const bake::OpenedTable table(bytes);
    REQUIRE(table.status() == Status::ok);
    Scene scene(table.model(), kWidth, kHeight);
    Film film(table.model());
    int right = 0;
    float fastest_px = 0;
    constexpr int kFrames = 40;
    for (int k = 0; k < kFrames; ++k) {
      const Pose pose = pose_of(k);
      Image image = scene.draw(nullptr, pose, kCamera, make_background(kWidth, kHeight, 3));
      add_noise(image, 2, static_cast<std::uint32_t>(k));
      const float px_per_mm = kCamera.f / pose.t.z;
      if (k == 0) {
        FrameView view{image.pixels.data(), kWidth, kHeight, kWidth, 1, 0, 0};
        REQUIRE(film.tracker->start_from_pose(view, kCamera, pose, nullptr) == Status::ok);
        continue;
      }
      fastest_px = std::max(fastest_px, px_per_mm * length(pose.t - pose_of(k - 1).t));
      REQUIRE(film.show(image) == Status::ok);
      right += film.result.state == TrackState::tracking &&
               px_per_mm * length(film.result.pose.t - pose.t) < kMostPxOff;
    }
    CAPTURE(checks);
    CHECK(right == kFrames - 1);
    CHECK(fastest_px > 8);
  }
}

}  // namespace repeating_print_test
