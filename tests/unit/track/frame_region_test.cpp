// The part of a frame that is matched: it stays in the frame, moves with its centre, and shows the frame's pixels.
#include "track/frame_region.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <vector>

#include "model_builder.hpp"
#include "pliant/tracker_profiles.hpp"

namespace frame_region_test {

using namespace pliant;

namespace {

constexpr int kWidth = 320, kHeight = 240;

struct Picture {
  std::vector<std::uint8_t> pixels = std::vector<std::uint8_t>(kWidth * kHeight);
  Picture() {
    for (int i = 0; i < kWidth * kHeight; ++i)
      pixels[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(i % 251);
  }
  FrameView view() const { return {pixels.data(), kWidth, kHeight, kWidth, 1, 0, 0}; }
};

std::uint8_t pixel(const Pyramid& pyramid, int x, int y) {
  const ImageView& level = pyramid.level(0);
  return level.data[y * level.stride + x];
}

TrackerLimits limits_of(std::uint16_t region) {
  TrackerLimits l = profile_s();
  l.region_width = l.region_height = region;
  return l;
}

}  // namespace

TEST_CASE("a region is placed around its centre, on the coarsest level's grid, and never leaves the frame") {
  const Picture picture;
  InArena<FrameRegion> region(limits_of(128));
  CHECK_FALSE(region->is_whole_frame());
  for (const Vec2 centre : {Vec2{160, 120}, Vec2{0, 0}, Vec2{1e6f, 1e6f}, Vec2{-1e6f, 200}, Vec2{163, 101}}) {
    REQUIRE(region->build(picture.view(), centre) == Status::ok);
    const PixelBox box = region->box();
    CHECK(box.x1 - box.x0 == 128);
    CHECK(box.y1 - box.y0 == 128);
    CHECK(box.x0 % 4 == 0);
    CHECK(box.y0 % 4 == 0);
    CHECK((box.x0 >= 0 && box.x1 <= kWidth && box.y0 >= 0 && box.y1 <= kHeight));
    CHECK(pixel(region->pyramid(), 5, 7) ==
          picture.pixels[static_cast<std::size_t>((box.y0 + 7) * kWidth + box.x0 + 5)]);
  }
  CHECK(region->contains(region->origin()));
  CHECK_FALSE(region->contains(region->origin() - Vec2{1, 0}));
  CHECK(region->contains(region->origin() + Vec2{127, 127}));
  CHECK_FALSE(region->contains(region->origin() + Vec2{128, 0}));
  CHECK_FALSE(region->contains(region->origin() + Vec2{0, 127.5f}));
  CHECK_FALSE(region->contains(region->origin() - Vec2{0, 0.5f}));
}

TEST_CASE("a region's middle is its centre, to a pixel of the coarsest level") {
  const Picture picture;
  TrackerLimits limits = limits_of(128);
  limits.region_height = 96;
  InArena<FrameRegion> region(limits);
  const struct {
    Vec2 centre;
    int x, y;  // of the region's first pixel; levels are 1, 2 and 4 px a pixel
  } kPlaces[] = {{{160, 120}, 96, 72}, {{103, 103}, 36, 52}, {{160, 180}, 96, 132}, {{160, 1000}, 96, 144}};
  for (const auto& place : kPlaces) {
    REQUIRE(region->build(picture.view(), place.centre) == Status::ok);
    const PixelBox box = region->box();
    CHECK((box.x0 == place.x && box.x1 == place.x + 128));
    CHECK((box.y0 == place.y && box.y1 == place.y + 96));
  }
}

TEST_CASE("a region of interleaved pixels shows those of its place") {
  std::vector<std::uint8_t> pairs(2 * kWidth * kHeight, 255);
  const Picture picture;
  for (std::size_t k = 0; k < picture.pixels.size(); ++k) pairs[2 * k] = picture.pixels[k];
  TrackerLimits limits = limits_of(128);
  limits.copies_frame = true;
  InArena<FrameRegion> region(limits);
  REQUIRE(region->build({pairs.data(), kWidth, kHeight, 2 * kWidth, 2, 0, 0}, {150, 90}) == Status::ok);
  const PixelBox box = region->box();
  CHECK((box.x0 > 0 && box.y0 > 0));
  CHECK(pixel(region->pyramid(), 5, 7) ==
        picture.pixels[static_cast<std::size_t>((box.y0 + 7) * kWidth + box.x0 + 5)]);
}

TEST_CASE("a frame that cannot be used leaves the region where it is") {
  const Picture picture;
  InArena<FrameRegion> region(limits_of(128));
  REQUIRE(region->build(picture.view(), {100, 100}) == Status::ok);
  const Vec2 origin = region->origin();
  FrameView pairs = picture.view();
  pairs.width = kWidth;
  pairs.pixel_step_bytes = 2;
  CHECK(region->build(pairs, {200, 150}) != Status::ok);
  CHECK(length(region->origin() - origin) == 0);
}

TEST_CASE("a previous region keeps its place and its pixels, even if the frame's memory is used again") {
  Picture picture;
  TrackerLimits limits = limits_of(128);
  limits.keeps_previous = true;
  limits.copies_frame = false;
  InArena<FrameRegion> region(limits);
  FrameView pairs{picture.pixels.data(), kWidth, kHeight, kWidth, 2, 0, 0};
  pairs.stride_bytes = 2 * kWidth;
  CHECK(region->check_frame(pairs) == Status::ok);  // it is copied
  REQUIRE(region->build(picture.view(), {100, 100}) == Status::ok);
  const Vec2 origin = region->origin();
  const std::uint8_t before = pixel(region->pyramid(), 10, 10);
  region->advance();
  for (auto& p : picture.pixels) p = static_cast<std::uint8_t>(p + 100);
  REQUIRE(region->build(picture.view(), {180, 150}) == Status::ok);
  CHECK(length(region->previous_origin() - origin) == 0);
  CHECK(length(region->origin() - origin) > 50);
  CHECK(pixel(region->previous_pyramid(), 10, 10) == before);
}

TEST_CASE("where no previous region is kept, the present one stays") {
  const Picture picture;
  InArena<FrameRegion> region(limits_of(128));
  REQUIRE_FALSE(region->keeps_previous());
  REQUIRE(region->build(picture.view(), {100, 100}) == Status::ok);
  const std::uint8_t before = pixel(region->pyramid(), 10, 10);
  region->advance();
  CHECK(pixel(region->pyramid(), 10, 10) == before);
}

TEST_CASE("the previous region is kept where limits say so") {
  const Picture picture;
  TrackerLimits limits;
  InArena<FrameRegion> region(limits);
  CHECK(region->is_whole_frame());
  CHECK(region->keeps_previous());
  const float none = std::numeric_limits<float>::quiet_NaN();
  REQUIRE(region->build(picture.view(), {none, 1e9f}) == Status::ok);  // a whole frame has its place
  CHECK(length(region->origin()) == 0);
  const std::uint8_t before = pixel(region->pyramid(), 10, 10);
  region->advance();
  Picture black;
  for (auto& p : black.pixels) p = 0;
  REQUIRE(region->build(black.view(), {}) == Status::ok);
  CHECK(pixel(region->previous_pyramid(), 10, 10) == before);
  CHECK(pixel(region->pyramid(), 10, 10) == 0);
}

TEST_CASE("frames of another size or format are refused") {
  const Picture picture;
  InArena<FrameRegion> in_place(limits_of(128)), copied(TrackerLimits{});
  FrameView view = picture.view();
  CHECK(in_place->check_frame(view) == Status::ok);
  view.width = kWidth - 1;
  CHECK(in_place->check_frame(view) == Status::size_mismatch);
  view = picture.view();
  view.height = kHeight - 1;
  CHECK(in_place->check_frame(view) == Status::size_mismatch);
  view = picture.view();
  // Rows so far apart are more than half of the address space where an address has 32 bits.
  const Status far_apart = sizeof(std::size_t) > 4 ? Status::ok : Status::bad_argument;
  view.stride_bytes = std::size_t{1} << 24;  // a frame that is used in place has offsets of 32 bits
  CHECK(in_place->check_frame(view) == far_apart);
  ++view.stride_bytes;
  CHECK(in_place->check_frame(view) == Status::bad_argument);
  CHECK(copied->check_frame(view) == far_apart);
  view = picture.view();
  view.data = nullptr;
  CHECK(in_place->check_frame(view) == Status::bad_argument);
  view = picture.view();
  view.pixel_step_bytes = 2;
  view.stride_bytes = 2 * kWidth;
  CHECK(in_place->check_frame(view) == Status::bad_argument);
  CHECK(copied->check_frame(view) == Status::ok);
}

}  // namespace frame_region_test
