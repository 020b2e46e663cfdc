// What a search keeps of its frame: corners, matches and a copy, which a later frame replaces.
#include "print/print_matcher.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>

#include "print/print_table.hpp"
#include "print_film.hpp"

namespace print_matcher_test {

using namespace pliant;
using namespace pliant::host;

namespace {

/// A window of a larger picture.
FrameView window_at(const Image& picture, int x, int y) {
  FrameView view;
  view.data = picture.at(x, y);
  view.width = kWidth;
  view.height = kHeight;
  view.stride_bytes = static_cast<std::size_t>(picture.width);
  return view;
}

struct Search {
  Image picture = make_background(kWidth + 200, kHeight + 200, 5);
  PrintTable table;
  InArena<PrintMatcher> matcher;

  Search() : matcher(opened(), kWidth, kHeight) {
    REQUIRE(matcher->begin(window_at(picture, 100, 100), CornerChoice::strongest) == Status::ok);
    while (!matcher->is_idle()) CHECK(matcher->step() < 10000);
  }
  const PrintTable& opened() {
    REQUIRE(PrintTable::open(sheet().print(), &table) == Status::ok);
    return table;
  }
};

}  // namespace

TEST_CASE(
    "a later frame takes the place of the one that was searched, and both are at hand at a quarter of their "
    "size") {
  Search search;
  const SmallPictures shown = search.matcher->move_on(window_at(search.picture, 60, 124));
  CHECK(search.matcher->searched().data[0] == *search.picture.at(60, 124));
  CHECK(shown.scale == 4);
  CHECK((shown.before.width == kWidth / 4 && shown.now.height == kHeight / 4));
  int most = 0;
  for (int y = 10; y < 40; ++y)
    for (int x = 12; x < 60; ++x) {
      const auto at = [](const ImageView& image, int column, int row) {
        return int{image.data[row * image.stride + column]};
      };
      most = std::max(most, std::abs(at(shown.before, x, y) - at(shown.now, x + 10, y - 6)));
    }
  CHECK(most <= 1);
}

TEST_CASE(
    "a frame of another size takes no place: both small pictures are those of the frame that was searched") {
  Search search;
  FrameView small = window_at(search.picture, 60, 124);
  small.width -= 8;
  const SmallPictures shown = search.matcher->move_on(small);
  CHECK(search.matcher->searched().data[0] == *search.picture.at(100, 100));
  CHECK(std::equal(shown.before.data, shown.before.data + kWidth / 4 * kHeight / 4, shown.now.data));
}

}  // namespace print_matcher_test
