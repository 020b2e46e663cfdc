// The part of a frame that is matched: it stays in the frame, moves with its centre, and shows the frame's pixels.
#include "track/frame_region.hpp"

#include <doctest/doctest.h>

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

TEST_CASE("the previous region is kept where limits say so") {
  const Picture picture;
  TrackerLimits limits;
  InArena<FrameRegion> region(limits);
  CHECK(region->is_whole_frame());
  CHECK(region->keeps_previous());
  REQUIRE(region->build(picture.view(), {}) == Status::ok);
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
  view.data = nullptr;
  CHECK(in_place->check_frame(view) == Status::bad_argument);
  view = picture.view();
  view.pixel_step_bytes = 2;
  view.stride_bytes = 2 * kWidth;
  CHECK(in_place->check_frame(view) == Status::bad_argument);
  CHECK(copied->check_frame(view) == Status::ok);
}

}  // namespace frame_region_test
