// Starts by a print with few corners: the fit to blocks begins far from the print, and goes on until it has arrived.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "baked_print.hpp"
#include "print_film.hpp"
#include "random.hpp"

namespace settled_start_test {

using namespace pliant;
using namespace pliant::host;

namespace {

constexpr int kSide = 512;

Vec3 can(float s, float t) {
  const float a = 2 * 3.14159265f * (s - 0.5f);
  return {100 * std::sin(a), 300 * (t - 0.5f), 100 * std::cos(a)};
}

void draw_bar(Image& picture, int x, int y, int width, int height) {
  for (int j = y; j < std::min(y + height, kSide); ++j)
    for (int i = x; i < std::min(x + width, kSide); ++i) *picture.at(i, j) = 240;
}

void draw_spot(Image& picture, int x, int y, int r, int grey) {
  for (int j = std::max(0, y - 3 * r); j < std::min(kSide, y + 3 * r); ++j)
    for (int i = std::max(0, x - r); i < std::min(kSide, x + r); ++i)
      if (9 * (i - x) * (i - x) + (j - y) * (j - y) < 9 * r * r)
        *picture.at(i, j) = static_cast<std::uint8_t>(grey);
}

/// A word, twice, lines of small print between, and spots below.
Image label() {
  Random random(2);
  Image picture(kSide, kSide, 1);
  std::fill(picture.pixels.begin(), picture.pixels.end(), std::uint8_t{90});
  for (int letter = 0; letter < 8; ++letter) {
    const int x = 30 + 256 * (letter / 4) + 40 * (letter % 4), kind = (letter % 4 * 7 + 2) % 4;
    draw_bar(picture, x, 50, 9, 130);
    if (kind != 1) draw_bar(picture, x, 50, 32, 25);
    if (kind != 2) draw_bar(picture, x, 155, 32, 25);
    if (kind % 2 == 0) draw_bar(picture, x + 24, 50, 9, 130);
  }
  for (int k = 0; k < 40; ++k) {
    const int r = 4 + random.below(12), grey = random.below(256), y = 330 + random.below(180);
    draw_spot(picture, random.below(kSide), y, r, grey);
  }
  for (int line = 0; line < 24; ++line)
    for (int x = 194; x < 256; x += 3)
      if (random.below(3) > 0) draw_bar(picture, x, 45 + 10 * line, 2, 5);
  return picture;
}

}  // namespace

TEST_CASE("a can with few corners is turned as its print is from the first frame in state tracking on") {
  const bake::OpenedTable table(baked_print(can, label()));
  Scene scene(table.model(), kWidth, kHeight);
  Random random(5);
  std::vector<float> errors;
  for (int k = 0; k < 24; ++k) {
    CAPTURE(k);
    const float roll = random.uniform(-0.5f, 0.5f), turn = random.uniform(-3.1f, 3.1f);
    const Pose pose = posed(random.uniform(-0.3f, 0.3f), turn, roll, 0.8f);
    Film film(table.model());
    for (int frame = 0; frame < 6 && !film.tracker->is_started(); ++frame) {
      Image image = scene.draw(nullptr, pose, kCamera, make_background(kWidth, kHeight, 3));
      add_noise(image, 2, film.count + 10 * static_cast<std::uint32_t>(k));
      REQUIRE(film.show(image) == Status::ok);
    }
    if (!film.tracker->is_started() || film.result.state != TrackState::tracking) continue;
    errors.push_back(film.turned_from(pose));
  }
  REQUIRE(errors.size() >= 14);
  std::sort(errors.begin(), errors.end());
  const float median = errors[errors.size() / 2];
  MESSAGE("turned by " << median << " in the median, " << errors.back() << " at most");
  CHECK(median < 0.0095f);        // where the fit does not go on 0.0117
  CHECK(errors.back() < 0.035f);  // 0.036
}

}  // namespace settled_start_test
