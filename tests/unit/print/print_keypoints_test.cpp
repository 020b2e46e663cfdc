// What `bake` learns of a print: keypoints of all its views.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "host/bake/bake.hpp"
#include "host/bake/opened_table.hpp"
#include "host/io/image.hpp"
#include "obj_folder.hpp"
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

}  // namespace

TEST_CASE(
    "where a print has more corners than a table holds, each of its views keeps keypoints of all sizes") {
  const obj_folder::ObjFolder folder("card");
  folder.write("neutral", card);
  bake::BakeOptions options;
  options.source = folder.path.string();
  options.texture = folder.put("print.png", encode_png(squares()));
  std::vector<std::uint8_t> bytes;
  std::string error;
  REQUIRE_MESSAGE(bake::bake(options, bytes, error), error);
  const bake::OpenedTable opened(bytes);
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
