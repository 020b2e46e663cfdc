#include "pliant/pyramid.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "aligned_block.hpp"
#include "texture.hpp"

namespace pyramid_test {

using namespace pliant;
using texture::Picture;

namespace {

struct Room {
  AlignedBlock block{1 << 22};
  Arena arena{block.data(), block.size()};
};

// The definition, in the plainest way.
int smoothed(const ImageView& v, int x, int y) {
  const int w[5] = {1, 4, 6, 4, 1};
  const auto reflected = [](int i, int n) { return i < 0 ? -i : i >= n ? 2 * n - 2 - i : i; };
  int sum = 0;
  for (int j = -2; j <= 2; ++j)
    for (int i = -2; i <= 2; ++i)
      sum += w[i + 2] * w[j + 2] * v.data[reflected(y + j, v.height) * v.stride + reflected(x + i, v.width)];
  return (sum + 128) >> 8;
}

int differences_from_definition(const Pyramid& p) {
  int wrong = 0;
  for (int l = 1; l < p.levels(); ++l) {
    const ImageView &fine = p.level(l - 1), &coarse = p.level(l);
    REQUIRE(coarse.width == (fine.width + 1) / 2);
    REQUIRE(coarse.height == (fine.height + 1) / 2);
    for (int y = 0; y < coarse.height; ++y)
      for (int x = 0; x < coarse.width; ++x)
        wrong += coarse.data[y * coarse.stride + x] != smoothed(fine, 2 * x, 2 * y);
  }
  return wrong;
}

}  // namespace

TEST_CASE("every pixel of every level is the binomial of the level below, for even, odd and tiny sizes") {
  const int sizes[][2] = {{320, 240}, {321, 239}, {8, 8}, {9, 8}, {8, 17}, {33, 64}, {127, 61}};
  for (const auto& s : sizes) {
    CAPTURE(s[0]);
    CAPTURE(s[1]);
    Room room;
    Pyramid p;
    REQUIRE(p.create(room.arena, {s[0], s[1], 5, true}) == Status::ok);
    const Picture picture = texture::noise(s[0], s[1], 7);
    REQUIRE(p.build(picture.frame()) == Status::ok);
    for (std::size_t i = 0; i < picture.pixels.size(); ++i) REQUIRE(p.level(0).data[i] == picture.pixels[i]);
    CHECK(differences_from_definition(p) == 0);
  }
}

TEST_CASE("white stays white and black stays black on every level") {
  for (const int grey : {0, 255}) {
    Room room;
    Pyramid p;
    REQUIRE(p.create(room.arena, {64, 48, 3, true}) == Status::ok);
    REQUIRE(p.build(Picture(64, 48, static_cast<std::uint8_t>(grey)).frame()) == Status::ok);
    const ImageView& v = p.level(2);
    for (int i = 0; i < v.width * v.height; ++i) CHECK(v.data[i] == grey);
  }
}

TEST_CASE("levels that would be smaller than eight pixels are left out") {
  Room room;
  Pyramid p;
  REQUIRE(p.create(room.arena, {40, 20, 6, true}) == Status::ok);
  CHECK(p.levels() == 0);
  REQUIRE(p.build(Picture(40, 20).frame()) == Status::ok);
  CHECK(p.levels() == 2);
  CHECK(p.level(1).height == 10);
}

TEST_CASE("a packed frame gives the levels of its luma") {
  const Picture luma = texture::noise(40, 32, 3);
  std::vector<std::uint8_t> yuyv(luma.pixels.size() * 2 + 32 * 6, 77);
  const std::size_t stride = 40 * 2 + 6;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 40; ++x)
      yuyv[static_cast<std::size_t>(y) * stride + static_cast<std::size_t>(2 * x)] =
          luma.pixels[static_cast<std::size_t>(y * 40 + x)];
  FrameView packed = luma.frame();
  packed.data = yuyv.data();
  packed.stride_bytes = stride;
  packed.pixel_step_bytes = 2;
  Room room;
  Pyramid a, b;
  REQUIRE(a.create(room.arena, {40, 32, 2, true}) == Status::ok);
  REQUIRE(b.create(room.arena, {40, 32, 2, true}) == Status::ok);
  REQUIRE(a.build(luma.frame()) == Status::ok);
  REQUIRE(b.build(packed) == Status::ok);
  for (int l = 0; l < 2; ++l)
    for (int i = 0; i < a.level(l).width * a.level(l).height; ++i)
      REQUIRE(a.level(l).data[i] == b.level(l).data[i]);
}

TEST_CASE("without a copy level 0 is the frame itself, rows apart or not") {
  const Picture wide = texture::noise(100, 30, 9);
  FrameView part = wide.frame();
  part.width = 64;
  Room room;
  Pyramid p;
  REQUIRE(p.create(room.arena, {64, 30, 2, false}) == Status::ok);
  REQUIRE(p.build(part) == Status::ok);
  CHECK(p.level(0).data == wide.pixels.data());
  CHECK(p.level(0).stride == 100);
  CHECK(differences_from_definition(p) == 0);
  part.pixel_step_bytes = 2;
  part.stride_bytes = 200;
  CHECK(p.build(part) == Status::bad_argument);
}

TEST_CASE("swapping makes the current pyramid the previous one") {
  Room room;
  Pyramid a, b;
  REQUIRE(a.create(room.arena, {16, 16, 1, true}) == Status::ok);
  REQUIRE(b.create(room.arena, {16, 16, 1, true}) == Status::ok);
  REQUIRE(a.build(Picture(16, 16, 10).frame()) == Status::ok);
  a.swap(b);
  CHECK(a.levels() == 0);
  REQUIRE(a.build(Picture(16, 16, 20).frame()) == Status::ok);
  CHECK(b.level(0).data[0] == 10);
  CHECK(a.level(0).data[0] == 20);
}

TEST_CASE("bad limits and frames are refused and change nothing") {
  Room room;
  Pyramid p;
  CHECK(p.build(Picture(16, 16).frame()) == Status::not_ready);
  for (const PyramidLimits& l :
       {PyramidLimits{7, 16, 1}, PyramidLimits{16, 7, 1}, PyramidLimits{16385, 16, 1},
        PyramidLimits{16, 16, 0}, PyramidLimits{16, 16, 7}, PyramidLimits{-1, -1, 1}})
    CHECK(p.create(room.arena, l) == Status::bad_argument);
  CHECK(room.arena.used_bytes() == 0);
  REQUIRE(p.create(room.arena, {16, 16, 1}) == Status::ok);
  const Picture good(16, 16, 50);
  REQUIRE(p.build(good.frame()) == Status::ok);
  FrameView f = good.frame();
  f.data = nullptr;
  CHECK(p.build(f) == Status::bad_argument);
  f = good.frame();
  f.stride_bytes = 15;
  CHECK(p.build(f) == Status::bad_argument);
  CHECK(p.build(Picture(16, 17).frame()) == Status::size_mismatch);
  CHECK(p.level(0).data[255] == 50);
}

TEST_CASE("every smaller arena fails cleanly, and the measured size is enough") {
  const PyramidLimits limits{40, 24, 3, true};
  const std::size_t bytes = measured_bytes<Pyramid>(limits);
  CHECK(bytes < 40 * 24 * 3 / 2 + 300);
  AlignedBlock block(bytes);
  for (std::size_t n = 0; n <= bytes; ++n) {
    Arena arena(block.data(), n);
    Pyramid p;
    const Status s = p.create(arena, limits);
    REQUIRE(s == (n < bytes ? Status::out_of_memory : Status::ok));
    REQUIRE(arena.used_bytes() == (n < bytes ? 0 : bytes));
  }
}

}  // namespace pyramid_test
