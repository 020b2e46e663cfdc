#include "face/turned_picture.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "aligned_block.hpp"
#include "texture.hpp"

namespace turned_picture_test {

using namespace pliant;
using texture::Picture;

namespace {

struct Rig {
  AlignedBlock block;
  Arena arena;
  TurnedPicture picture;

  Rig(int width, int height)
      : block(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) + 64),
        arena(block.data(), block.size()) {
    picture.lay_out(arena, width, height);
    REQUIRE_FALSE(arena.exhausted());
  }
  int at(int x, int y) const {
    const FrameView& v = picture.view();
    return v.data[static_cast<std::size_t>(y) * v.stride_bytes + static_cast<std::size_t>(x)];
  }
};

/// Smooth, so that interpolation is exact to a grey level or two.
Picture waves(int width, int height) {
  Picture p(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      p.at(x, y) =
          static_cast<std::uint8_t>(120 + 60 * std::sin(0.05 * x) + 50 * std::cos(0.07 * y + 0.02 * x));
  return p;
}

Vec2 place(int x, int y) {
  return {static_cast<float>(x), static_cast<float>(y)};
}

}  // namespace

TEST_CASE("quarters of a turn move pixels, and change none") {
  Picture p = texture::noise(31, 22, 3);
  Rig rig(31, 22);
  for (const int turn : {0, 2, 4, 6}) {
    CAPTURE(turn);
    rig.picture.draw(p.frame(), turn);
    const FrameView& v = rig.picture.view();
    CHECK(v.width == (turn % 4 == 0 ? 31 : 22));
    CHECK(v.height == (turn % 4 == 0 ? 22 : 31));
    for (int y = 0; y < v.height; ++y)
      for (int x = 0; x < v.width; ++x) {
        const Vec2 from = rig.picture.to_frame({place(x, y), 1}).center;
        // The last row and column are read from just before their middle.
        REQUIRE(std::abs(rig.at(x, y) - p.at(static_cast<int>(from.x), static_cast<int>(from.y))) <= 1);
      }
  }
  // What points to the right in the frame points up where a quarter turn clockwise is undone.
  Picture arrow(40, 40, 0);
  arrow.at(35, 20) = 255;
  Rig square(40, 40);
  square.picture.draw(arrow.frame(), 2);
  CHECK(square.at(20, 4) == 255);
}

TEST_CASE("odd eighths show the whole frame in a square of as many pixels, at most") {
  for (const auto& size : {std::pair{96, 72}, {72, 96}, {97, 61}, {64, 64}, {300, 40}}) {
    const int width = size.first, height = size.second;
    CAPTURE(width);
    Picture p = waves(width, height);
    Rig rig(width, height);
    for (const int turn : {1, 3, 5, 7}) {
      rig.picture.draw(p.frame(), turn);
      const FrameView& v = rig.picture.view();
      CHECK(v.width == v.height);
      CHECK(v.width * v.height <= width * height);
      CHECK((v.width + 1) * (v.width + 1) > width * height);
      int compared = 0;
      for (int y = 0; y < v.height; ++y)
        for (int x = 0; x < v.width; ++x) {
          const Vec2 from = rig.picture.to_frame({place(x, y), 1}).center;
          const int i = static_cast<int>(from.x), j = static_cast<int>(from.y);
          if (from.x < 0 || from.y < 0 || i + 1 >= width || j + 1 >= height) continue;
          ++compared;
          const double a = static_cast<double>(from.x) - i, b = static_cast<double>(from.y) - j;
          const double truth = (1 - b) * ((1 - a) * p.at(i, j) + a * p.at(i + 1, j)) +
                               b * ((1 - a) * p.at(i, j + 1) + a * p.at(i + 1, j + 1));
          REQUIRE(std::abs(rig.at(x, y) - truth) < 1.6);
        }
      CHECK(compared > v.width * v.height / 20);
      // The corners of the frame are in the picture.
      for (const int corner : {0, 1, 2, 3}) {
        const Vec2 at =
            rig.picture.from_frame({place(corner % 2 * (width - 1), corner / 2 * (height - 1)), 1}).center;
        CHECK(min(at.x, at.y) >= -0.5f);
        CHECK(max(at.x, at.y) <= static_cast<float>(v.width) - 0.5f);
      }
    }
  }
}

TEST_CASE("where the frame's pixels are not square, those of the picture are") {
  for (const float aspect : {0.5f, 0.8f, 1.25f, 2.0f}) {
    CAPTURE(aspect);
    Picture p(96, 80);  // a disc
    for (int y = 0; y < 80; ++y)
      for (int x = 0; x < 96; ++x) {
        const Vec2 d = place(x, y) - Vec2{50, 38};
        p.at(x, y) = length(Vec2{d.x, d.y / aspect}) < 18 ? 200 : 50;
      }
    Rig rig(96, 80);
    for (int turn = 0; turn < kTurnsOfPicture; ++turn) {
      CAPTURE(turn);
      rig.picture.draw(p.frame(), turn, aspect);
      const FaceBox disc = rig.picture.from_frame({{50, 38}, 36});
      int count = 0;
      float farthest = 0;
      for (int y = 0; y < rig.picture.view().height; ++y)
        for (int x = 0; x < rig.picture.view().width; ++x)
          if (rig.at(x, y) > 125) ++count, farthest = max(farthest, length(place(x, y) - disc.center));
      CHECK(farthest < 0.5f * disc.side + 1.5f);
      CHECK(count == doctest::Approx(double(0.785f * disc.side * disc.side)).epsilon(0.1));
    }
  }
}

TEST_CASE("boxes go there and back") {
  Picture p(90, 70, 9);
  Rig rig(90, 70);
  for (int turn = 0; turn < kTurnsOfPicture; ++turn) {
    for (const float aspect : {0.5f, 1.0f, 2.0f}) {
      rig.picture.draw(p.frame(), turn, aspect);
      const FaceBox box{{20, 31}, 25}, back = rig.picture.to_frame(rig.picture.from_frame(box));
      CHECK(length(back.center - box.center) < 1e-3f);
      CHECK(back.side == doctest::Approx(25));
    }
    rig.picture.draw(p.frame(), turn);
    const FaceBox there = rig.picture.to_frame({{20, 31}, 25});
    const double side_px = std::floor(std::sqrt(90.0 * 70)), ratio = (90 + 70) / std::sqrt(2.0) / side_px;
    CHECK(there.side == doctest::Approx(turn % 2 == 0 ? 25 : 25 * ratio).epsilon(1e-3));
  }
}

TEST_CASE(
    "the turn of a rotation is that of its roll, however the head is turned; an even one up to 30 degrees") {
  for (int degrees = -179; degrees < 180; degrees += 7) {
    CAPTURE(degrees);
    const int quarter = static_cast<int>(std::lround(degrees / 90.0)), from_quarter = degrees - 90 * quarter;
    if (std::abs(from_quarter) == 30) continue;  // either
    const int turn = (2 * quarter + (from_quarter > 30 ? 1 : from_quarter < -30 ? -1 : 0) + 8) % 8;
    const Quat roll = exp_rotation({0, 0, 0.01745329f * static_cast<float>(degrees)});
    CHECK(turn_of(roll) == turn);
    if (std::abs(from_quarter) < 20) {
      CHECK(turn_of(roll * exp_rotation({0, 0.4f, 0})) == turn);
      CHECK(turn_of(roll * exp_rotation({0.4f, 0, 0})) == turn);
    }
  }
}

TEST_CASE(
    "packed pixels and wide rows are read, the smallest frame too, and nothing beyond the layout is "
    "written") {
  Picture p = waves(40, 30);
  std::vector<std::uint8_t> packed(30 * 100, 255);
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x) packed[static_cast<std::size_t>(100 * y + 2 * x)] = p.at(x, y);
  FrameView view = p.frame();
  view.data = packed.data();
  view.pixel_step_bytes = 2;
  view.stride_bytes = 100;
  Rig plain(40, 30), wide(40, 30);
  for (int turn = 0; turn < kTurnsOfPicture; ++turn) {
    plain.picture.draw(p.frame(), turn);
    wide.picture.draw(view, turn);
    const FrameView &a = plain.picture.view(), &b = wide.picture.view();
    CHECK(std::memcmp(a.data, b.data, static_cast<std::size_t>(a.width * a.height)) == 0);
  }
  for (const auto& [width, height] : {std::pair{2, 2}, {2, 9}, {8192, 2}, {5000, 5002}, {4999, 5003}}) {
    const std::size_t bytes = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    Rig rig(width, height);
    std::memset(rig.block.data() + (bytes + 15) / 16 * 16, 77, 16);
    const Picture grey(width, height, 50);
    for (const auto& [turn, aspect] : {std::pair{1, 1.0f}, {2, 1.0f}, {1, 0.5f}, {7, 2.0f}, {0, 2.0f}}) {
      rig.picture.draw(grey.frame(), turn, aspect);
      CHECK(static_cast<std::size_t>(rig.picture.view().width * rig.picture.view().height) <= bytes);
      CHECK(rig.at(0, 0) == 50);
      CHECK(rig.at(rig.picture.view().width - 1, rig.picture.view().height - 1) == 50);
    }
    CHECK(rig.block.data()[(bytes + 15) / 16 * 16] == 77);
  }
}

}  // namespace turned_picture_test
