// What `bake` learns of a print: keypoints of all its views.
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

TEST_CASE("the extent of a print is that of the whole surface, with the last row of its chart") {
  const bake::OpenedTable opened(sheet_bytes());
  PrintTable table;
  REQUIRE(PrintTable::open(opened.model().print(), &table) == Status::ok);
  CHECK(table.extent_mm() == doctest::Approx(std::hypot(210.0, 297.0)).epsilon(0.001));
}

}  // namespace print_keypoints_test
