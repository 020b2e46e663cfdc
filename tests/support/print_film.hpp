#pragma once
// Films of the sheet of the fixtures, with three bending modes, for tests of starts and tracks by print.
#include <doctest/doctest.h>

#include <limits>

#include "host/bake/opened_table.hpp"
#include "host/io/files.hpp"
#include "host/render/scene.hpp"
#include "model_builder.hpp"
#include "pliant/tracker.hpp"

namespace pliant::host {

inline constexpr int kWidth = 320, kHeight = 240;
inline const Camera kCamera = centred_camera(kWidth, kHeight, 448);

inline const std::vector<std::uint8_t>& sheet_bytes() {
  static const auto* bytes = [] {
    const std::string table = read_file(PLIANT_BAKED_SHEET);
    return new std::vector<std::uint8_t>(table.begin(), table.end());
  }();
  return *bytes;
}

inline const Model& sheet() {
  static const auto* opened = new bake::OpenedTable(sheet_bytes());
  REQUIRE(opened->status() == Status::ok);
  return opened->model();
}

inline Pose posed(float turn_x, float turn_y, float roll, float away) {
  return {exp_rotation({turn_x, turn_y, 0}) * exp_rotation({0, 0, roll}), {0, 0, 1000 * away}};
}

inline Image picture_of(const Pose& pose, const std::vector<float>& q, std::uint32_t seed) {
  static auto* scene = new Scene(sheet(), kWidth, kHeight);
  Image image = scene->draw(q.data(), pose, kCamera, make_background(kWidth, kHeight, seed));
  add_noise(image, 2, seed);
  return image;
}

/// Frames of one tracker.
/// The same limits with searches of one frame, as the command has them for files.
inline TrackerLimits searching_at_once(TrackerLimits limits = {}) {
  limits.search_work = std::numeric_limits<std::uint32_t>::max();
  return limits;
}

struct Film {
  InArena<Tracker> tracker;
  FrameResult result;
  std::uint32_t count = 0;

  explicit Film(const Model& model, TrackerLimits limits = searching_at_once()) : tracker(model, limits) {}
  Status show(const Image& image) {
    ++count;
    FrameView view{image.pixels.data(),
                   image.width,
                   image.height,
                   static_cast<std::size_t>(image.width),
                   1,
                   static_cast<std::int64_t>(count) * 33333333,
                   count};
    return tracker->update(view, &result);
  }
  float turned_from(const Pose& pose) const {
    return length(log_rotation(result.pose.q * conjugate(pose.q)));
  }
};

inline const std::vector<float> kRest(3, 0.0f);

}  // namespace pliant::host
