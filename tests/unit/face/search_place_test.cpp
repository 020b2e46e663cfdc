#include "face/search_place.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "face/detector_table.hpp"
#include "face/scaled_lines.hpp"

namespace search_place_test {

using namespace pliant;

TEST_CASE("every window of every size is met exactly once, in strips of bounded width") {
  for (const int width : {40, 320, 321, 700, 1500}) {
    CAPTURE(width);
    SearchPlace at;
    std::set<std::pair<int, int>> windows;
    int ratio = 0, sizes = 0, most = 0;
    const auto check_size = [&] {
      if (ratio == 0) return;
      const int cells = (width * ScaledLines::kUnit / ratio + 3) / 4 + 6,
                rows = (400 * ScaledLines::kUnit / ratio + 3) / 4 + 6;
      CHECK(static_cast<int>(windows.size()) == (cells - kWindowCells + 1) * (rows - kWindowCells + 1));
    };
    for (at.begin(width, 400, 48); !at.is_complete(); at.advance()) {
      if (at.ratio() != ratio) {
        check_size();
        windows.clear();
        ratio = at.ratio();
        ++sizes;
      }
      most = std::max(most, at.columns());
      const int row = at.row() - (kWindowCells - 1);
      if (row < -3) continue;
      for (int k = 0; k + kWindowCells <= at.columns(); ++k)
        REQUIRE(windows.insert({at.first_column() + k, row}).second);
    }
    check_size();
    CHECK(most <= SearchPlace::most_columns(width));
    CHECK(sizes >= 1);
  }
}

/// Of the boxes from this place on.
float smallest_side(SearchPlace at) {
  float side = at.box(0, 0).side;
  for (; !at.is_complete(); at.advance()) side = std::min(side, at.box(0, 0).side);
  return side;
}

TEST_CASE("the smallest box has the size asked for, the largest exceeds the frame's smaller side a little") {
  for (const int smallest : {48, 60, 100}) {
    SearchPlace at;
    at.begin(320, 240, smallest);
    CHECK(at.box(0, 0).side > 200);
    CHECK(at.box(0, 0).side <= 1.25f * 240);
    CHECK(smallest_side(at) == doctest::Approx(smallest).epsilon(0.01));
  }
}

TEST_CASE("no box is smaller than a window, whatever is asked for") {
  for (const int smallest : {-5, 0, 10, 47}) {
    SearchPlace at;
    at.begin(320, 240, smallest);
    CHECK(smallest_side(at) == kWindowPx);
  }
}

TEST_CASE("four sizes are an octave, in equal ratios, from the largest to the smallest") {
  SearchPlace at;
  float last = 0;
  int sizes = 0;
  for (at.begin(1280, 960, 48); !at.is_complete(); at.advance()) {
    const float side = at.box(0, 0).side;
    if (side == last) continue;
    if (last > 0) CHECK(last / side == doctest::Approx(std::pow(2.0, 0.25)).epsilon(0.005));
    last = side;
    ++sizes;
  }
  CHECK(sizes > 16);
}

TEST_CASE("a window's middle is the middle of the pixels that it covers") {
  SearchPlace at;
  for (at.begin(320, 240, 48); at.ratio() != ScaledLines::kUnit;) at.advance();
  const FaceBox box = at.box(3, 0);  // the first column is three cells left of the frame
  CHECK(box.center.x == 23.5f);
  CHECK(box.center.y == 23.5f);
}

TEST_CASE("frames without room for a face are complete at once") {
  for (const int side : {1, 20, 39}) {
    SearchPlace at;
    at.begin(side, 500, 48);
    CHECK(at.is_complete());
    at.begin(500, side, 48);
    CHECK(at.is_complete());
  }
  for (const int width : {40, 500}) {
    SearchPlace at;
    at.begin(width, 540 - width, 48);
    CHECK_FALSE(at.is_complete());
  }
  for (const int width : {1, 16, 40}) CHECK(SearchPlace::most_columns(width) >= kWindowCells);
  SearchPlace at;
  at.begin(8192, 8192, 65535);
  CHECK(at.is_complete());
}

TEST_CASE("near a box are its windows of five sizes, none far from it and none that the whole search lacks") {
  using Window = std::pair<float, std::pair<float, float>>;  // side, middle
  const auto windows = [](SearchPlace at) {
    std::set<Window> all;
    for (; !at.is_complete(); at.advance())
      for (int k = 0; k + kWindowCells <= at.columns(); ++k)
        if (const int row = at.row() - (kWindowCells - 1); row >= at.first_row()) {
          const FaceBox box = at.box(k, row);
          all.insert({box.side, {box.center.x, box.center.y}});
        }
    return all;
  };
  SearchPlace at;
  at.begin(320, 240, 48);
  const auto all = windows(at);
  for (const FaceBox box : {FaceBox{{160, 120}, 81}, FaceBox{{20, 220}, 68}, FaceBox{{300, 40}, 48}}) {
    CAPTURE(box.side);
    at.begin_near(320, 240, 48, box);
    const auto near = windows(at);
    CHECK(near.size() > 60);
    CHECK(near.size() < all.size() / 8);
    std::set<float> sides;
    for (const Window& w : near) {
      CHECK(all.count(w) == 1);
      sides.insert(w.first);
      const float most = 0.25f * box.side + w.first / kWindowCells + 1;  // a cell and a pixel
      CHECK(std::abs(w.second.first - box.center.x) < most);
      CHECK(std::abs(w.second.second - box.center.y) < most);
    }
    CHECK(sides.size() == (box.side > 60 ? 5 : 3));  // none is smaller than the smallest
    CHECK(*sides.begin() * 1.5f > box.side);
    CHECK(*sides.rbegin() < 1.5f * box.side);
    const float near_px = 0.25f * box.side - 1;
    for (const Window& w : all)
      if (sides.count(w.first) == 1 && std::abs(w.second.first - box.center.x) < near_px &&
          std::abs(w.second.second - box.center.y) < near_px)
        CHECK(near.count(w) == 1);
  }
  at.begin(320, 240, 48);  // the whole frame again
  CHECK(windows(at) == all);
}

TEST_CASE("near a box that is outside of the frame, tiny or huge there is an end") {
  for (const FaceBox box : {FaceBox{{-1e4f, 1e4f}, 80}, FaceBox{{160, 120}, 1}, FaceBox{{160, 120}, 1e4f}}) {
    SearchPlace at;
    int rows = 0;
    for (at.begin_near(320, 240, 48, box); !at.is_complete(); at.advance()) ++rows;
    CHECK(rows < 100);
  }
}

TEST_CASE("a box far outside of the frame is searched for at its border, however far") {
  const auto places = [](Vec2 center) {
    std::vector<std::vector<int>> rows;
    SearchPlace at;
    for (at.begin_near(320, 240, 48, {center, 80}); !at.is_complete(); at.advance())
      rows.push_back({at.ratio(), at.first_column(), at.columns(), at.row()});
    return rows;
  };
  for (const Vec2 way : {Vec2{-1, 0}, Vec2{1, 0}, Vec2{0, -1}, Vec2{0, 1}}) {
    const auto outside = places({160 + 300 * way.x, 120 + 300 * way.y});
    CHECK(outside.size() > 0);
    for (const float far : {1e4f, 1e30f}) CHECK(places({160 + far * way.x, 120 + far * way.y}) == outside);
  }
}

}  // namespace search_place_test
