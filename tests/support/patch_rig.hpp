#pragma once
// Helpers of the patch tracker's tests.
#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "aligned_block.hpp"
#include "pliant/corners.hpp"
#include "pliant/patch_tracker.hpp"
#include "texture.hpp"

namespace patch_rig {

using namespace pliant;
using texture::Motion;
using texture::Picture;
using texture::Texture;

constexpr int kWidth = 240, kHeight = 180;

// Two pyramids and a tracker in one block.
struct Rig {
  AlignedBlock block{1 << 21};
  Arena arena{block.data(), block.size()};
  Pyramid before, after;
  PatchTracker tracker;

  explicit Rig(PatchLimits limits = {200, 11, 3, 5}, int width = kWidth, int height = kHeight) {
    REQUIRE(before.create(arena, {width, height, limits.levels, true}) == Status::ok);
    REQUIRE(after.create(arena, {width, height, limits.levels, true}) == Status::ok);
    REQUIRE(tracker.create(arena, limits) == Status::ok);
  }
  void show(const Picture& a, const Picture& b) {
    REQUIRE(before.build(a.frame()) == Status::ok);
    REQUIRE(after.build(b.frame()) == Status::ok);
  }
};

inline std::vector<Vec2> corners_of(const Picture& p, std::size_t most = 150, int margin = 40) {
  CornerOptions o;
  AlignedBlock scratch(corner_scratch_bytes(p.width, p.height, o));
  Arena arena(scratch.data(), scratch.size());
  std::vector<Corner> found(most);
  int count = 0;
  REQUIRE(find_corners(p.view(), o, {}, arena, {found.data(), most}, count) == Status::ok);
  std::vector<Vec2> out;
  for (int i = 0; i < count; ++i) {
    const Vec2 x = found[static_cast<std::size_t>(i)].x;
    const float m = static_cast<float>(margin), w = static_cast<float>(p.width),
                h = static_cast<float>(p.height);
    if (x.x >= m && x.y >= m && x.x < w - m && x.y < h - m) out.push_back(x);
  }
  REQUIRE(out.size() > 5);
  return out;
}

inline Motion shift(double tx, double ty) {
  Motion m;
  m.tx = tx;
  m.ty = ty;
  return m;
}

inline Motion similarity(double degrees, double scale, double tx = 0, double ty = 0) {
  const double a = degrees * 3.14159265358979 / 180;
  Motion m;
  m.a = m.d = scale * std::cos(a);
  m.c = scale * std::sin(a);
  m.b = -m.c;
  m.tx = tx;
  m.ty = ty;
  return m;
}

inline Mat2 warp_of(const Motion& m) {
  return {static_cast<float>(m.a), static_cast<float>(m.b), static_cast<float>(m.c), static_cast<float>(m.d)};
}

}  // namespace patch_rig
