// What a search of several frames knows of the motion meanwhile: the shift of a box from the frame whose corners were found.
#include "print/print_matcher.hpp"

#include <doctest/doctest.h>

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
    while (!matcher->step(1000)) {
    }
  }
  const PrintTable& opened() {
    REQUIRE(PrintTable::open(sheet().print(), &table) == Status::ok);
    return table;
  }
};

constexpr PixelBox kBox{100, 80, 220, 160};

}  // namespace

TEST_CASE("the shift of a box is found up to a quarter of the width, to about a pixel") {
  const struct { int x, y; } shifts[] = {{0, 0}, {3, -2}, {-17, 22}, {41, 10}, {-76, 0}, {0, 76}};
  for (const auto& by : shifts) {
    CAPTURE(by.x);
    CAPTURE(by.y);
    Search search;
    const Vec2 moved = search.matcher->move_on(window_at(search.picture, 100 - by.x, 100 - by.y), kBox);
    CHECK(length(moved - Vec2{static_cast<float>(by.x), static_cast<float>(by.y)}) < 1.5f);
    CHECK(search.matcher->searched().data[0] == *search.picture.at(100 - by.x, 100 - by.y));
  }
}

TEST_CASE(
    "where nothing tells, no shift is found: a flat frame, no box, a box outside, a frame of another size") {
  const Image flat(kWidth + 200, kHeight + 200, 1);
  FrameView small;
  for (const PixelBox& box : {kBox, PixelBox{}, PixelBox{400, 0, 500, 100}, PixelBox{100, 80, 104, 84}}) {
    Search search;
    const bool is_whole = box.x0 == kBox.x0 && box.x1 == kBox.x1;
    small = window_at(search.picture, 100, 100);
    small.width -= 8;
    CHECK(length(search.matcher->move_on(small, box)) == 0);
    CHECK(length(search.matcher->move_on(
              is_whole ? window_at(flat, 0, 0) : window_at(search.picture, 88, 104), box)) == 0);
  }
}

}  // namespace print_matcher_test
