// Templates: their gradients, what is stored of them, and what a warp makes of them; and the system that is solved
// with them.
#include "vision/patch_template.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "aligned_block.hpp"
#include "patch_rig.hpp"
#include "vision/patch_sums.hpp"
#include "vision/patch_warp_system.hpp"

namespace patch_template_test {

using namespace pliant;
using namespace pliant::patch;
using namespace patch_rig;
using texture::Texture;

namespace {

struct Bench {
  AlignedBlock block{1 << 16};
  Arena arena{block.data(), block.size()};
  Workspace work;
  explicit Bench(int window) { work.lay_out(arena, window); }
};

struct Stored {
  StoredTemplate at;
  int side;
  std::vector<std::uint8_t> pixels;
  Stored(const Picture& p, Vec2 x, const PatchLimits& limits)
      : side(stored_side(limits)), pixels(static_cast<std::size_t>(side * side) + 64) {
    store_template(p.view(), x, side, at, pixels.data());
  }
};

// The arrays of the active template, one after the other.
std::vector<i16> contents(const Workspace& work) {
  std::vector<i16> all;
  const Template& t = work.active;
  for (const i16* array : {t.t, t.gx, t.gy, t.m})
    all.insert(all.end(), array, array + work.window * work.window);
  return all;
}

const PatchLimits kLimits{1, 11, 1, 4};

}  // namespace

TEST_CASE("a template holds grey levels and their Scharr gradients") {
  Picture slope(40, 40);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x) slope.at(x, y) = static_cast<std::uint8_t>(40 + 3 * x + y);
  Bench b(11);
  load_template(slope.view(), 12, 14, b.work);
  for (int k = 0; k < 121; ++k) {
    CHECK(b.work.active.t[k] == kGreyScale * (40 + 3 * (12 + k % 11) + 14 + k / 11) - kGreyOffset);
    CHECK(b.work.active.gx[k] == 3 * kGreyScale);
    CHECK(b.work.active.gy[k] == kGreyScale);
    CHECK(b.work.active.m[k] == 1);
  }
}

TEST_CASE("clipped pixels and those outside the image are masked out") {
  Picture p = render(Texture(3), {}, 40, 40);
  p.at(15, 15) = 255;
  p.at(16, 15) = 0;
  Bench b(11);
  load_template(p.view(), 10, 10, b.work);
  CHECK(b.work.active.m[5 * 11 + 5] == 0);
  CHECK(b.work.active.gx[5 * 11 + 6] == 0);
  CHECK(b.work.active.m[5 * 11 + 7] == 1);
  load_template(p.view(), -3, 35, b.work);
  for (int k = 0; k < 121; ++k) CHECK(b.work.active.m[k] == (k % 11 >= 3 && k / 11 < 5));
}

TEST_CASE("beyond the image a stored template has the pixels of the border") {
  const Picture p = render(Texture(3), {}, 40, 40);
  for (const Vec2 x : {Vec2{2, 20}, Vec2{37, 20}, Vec2{20, 1}, Vec2{20, 38}, Vec2{0, 39}, Vec2{39, 0},
                       Vec2{30, 20}, Vec2{9, 20}}) {
    CAPTURE(x.x);
    CAPTURE(x.y);
    const Stored s(p, x, kLimits);
    const int left = static_cast<int>(x.x) - s.side / 2, top = static_cast<int>(x.y) - s.side / 2;
    const auto within = [](int k) { return k < 0 ? 0 : k > 39 ? 39 : k; };
    for (int j = 0; j < s.side; ++j)
      for (int i = 0; i < s.side; ++i)
        CHECK(s.pixels[static_cast<std::size_t>(j * s.side + i)] ==
              p.pixels[static_cast<std::size_t>(40 * within(top + j) + within(left + i))]);
  }
}

TEST_CASE("a stored template without a warp, or with the identity, is that of the image") {
  const Picture p = render(Texture(3), {}, 60, 60);
  Bench b(11);
  const Vec2 x{30.3f, 28.8f};
  const Stored s(p, x, kLimits);
  CHECK(s.at.offset.x == doctest::Approx(0.3).epsilon(1e-4));
  CHECK(s.at.offset.y == doctest::Approx(-0.2).epsilon(1e-4));
  load_template(p.view(), 30 - 5, 29 - 5, b.work);
  const std::vector<i16> direct = contents(b.work);
  load_template(s.at, s.pixels.data(), s.side, nullptr, b.work);
  CHECK(contents(b.work) == direct);
  const Mat2 identity;
  load_template(s.at, s.pixels.data(), s.side, &identity, b.work);
  CHECK(contents(b.work) == direct);
}

TEST_CASE("wherever a template is, its mask has what is inside the image, and the stored one is the same") {
  constexpr int kWide = 40, kHigh = 34;
  const Picture p = render(Texture(3), {}, kWide, kHigh);
  Bench b(11);
  for (int y = 0; y < kHigh; y += y == 7 ? 17 : 1)
    for (int x = 0; x < kWide; x += x == 7 ? 23 : 1) {
      CAPTURE(x);
      CAPTURE(y);
      load_template(p.view(), x - 5, y - 5, b.work);
      int wrong = 0;
      for (int k = 0; k < 121; ++k) {
        const int i = x - 5 + k % 11, j = y - 5 + k / 11;
        wrong += b.work.active.m[k] != (i >= 0 && i < kWide && j >= 0 && j < kHigh);
      }
      CHECK(wrong == 0);
      const std::vector<i16> direct = contents(b.work);
      const Stored s(p, {static_cast<float>(x), static_cast<float>(y)}, kLimits);
      load_template(s.at, s.pixels.data(), s.side, nullptr, b.work);
      CHECK((contents(b.work) == direct));
    }
}

TEST_CASE("a warped template's mask has what comes from between pixels of the image") {
  constexpr int kWide = 40, kHigh = 34;
  const Picture p = render(Texture(3), {}, kWide, kHigh);
  Bench b(11);
  constexpr float kHalf = 0.70710678f;
  for (const Mat2& warp :
       {Mat2{kHalf, -kHalf, kHalf, kHalf}, Mat2{1, 0, 0, 2.5f}, Mat2{1.2f, 0.5f, -0.3f, 0.9f}})
    for (const Vec2 x :
         {Vec2{20, 17}, Vec2{5, 17}, Vec2{34, 17}, Vec2{20, 5}, Vec2{20, 28}, Vec2{3, 30}, Vec2{36, 2}}) {
      CAPTURE(x.x);
      CAPTURE(x.y);
      const Stored s(p, x, kLimits);
      load_template(s.at, s.pixels.data(), s.side, &warp, b.work);
      const float middle = static_cast<float>(s.side / 2);
      int wrong = 0;
      for (int k = 0; k < 121; ++k) {
        const Vec2 at = warp * Vec2{static_cast<float>(k % 11 - 5), static_cast<float>(k / 11 - 5)};
        const auto is_between = [middle](float offset, float centre, int size, bool* is_sure) {
          const float low = max(-middle, -centre), high = min(middle, static_cast<float>(size - 1) - centre);
          *is_sure = *is_sure && magnitude(offset - low) > 0.01f && magnitude(offset - high) > 0.01f;
          return offset >= low && offset < high;
        };
        bool is_sure = true;
        const bool across = is_between(at.x, x.x, kWide, &is_sure),
                   down = is_between(at.y, x.y, kHigh, &is_sure);
        wrong += is_sure && b.work.active.m[k] != (across && down);
      }
      CHECK(wrong == 0);
    }
}

TEST_CASE("a quarter turn exchanges the axes of the grey levels") {
  const Picture p = render(Texture(3), {}, 60, 60);
  Bench b(11);
  const Stored s(p, {30, 30}, kLimits);
  const Mat2 turn{0, -1, 1, 0};
  load_template(s.at, s.pixels.data(), s.side, &turn, b.work);
  for (int j = -5; j <= 5; ++j)
    for (int i = -5; i <= 5; ++i) {
      const int here = b.work.active.t[(j + 5) * 11 + i + 5];
      CHECK(here == kGreyScale * p.pixels[static_cast<std::size_t>((30 + i) * 60 + 30 - j)] - kGreyOffset);
    }
}

TEST_CASE("a stretch beyond the template margin masks out what leaves the stored square") {
  const Picture p = render(Texture(3), {}, 60, 60);
  Bench b(11);
  const Stored s(p, {30, 30}, kLimits);
  const Mat2 stretch{2.5f, 0, 0, 1};
  load_template(s.at, s.pixels.data(), s.side, &stretch, b.work);
  for (int j = -5; j <= 5; ++j)
    for (int i = -5; i <= 5; ++i) {
      const bool is_stored = 2.5 * i >= -10 && 2.5 * i < 10;  // the square has 21 pixels
      CHECK(b.work.active.m[(j + 5) * 11 + i + 5] == is_stored);
    }
}

namespace {

/// What each unknown of a fit is multiplied by, of the active template.
struct UnknownImages {
  const i16* images[10];

  explicit UnknownImages(Workspace& w)
      : images{w.x,          w.y,          w.active.t,  w.stretch[0], w.stretch[1],
               w.stretch[2], w.stretch[3], w.active.gx, w.active.gy,  w.active.m} {
    multiply_by_position(w.active.gx, w.x, w.y, w.count, w.stretch[0], w.stretch[1]);
    multiply_by_position(w.active.gy, w.x, w.y, w.count, w.stretch[2], w.stretch[3]);
  }
};

}  // namespace

TEST_CASE(
    "the fit of an image that is a template with light, a ramp of it, a small warp and a shift recovers "
    "them") {
  const Picture p = render(Texture(3), {}, 60, 60);
  Bench b(13);
  Workspace& work = b.work;
  load_template(p.view(), 24, 24, work);
  const UnknownImages of(work);
  const auto& images = of.images;
  Sym2 even{};
  for (const float ramp_sd : {0.0f, 1.0f}) {
    prepare(images, 13, ramp_sd, false, *work.system);
    const WarpSystem& system = *work.system;
    REQUIRE(system.is_solvable);
    CHECK(system.n == 169);
    const float truth[] = {4,    -3,    0.8f, 0.2f, -0.3f,
                           0.1f, 0.25f, 0.4f, -0.3f};  // the ramp in 16ths of a grey level
    for (int k = 0; k < 169; ++k) {
      float v = 150;  // bias
      for (int i = system.first; i < kUnknowns; ++i) v += truth[i] * static_cast<float>(images[i][k]);
      work.image[k] = static_cast<i16>(v < 0 ? v - 0.5f : v + 0.5f);
    }
    const Mat2 expected{truth[kStretch], truth[kStretch + 1], truth[kStretch + 2], truth[kStretch + 3]};
    const WarpFit known = fit(system, expected, work.image, work.count);
    for (int i = system.first; i < kUnknowns; ++i)
      CHECK(known.x[i] == doctest::Approx(double(truth[i])).epsilon(0.01));
    // Without knowing the stretch, its prior pulls it towards zero.
    const WarpFit unknown = fit(system, {0, 0, 0, 0}, work.image, work.count);
    for (int i = 0; i < 4; ++i) CHECK(magnitude(unknown.x[kStretch + i]) < magnitude(truth[kStretch + i]));
    const Sym2 s = shift_information(system, 1);
    CHECK(s.xx * s.yy - s.xy * s.xy > 0);
    if (ramp_sd > 0) CHECK(s.xx + s.yy < even.xx + even.yy);  // a ramp costs information
    even = s;
  }
}

TEST_CASE("a picture whose rows and columns change places has the same information with its axes exchanged") {
  const Picture p = render(Texture(3), {}, 60, 60);
  Picture q = p;
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 60; ++x) q.at(x, y) = p.pixels[static_cast<std::size_t>(60 * x + y)];
  const auto information_of = [](const Picture& picture) {
    Bench b(13);
    Workspace& work = b.work;
    load_template(picture.view(), 24, 24, work);
    prepare(UnknownImages(work).images, 13, 0, false, *work.system);
    REQUIRE(work.system->is_solvable);
    return shift_information(*work.system, 1);
  };
  const Sym2 a = information_of(p), b = information_of(q);
  CHECK(magnitude(a.xy) > 0.02f * (a.xx + a.yy));  // the texture has a direction
  CHECK(b.xx == doctest::Approx(double(a.yy)).epsilon(1e-3));
  CHECK(b.xy == doctest::Approx(double(a.xy)).epsilon(1e-3));
  CHECK(b.yy == doctest::Approx(double(a.xx)).epsilon(1e-3));
}

}  // namespace patch_template_test
