// The patch tracker at its limits: no texture, no room, and bad arguments.
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "aligned_block.hpp"
#include "patch_rig.hpp"
#include "pliant/patch_tracker.hpp"

namespace patch_tracker_robustness_test {

using namespace patch_rig;

TEST_CASE("windows that leave the image are refused with that reason") {
  const Texture texture(2);
  const Picture a = render(texture, {}, kWidth, kHeight), b = render(texture, shift(-20, 0), kWidth, kHeight);
  Rig rig;
  rig.show(a, b);
  for (const Vec2 x :
       {Vec2{4, 90}, Vec2{235.5f, 90}, Vec2{120, 4.9f}, Vec2{120, 174.5f}, Vec2{-50, 90}, Vec2{1e9f, 3}}) {
    CHECK(rig.tracker.capture(0, rig.before, x) == PatchStatus::outside_image);
    CHECK(rig.tracker.track_between(rig.before, x, rig.after, {100, 100}).status ==
          PatchStatus::outside_image);
    CHECK(!rig.tracker.is_captured(0));
  }
  REQUIRE(rig.tracker.capture(0, rig.before, {5, 90}) == PatchStatus::ok);
  for (const Vec2 start : {Vec2{-1, 90}, Vec2{300, 90}, Vec2{1e30f, -1e30f}})
    CHECK(rig.tracker.track(0, rig.after, start).status == PatchStatus::outside_image);
  int inside = 0, found = 0;
  for (float y = 30; y < 150; y += 4)
    for (float x = 6; x < 30; x += 4) {
      const PatchResult r = rig.tracker.track_between(rig.before, {x, y}, rig.after, {max(x - 19, 0), y});
      const bool stays = x - 20 >= 5;
      inside += stays && r.status == PatchStatus::ok;
      found += !stays && r.status == PatchStatus::ok && magnitude(r.x.x - (x - 20)) < 1;
    }
  CHECK(inside > 20);
  CHECK(found == 0);
}

TEST_CASE("a patch found too near the border to be tracked back is refused, and the position is the start") {
  const Texture texture(2);
  Motion noisy;
  noisy.noise = 1;
  Rig rig;
  rig.show(render(texture, noisy, kWidth, kHeight, 3), render(texture, noisy, kWidth, kHeight, 4));
  PatchOptions options;
  options.max_return_px = 1;
  int refused = 0;
  for (float y = 20; y < 160; ++y) {  // found at x = 5 but for some thousandths
    const Vec2 start{5.5f, y};
    const PatchResult r = rig.tracker.track_between(rig.before, {5, y}, rig.after, start, options);
    if (r.status != PatchStatus::outside_image) continue;
    ++refused;
    CHECK(r.x.x == start.x);
    CHECK(r.x.y == start.y);
  }
  CHECK(refused > 5);
}

TEST_CASE("images without texture are flat: black, white, grey, an edge, one pixel of noise") {
  Picture edge(kWidth, kHeight, 60);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 120; x < kWidth; ++x) edge.at(x, y) = 180;
  Picture dot(kWidth, kHeight, 128);
  dot.at(120, 90) = 129;
  const Picture textured = render(Texture(2), {}, kWidth, kHeight);
  Rig rig;
  for (const Picture& p : {Picture(kWidth, kHeight, 0), Picture(kWidth, kHeight, 255),
                           Picture(kWidth, kHeight, 128), edge, dot}) {
    rig.show(p, textured);
    CHECK(rig.tracker.capture(0, rig.before, {120, 90}) == PatchStatus::flat);
    CHECK(rig.tracker.track_between(rig.before, {120, 90}, rig.after, {120, 90}).status == PatchStatus::flat);
  }
  for (const int grey : {0, 128, 255}) {
    rig.show(textured, Picture(kWidth, kHeight, static_cast<std::uint8_t>(grey)));
    REQUIRE(rig.tracker.capture(0, rig.before, {120, 90}) == PatchStatus::ok);
    const PatchResult r = rig.tracker.track(0, rig.after, {120, 90});
    CHECK(r.status != PatchStatus::ok);
    CHECK(is_finite(r.x));
  }
}

TEST_CASE("bad arguments are named and change nothing") {
  const Picture a = render(Texture(2), {}, kWidth, kHeight);
  Rig rig;
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const Pyramid empty;
  CHECK(rig.tracker.capture(0, rig.before, {100, 90}) == PatchStatus::bad_argument);  // never built
  rig.show(a, a);
  REQUIRE(rig.tracker.capture(0, rig.before, {100, 90}) == PatchStatus::ok);
  for (const int slot : {-1, 200, 1 << 30}) {
    CHECK(rig.tracker.capture(slot, rig.before, {100, 90}) == PatchStatus::bad_argument);
    CHECK(rig.tracker.track(slot, rig.after, {100, 90}).status == PatchStatus::bad_argument);
    CHECK(!rig.tracker.is_captured(slot));
    rig.tracker.release(slot);
  }
  for (const Vec2 x : {Vec2{nan, 90}, Vec2{100, nan}, Vec2{inf, 90}}) {
    CHECK(rig.tracker.capture(1, rig.before, x) == PatchStatus::bad_argument);
    CHECK(rig.tracker.track(0, rig.after, x).status == PatchStatus::bad_argument);
    CHECK(rig.tracker.track_between(rig.before, x, rig.after, {100, 90}).status == PatchStatus::bad_argument);
    CHECK(rig.tracker.track_between(rig.before, {100, 90}, rig.after, x).status == PatchStatus::bad_argument);
  }
  for (const Mat2& w :
       {Mat2{nan, 0, 0, 1}, Mat2{1, 0, 0, -1}, Mat2{0, 0, 0, 0}, Mat2{5, 0, 0, 1}, Mat2{1, inf, 0, 1}})
    CHECK(rig.tracker.track(0, rig.after, {100, 90}, w).status == PatchStatus::bad_argument);
  CHECK(rig.tracker.track(0, empty, {100, 90}).status == PatchStatus::bad_argument);
  CHECK(rig.tracker.track_between(empty, {100, 90}, rig.after, {100, 90}).status ==
        PatchStatus::bad_argument);
  CHECK(rig.tracker.track(1, rig.after, {100, 90}).status == PatchStatus::empty_slot);
  CHECK(rig.tracker.track(0, rig.after, {100, 90}).status == PatchStatus::ok);
  rig.tracker.release(0);
  CHECK(rig.tracker.track(0, rig.after, {100, 90}).status == PatchStatus::empty_slot);
  PatchTracker never_made;
  CHECK(never_made.track_between(rig.before, {100, 90}, rig.after, {100, 90}).status ==
        PatchStatus::bad_argument);
  CHECK(never_made.capture(0, rig.before, {100, 90}) == PatchStatus::bad_argument);
}

TEST_CASE("images hardly larger than the window are tracked or refused, never read outside") {
  const Texture texture(2);
  for (int side = 8; side < 40; side += 3) {
    CAPTURE(side);
    const Picture a = render(texture, {}, side, side + 2),
                  b = render(texture, shift(0.5, 0.4), side, side + 2);
    Rig rig({1, 15, 3, 8}, side, side + 2);
    rig.show(a, b);
    const float middle = static_cast<float>(side) / 2;
    const PatchStatus s = rig.tracker.capture(0, rig.before, {middle, middle});
    if (side < 15) CHECK(s == PatchStatus::outside_image);
    const PatchResult r = rig.tracker.track(0, rig.after, {middle, middle});
    if (r.status == PatchStatus::ok) CHECK(length(r.x - Vec2{middle + 0.5f, middle + 0.4f}) < 0.2f);
  }
}

TEST_CASE("limits out of range are refused, and every smaller arena fails cleanly") {
  AlignedBlock block(1 << 20);
  Arena arena(block.data(), block.size());
  PatchTracker t;
  for (const PatchLimits& l :
       {PatchLimits{-1, 11, 3, 4}, PatchLimits{4, 12, 3, 4}, PatchLimits{4, 5, 3, 4},
        PatchLimits{4, 23, 3, 4}, PatchLimits{4, 11, 0, 4}, PatchLimits{4, 11, 7, 4},
        PatchLimits{4, 11, 3, -1}, PatchLimits{4, 11, 3, 17}, PatchLimits{1 << 20, 11, 3, 4}})
    CHECK(t.create(arena, l) == Status::bad_argument);
  CHECK(arena.used_bytes() == 0);
  const PatchLimits limits{3, 9, 2, 1};
  const std::size_t bytes = measured_bytes<PatchTracker>(limits);
  for (std::size_t n = 0; n <= bytes; n += 16) {
    Arena small(block.data(), n);
    PatchTracker u;
    REQUIRE(u.create(small, limits) == (n < bytes ? Status::out_of_memory : Status::ok));
    REQUIRE(small.used_bytes() == (n < bytes ? 0 : bytes));
  }
}

TEST_CASE("a slot takes the stated bytes, and one of 500 bytes still finds its template") {
  for (const PatchLimits& l :
       {PatchLimits{64, 13, 3, 4}, PatchLimits{64, 11, 2, 1}, PatchLimits{64, 9, 2, 2}}) {
    PatchLimits none = l;
    none.slots = 0;
    const auto bytes = static_cast<int>(measured_bytes<PatchTracker>(l) - measured_bytes<PatchTracker>(none));
    CHECK(std::abs(bytes - 64 * patch_slot_bytes(l)) <= 64);  // alignment of the arrays
  }
  const PatchLimits small{200, 11, 2, 1};
  CHECK(patch_slot_bytes(small) <= 512);
  const Texture texture(11);
  const Picture a = render(texture, {}, kWidth, kHeight);
  for (const double degrees : {0.0, 8.0, 14.0}) {
    CAPTURE(degrees);
    const Motion m = similarity(degrees, 1.03, 1.3, -0.8);
    Rig rig(small);
    rig.show(a, render(texture, m, kWidth, kHeight));
    int slot = 0, found = 0;
    for (const Vec2 x : corners_of(a)) {
      REQUIRE(rig.tracker.capture(slot, rig.before, x) == PatchStatus::ok);
      const Vec2 truth = moved(m, a, x);
      const PatchResult r = rig.tracker.track(slot++, rig.after, truth + Vec2{0.7f, -0.5f}, warp_of(m));
      found += r.status == PatchStatus::ok && length(r.x - truth) < 0.1f;
    }
    CHECK(found > 0.97 * slot);
  }
}

TEST_CASE("a start of known deviation leads to the same position as one without") {
  const Texture texture(11);
  const Motion m = similarity(4, 1.02, 2.1, -1.6);
  const Picture a = render(texture, {}, kWidth, kHeight);
  Rig rig;
  rig.show(a, render(texture, m, kWidth, kHeight));
  texture::Random random(8);
  int slot = 0;
  for (const Vec2 x : corners_of(a)) {
    REQUIRE(rig.tracker.capture(slot, rig.before, x) == PatchStatus::ok);
    const Vec2 truth = moved(m, a, x);
    for (const float sd : {0.05f, 0.3f, 1.0f, 2.0f}) {
      CAPTURE(sd);
      PatchOptions known;
      known.start_sd_px = sd;
      const auto off = [&] { return sd * static_cast<float>(random.uniform(-2, 2)); };
      const float dx = off(), dy = off();
      const PatchResult r = rig.tracker.track(slot, rig.after, truth + Vec2{dx, dy}, warp_of(m), known);
      REQUIRE(r.status == PatchStatus::ok);
      CHECK(length(r.x - truth) < 0.06f);
      CHECK(r.iterations <= (sd < 0.1f ? 2 : 12));
    }
    ++slot;
  }
}

TEST_CASE("for random images, positions and options there is a status and no NaN") {
  texture::Random random(99);
  const auto pick = [&](int low, int high) { return static_cast<int>(random.uniform(low, high + 1)); };
  int found = 0;
  for (int round = 0; round < 300; ++round) {
    // One draw a statement: compilers evaluate arguments in different orders.
    const int width = pick(8, 60), height = pick(8, 60), kind = pick(0, 3);
    Picture a(width, height);
    for (int y = 0; y < a.height; ++y)
      for (int x = 0; x < a.width; ++x)
        a.at(x, y) =
            static_cast<std::uint8_t>(kind == 0   ? random.uniform(0, 256)
                                      : kind == 1 ? 255 * ((x / 3 + y / 3) % 2)
                                      : kind == 2 ? 2 * x + y
                                                  : 128 + 100 * std::sin(0.7 * x) * std::sin(0.9 * y));
    // Blocks of their own, just large enough, so that a sanitizer sees every byte read outside.
    const PyramidLimits size{a.width, a.height, pick(1, 4), round % 2 == 0};
    const PatchLimits limits{1, 7 + 2 * pick(0, 7), pick(1, 4), pick(0, 16)};
    AlignedBlock p(measured_bytes<Pyramid>(size)), t(measured_bytes<PatchTracker>(limits));
    Arena pyramid_arena(p.data(), p.size()), tracker_arena(t.data(), t.size());
    Pyramid pyramid;
    PatchTracker tracker;
    REQUIRE(pyramid.create(pyramid_arena, size) == Status::ok);
    REQUIRE(tracker.create(tracker_arena, limits) == Status::ok);
    REQUIRE(pyramid.build(a.frame()) == Status::ok);
    PatchOptions o;
    o.min_correlation = -2;
    o.normal_flow = pick(0, 1) == 0 ? &kNormalFlow : nullptr;
    o.start_sd_px = static_cast<float>(random.uniform(-0.5, 1.5));
    for (int k = 0; k < 20; ++k) {
      const auto place = [&] {
        return Vec2{static_cast<float>(random.uniform(-4, a.width + 4)),
                    static_cast<float>(random.uniform(-4, a.height + 4))};
      };
      const double degrees = random.uniform(-180, 180), scale = random.uniform(0.3, 3);
      const Mat2 warp = k % 2 == 0 ? Mat2{} : warp_of(similarity(degrees, scale));
      const Vec2 x = place(), first = place();
      (void)tracker.capture(0, pyramid, x, o);
      for (const PatchResult& r :
           {tracker.track(0, pyramid, first, warp, o), tracker.track(0, pyramid, x, warp, o),
            tracker.track_between(pyramid, x, pyramid, x, o)}) {
        REQUIRE(is_finite(r.x));
        REQUIRE((is_finite(r.information.xx) && is_finite(r.information.xy) && is_finite(r.information.yy)));
        REQUIRE((r.information.xx >= 0 && magnitude(r.correlation) < 1.001f && is_finite(r.gain) &&
                 is_finite(r.bias)));
        found += r.status == PatchStatus::ok;
      }
    }
  }
  CHECK(found > 500);  // about 800 of 18,000 searches end in a match, so that the whole search runs
}

TEST_CASE("every status has a text") {
  for (int s = 0; s <= 8; ++s) CHECK(std::strlen(text(static_cast<PatchStatus>(s))) > 4);
}

namespace {

/// The picture with light that gets brighter to the right and darker upwards around x, by `ramp` grey levels a px.
Picture lit_by_ramp(const Picture& p, Vec2 x, float ramp) {
  Picture lit = p;
  for (int j = 0; j < p.height; ++j)
    for (int i = 0; i < p.width; ++i) {
      const float right = clamp(static_cast<float>(i) - x.x, -15, 15),
                  down = clamp(static_cast<float>(j) - x.y, -15, 15);
      lit.at(i, j) = static_cast<std::uint8_t>(
          clamp(static_cast<float>(p.pixels[static_cast<std::size_t>(j * p.width + i)]) +
                    ramp * (right + 0.5f * down) + 0.5f,
                6, 249));
    }
  return lit;
}

/// Root mean square error of 30 corners, px, and the mean trace of their information.
struct RampResult {
  float error = 0, information = 0;
  int found = 0;
};

RampResult track_in_ramp(float ramp, float ramp_sd, bool keeps_templates) {
  const Texture texture(5);
  const Picture a = render(texture, {}, kWidth, kHeight), b = render(texture, shift(0.4, -0.3), kWidth, kHeight);
  PatchLimits limits{200, 11, 3, 5};
  limits.keeps_templates = keeps_templates;
  Rig rig(limits);
  RampResult r;
  PatchOptions options;
  options.start_sd_px = 0.5f;
  options.ramp_sd = ramp_sd;
  for (const Vec2 x : corners_of(a, 30)) {
    rig.show(a, lit_by_ramp(b, x, ramp));
    REQUIRE(rig.tracker.capture(0, rig.before, x) == PatchStatus::ok);
    const PatchResult found = rig.tracker.track(0, rig.after, x, {}, options);
    if (found.status != PatchStatus::ok) continue;
    const Vec2 off = found.x - x - Vec2{0.4f, -0.3f};
    r.error += dot(off, off);
    r.information += found.information.xx + found.information.yy;
    ++r.found;
  }
  REQUIRE(r.found > 0);
  r.error = std::sqrt(r.error / static_cast<float>(r.found));
  r.information /= static_cast<float>(r.found);
  return r;
}

}  // namespace

TEST_CASE("a ramp of light that is allowed for hardly moves the result, and costs information") {
  for (const bool keeps : {false, true})
    for (const float ramp : {1.0f, 2.0f}) {
      const RampResult without = track_in_ramp(ramp, 0, keeps), with = track_in_ramp(ramp, 1, keeps);
      MESSAGE("ramp " << ramp << " grey/px: " << without.error << " px, " << with.error << " if allowed for");
      CHECK(with.error < 0.5f * without.error);
      CHECK(with.error < 0.05f);
      CHECK(with.found >= without.found);
    }
  const RampResult even = track_in_ramp(0, 0, true), free = track_in_ramp(0, 1, true);
  CHECK(free.error < even.error + 0.02f);
  CHECK(free.information < even.information);
}

TEST_CASE("a kept template serves searches that allow for other ramps, and none") {
  const Texture texture(5);
  const Picture a = render(texture, {}, kWidth, kHeight), b = render(texture, shift(0.4, -0.3), kWidth, kHeight);
  const Vec2 x = corners_of(a).front();
  PatchLimits keeping{200, 11, 3, 5}, fresh = keeping;
  keeping.keeps_templates = true;
  Rig kept(keeping), anew(fresh);
  for (Rig* rig : {&kept, &anew}) {
    rig->show(a, lit_by_ramp(b, x, 1));
    REQUIRE(rig->tracker.capture(0, rig->before, x) == PatchStatus::ok);
  }
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const float sd : {0.0f, 1.0f, 0.2f, 0.0f, 2.0f, -1.0f, nan, 0.0f}) {
    PatchOptions options;
    options.ramp_sd = sd;
    const PatchResult k = kept.tracker.track(0, kept.after, x, {}, options),
                      f = anew.tracker.track(0, anew.after, x, {}, options);
    CHECK(k.status == f.status);
    CHECK(k.x.x == f.x.x);
    CHECK(k.x.y == f.x.y);
    CHECK(k.information.xx == f.information.xx);
  }
}

TEST_CASE("extreme options give a reason, or a finite result") {
  const Texture texture(2);
  Rig rig;
  rig.show(render(texture, {}, kWidth, kHeight), render(texture, shift(2, 1), kWidth, kHeight));
  REQUIRE(rig.tracker.capture(0, rig.before, {120, 90}) == PatchStatus::ok);
  const float infinite = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  for (const float x : {-infinite, -1.0f, 1e-45f, 1e-30f, 1e20f, infinite, nan})
    for (float PatchOptions::*member :
         {&PatchOptions::start_sd_px, &PatchOptions::max_move_px, &PatchOptions::min_correlation,
          &PatchOptions::ramp_sd, &PatchOptions::max_return_px}) {
      CAPTURE(x);
      PatchOptions options;
      options.*member = x;
      for (const PatchResult& r : {rig.tracker.track(0, rig.after, {120, 90}, {}, options),
                                   rig.tracker.track_between(rig.before, {120, 90}, rig.after, {120, 90}, options)}) {
        CHECK(is_finite(r.x));
        CHECK(is_finite(r.residual));
        CHECK(is_finite(r.information.xx));
        CHECK(is_finite(r.correlation));
        CHECK(is_finite(r.return_px));
      }
    }
}

}  // namespace patch_tracker_robustness_test
