// What `bake` learns of a print: keypoints of all its views. And what a picture shows of a surface with two sides.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "baked_print.hpp"
#include "host/bake/opened_table.hpp"
#include "host/io/image.hpp"
#include "print/print_table.hpp"
#include "print_film.hpp"
#include "random.hpp"

namespace print_keypoints_test {

using namespace pliant;
using namespace pliant::host;

namespace {

/// A card, printed on both sides: 14 views.
Vec3 card(float s, float t) {
  const float y = 200 * (t - 0.5f);
  return s < 0.5f ? Vec3{400 * s - 100, y, 1} : Vec3{300 - 400 * s, y, -1};
}

Vec3 card_without_thickness(float s, float t) {
  const Vec3 p = card(s, t);
  return {p.x, p.y, 0};
}

/// Squares of all sizes, one over the other: more corners than a table holds.
Image squares() {
  constexpr int kSide = 512;
  Random random(4);
  Image picture(kSide, kSide, 1);
  for (int size = 64; size >= 4; size /= 2)
    for (int k = 0; k < kSide * kSide / (3 * size * size); ++k) {
      const int left = random.below(kSide), top = random.below(kSide), grey = random.below(256);
      for (int y = top; y < std::min(kSide, top + size); ++y)
        for (int x = left; x < std::min(kSide, left + size); ++x)
          *picture.at(x, y) = static_cast<std::uint8_t>(grey);
    }
  return picture;
}

constexpr float kPi = 3.14159265f;

/// A ball, whose chart is cut open at the back. t up.
Vec3 ball(float s, float t) {
  const float a = 2 * kPi * (s - 0.5f), b = 0.98f * kPi * (t - 0.5f);
  return {100 * std::cos(b) * std::sin(a), 100 * std::sin(b), 100 * std::cos(b) * std::cos(a)};
}

}  // namespace

TEST_CASE("the print of a ball is learnt from all its sides: each place is seen at 45 degrees or less") {
  const bake::OpenedTable opened(baked_print(ball, squares()));
  PrintTable table;
  REQUIRE(PrintTable::open(opened.model().print(), &table) == Status::ok);
  for (int i = 0; i < 24; ++i)
    for (int j = 1; j < 12; ++j) {
      const float a = 2 * kPi * static_cast<float>(i) / 24, b = kPi * (static_cast<float>(j) / 12 - 0.5f);
      const Vec3 normal{std::cos(b) * std::sin(a), -std::sin(b), -std::cos(b) * std::cos(a)};  // camera's axes
      float best = 0;  // cosine of the angle at which a view shows this place
      for (const Quat view : table.views()) best = std::max(best, -(rotation_matrix(view) * normal).z);
      CAPTURE(a);
      CAPTURE(b);
      CHECK(best > 0.7f);
    }
}

TEST_CASE(
    "where a print has more corners than a table holds, each of its views keeps keypoints of all sizes") {
  const bake::OpenedTable opened(baked_print(card, squares()));
  PrintTable table;
  REQUIRE(PrintTable::open(opened.model().print(), &table) == Status::ok);
  REQUIRE(table.views().count == 14);
  REQUIRE(table.keypoints().count == 3000);
  const std::size_t sizes = std::min<std::size_t>(table.levels().count, 6);
  for (std::size_t view = 0; view < table.views().count; ++view)
    for (std::size_t level = 0; level < sizes; ++level) {
      CAPTURE(view);
      CAPTURE(level);
      const auto first = table.keypoints().begin(), end = table.keypoints().end();
      CHECK(std::count_if(first, end,
                          [&](const PrintKeypoint& k) { return k.view == view && k.level == level; }) >= 5);
    }
}

TEST_CASE("of a card that is modelled without thickness, each view shows the side that faces it alone") {
  const bake::OpenedTable opened(baked_print(card_without_thickness, squares()));
  PrintTable table;
  REQUIRE(PrintTable::open(opened.model().print(), &table) == Status::ok);
  REQUIRE(table.views().count == 14);
  int on_other_side = 0;
  for (const PrintKeypoint& k : table.keypoints()) {
    const bool shows_front = (rotation_matrix(table.views()[k.view]) * Vec3{0, 0, -1}).z < 0;
    on_other_side += (k.uv().x < 0.5f) != shows_front ? 1 : 0;
  }
  CHECK(table.keypoints().count > 1000);
  CHECK(on_other_side == 0);
}

TEST_CASE(
    "a picture of a card that is modelled without thickness shows the side that faces the camera alone") {
  constexpr int kSide = 64, kWhite = 255, kBlack = 0;
  Image halves(kSide, kSide, 1);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) *halves.at(x, y) = x < kSide / 2 ? kWhite : kBlack;
  const bake::OpenedTable opened(baked_print(card_without_thickness, halves));
  Scene scene(opened.model(), kWidth, kHeight);
  const float q[1] = {};
  for (const float turn : {0.0f, 0.4f, kPi - 0.4f, kPi}) {
    CAPTURE(turn);
    const Image picture =
        scene.draw(q, {exp_rotation({0, turn, 0}), {0, 0, 900}}, kCamera, Image(kWidth, kHeight, 1));
    int least = 255, most = 0;
    for (int y = kHeight / 2 - 30; y <= kHeight / 2 + 30; ++y)
      for (int x = kWidth / 2 - 25; x <= kWidth / 2 + 25; ++x) {
        least = std::min<int>(least, *picture.at(x, y));
        most = std::max<int>(most, *picture.at(x, y));
      }
    if (turn < 1)
      CHECK(least > 100);
    else
      CHECK(most < 20);
  }
}

TEST_CASE("the extent of a print is that of the whole surface, with the last row of its chart") {
  const bake::OpenedTable opened(sheet_bytes());
  PrintTable table;
  REQUIRE(PrintTable::open(opened.model().print(), &table) == Status::ok);
  CHECK(table.extent_mm() == doctest::Approx(std::hypot(210.0, 297.0)).epsilon(0.001));
}

}  // namespace print_keypoints_test
