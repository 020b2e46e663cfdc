// The error of the patch tracker, and whether its claimed deviation is the real one.
#include "pliant/patch_tracker.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "patch_rig.hpp"

namespace patch_tracker_test {

using namespace patch_rig;

namespace {

struct Errors {
  std::vector<double> all;
  int lost = 0, wrong = 0;  // wrong: found, but more than half a pixel off
  double chi2 = 0;          // mean of e' information e

  void add(const PatchResult& r, Vec2 truth) {
    if (r.status != PatchStatus::ok) {
      ++lost;
      return;
    }
    const Vec2 e = r.x - truth;
    all.push_back(double(length(e)));
    wrong += length(e) > 0.5f;
    chi2 += double(r.information.xx * e.x * e.x + 2 * r.information.xy * e.x * e.y +
                   r.information.yy * e.y * e.y);
  }
  double rms() const {
    double s = 0;
    for (const double e : all) s += e * e;
    return std::sqrt(s / static_cast<double>(all.size()));
  }
  double max() const { return *std::max_element(all.begin(), all.end()); }
  double mean_chi2() const { return chi2 / static_cast<double>(all.size()); }
};

// Templates of the unmoved image, tracked into the moved one from their old positions.
Errors track_anchors(const Motion& m, const Mat2& warp = {}, const PatchOptions& options = {},
                     double contrast = 22, PatchLimits limits = {200, 11, 3, 5}) {
  const Texture texture(11, contrast);
  Motion still;
  still.noise = m.noise;
  const Picture a = render(texture, still, kWidth, kHeight, 5), b = render(texture, m, kWidth, kHeight, 6);
  Rig rig(limits);
  rig.show(a, b);
  Errors errors;
  int slot = 0;
  for (const Vec2 x : corners_of(a)) {
    REQUIRE(rig.tracker.capture(slot, rig.before, x) == PatchStatus::ok);
    errors.add(rig.tracker.track(slot++, rig.after, x, warp, options), moved(m, a, x));
  }
  return errors;
}

}  // namespace

TEST_CASE("shifts of 0.1 to 9 pixels are found to a fiftieth of a pixel") {
  for (const double s : {0.1, 0.3, 0.5, 0.77, 1.4, 2.25, 4.6, 6.3, 9.0}) {
    CAPTURE(s);
    const Errors e = track_anchors(shift(s, -0.6 * s));
    CHECK(e.lost == 0);
    CHECK(e.rms() < 0.02);
    CHECK(e.max() < 0.06);
  }
}

TEST_CASE("every window size tracks") {
  for (int window = 7; window <= 21; window += 2) {
    CAPTURE(window);
    const Errors e = track_anchors(shift(1.3, 2.1), {}, {}, 22, {200, window, 3, 2});
    CHECK(e.lost <= 1);
    CHECK(e.rms() < 0.03);
    CHECK(e.wrong == 0);
  }
}

TEST_CASE("a change of light is measured and does not change the position") {
  Motion darker = shift(2.3, 1.7), brighter = darker;
  darker.gain = 0.7;
  darker.bias = 30;
  brighter.gain = 1.2;
  brighter.bias = -20;
  for (const Motion& m : {darker, brighter}) {
    CAPTURE(m.gain);
    const Errors e = track_anchors(m);
    CHECK(e.lost == 0);
    CHECK(e.rms() < 0.025);
  }
  const Texture texture(3);
  const Picture a = render(texture, {}, kWidth, kHeight), b = render(texture, darker, kWidth, kHeight);
  Rig rig;
  rig.show(a, b);
  for (const Vec2 x : corners_of(a, 30)) {
    const PatchResult r = rig.tracker.track_between(rig.before, x, rig.after, x);
    CHECK(r.gain == doctest::Approx(0.7).epsilon(0.02));
    CHECK(double(r.bias) == doctest::Approx(30).epsilon(0.08));
    CHECK(r.correlation > 0.99f);
    CHECK(r.residual < 1.5f);
  }
}

TEST_CASE("with noise of three grey levels the error is below 0.15 px, and the covariance is right") {
  Motion m = shift(2.3, -1.1);
  m.noise = 3;
  const Errors e = track_anchors(m);
  CHECK(e.lost == 0);
  CHECK(e.rms() < 0.15);
  // e' information e has the mean 2 if the covariance is right. A smaller mean is a cautious claim.
  CHECK(e.mean_chi2() < 3.0);
  CHECK(e.mean_chi2() > 0.7);
}

TEST_CASE("clipped highlights and shadows cost little") {
  Motion m = shift(3.2, 1.4);
  m.gain = 1.3;
  m.bias = -40;
  const Errors masked = track_anchors(m, {}, {}, 45);
  CHECK(masked.rms() < 0.04);
  CHECK(masked.wrong == 0);
  // So far away that the coarser levels must find it.
  m.tx = 9;
  m.ty = -6;
  const Errors far = track_anchors(m, {}, {}, 45);
  CHECK(far.lost <= 2);
  CHECK(far.rms() < 0.05);
  CHECK(far.wrong == 0);
}

TEST_CASE("with the right warp, rotation and scale cost little") {
  for (const Motion& m :
       {similarity(20, 1.08, 2, -3), similarity(-18, 0.85, 1, 1), similarity(25, 1.2, 0, 0)}) {
    CAPTURE(m.c);
    const Texture texture(11);
    const Picture a = render(texture, {}, kWidth, kHeight), b = render(texture, m, kWidth, kHeight);
    Rig rig({200, 13, 3, 6});
    rig.show(a, b);
    Errors warped, plain;
    for (const Vec2 x : corners_of(a, 150, 50)) {
      REQUIRE(rig.tracker.capture(0, rig.before, x) == PatchStatus::ok);
      const Vec2 truth = moved(m, a, x), start{truth.x + 1.2f, truth.y - 0.9f};
      warped.add(rig.tracker.track(0, rig.after, start, warp_of(m)), truth);
      plain.add(rig.tracker.track(0, rig.after, start), truth);
    }
    CHECK(warped.lost == 0);
    CHECK(warped.rms() < 0.03);
    CHECK(plain.lost + plain.wrong > 0);
  }
}

TEST_CASE("a template made for another warp serves while the rest of the warp is known and small") {
  // One slot, the warp growing from call to call: only now and then is the template made anew.
  const Texture texture(11);
  const Picture a = render(texture, {}, kWidth, kHeight);
  Rig rig;
  for (double degrees = 0; degrees <= 8; degrees += 0.5) {
    CAPTURE(degrees);
    const Motion m = similarity(degrees, 1 + 0.01 * degrees, 0.3, -0.4);
    rig.show(a, render(texture, m, kWidth, kHeight));
    Errors known, unknown;
    int slot = 0;
    for (const Vec2 x : corners_of(a, 150, 50)) {
      if (degrees == 0) REQUIRE(rig.tracker.capture(slot, rig.before, x) == PatchStatus::ok);
      const Vec2 truth = moved(m, a, x), start{truth.x + 0.2f, truth.y - 0.25f};
      PatchOptions options;
      options.start_sd_px = 0.3f;
      known.add(rig.tracker.track(slot, rig.after, start, warp_of(m), options), truth);
      unknown.add(rig.tracker.track(slot, rig.after, start, {}, options), truth);
      ++slot;
    }
    CHECK(known.lost == 0);
    CHECK(known.rms() < 0.03);
    if (degrees >= 4) CHECK(known.rms() < 0.8 * unknown.rms());
  }
}

TEST_CASE("an anchor at a position between pixels is found there") {
  const Texture texture(21);
  const Motion m = similarity(6, 1.05, 1.3, 0.4);
  const Picture a = render(texture, {}, kWidth, kHeight), b = render(texture, m, kWidth, kHeight);
  Rig rig({10, 13, 3, 6});
  rig.show(a, b);
  Errors errors;
  texture::Random random(4);
  for (const Vec2 c : corners_of(a)) {
    const Vec2 x{c.x + static_cast<float>(random.uniform(-1.5, 1.5)),
                 c.y + static_cast<float>(random.uniform(-1.5, 1.5))};
    REQUIRE(rig.tracker.capture(3, rig.before, x) == PatchStatus::ok);
    errors.add(rig.tracker.track(3, rig.after, moved(m, a, x), warp_of(m)), moved(m, a, x));
  }
  CHECK(errors.lost == 0);
  CHECK(errors.rms() < 0.025);
}

TEST_CASE("templates near the border use the part of the margin inside the image") {
  const Texture texture(8);
  const Motion m = similarity(5, 1.1, 0, 0);
  const Picture a = render(texture, {}, kWidth, kHeight), b = render(texture, m, kWidth, kHeight);
  Rig rig({1, 11, 3, 8});
  rig.show(a, b);
  int tried = 0;
  for (float x = 5; x <= 12; x += 0.7f)
    for (float y = 6; y < 170; y += 5) {
      if (rig.tracker.capture(0, rig.before, {x, y}) != PatchStatus::ok) continue;
      const Vec2 truth = moved(m, a, {x, y});
      const PatchResult r = rig.tracker.track(0, rig.after, truth, warp_of(m));
      if (r.status != PatchStatus::ok) continue;
      ++tried;
      CHECK(length(r.x - truth) < 0.25f);
    }
  CHECK(tried >= 8);
}

TEST_CASE("frame-to-frame tracking forward and back returns to the start") {
  const Texture texture(2);
  const Motion m = shift(4.4, -2.2);
  const Picture a = render(texture, {}, kWidth, kHeight), b = render(texture, m, kWidth, kHeight);
  Rig rig;
  rig.show(a, b);
  PatchOptions o;
  o.max_return_px = 0.5f;
  Errors errors;
  for (const Vec2 x : corners_of(a)) {
    const PatchResult r = rig.tracker.track_between(rig.before, x, rig.after, x, o);
    errors.add(r, moved(m, a, x));
    CHECK(r.return_px < 0.05f);
  }
  CHECK(errors.lost == 0);
  CHECK(errors.rms() < 0.02);
}

TEST_CASE("a patch that is no longer in the image is not found") {
  const Picture a = render(Texture(2), {}, kWidth, kHeight), other = render(Texture(77), {}, kWidth, kHeight);
  Rig rig({1, 15, 3, 4});
  rig.show(a, other);
  PatchOptions o;
  o.min_correlation = 0.9f;
  int kept = 0, kept_back = 0, points = 0;
  for (const Vec2 x : corners_of(a)) {
    ++points;
    kept += rig.tracker.track_between(rig.before, x, rig.after, x, o).status == PatchStatus::ok;
    o.max_return_px = 0.5f;
    kept_back += rig.tracker.track_between(rig.before, x, rig.after, x, o).status == PatchStatus::ok;
    o.max_return_px = 0;
  }
  CHECK(kept * 33 <= points);
  CHECK(kept_back <= kept);
}

TEST_CASE("a template is found for two hundred frames without drift") {
  const Texture texture(6);
  Rig rig({200, 11, 3, 5});
  Picture first = render(texture, {}, kWidth, kHeight);
  rig.show(first, first);
  const std::vector<Vec2> points = corners_of(first, 25);
  std::vector<Vec2> now = points;
  for (std::size_t i = 0; i < points.size(); ++i)
    REQUIRE(rig.tracker.capture(static_cast<int>(i), rig.before, points[i]) == PatchStatus::ok);
  Motion m;
  for (int k = 1; k <= 200; ++k) {
    m = similarity(8 * std::sin(0.07 * k), 1 + 0.08 * std::sin(0.09 * k), 15 * std::sin(0.1 * k),
                   10 * std::sin(0.08 * k));
    m.noise = 2;
    if (k % 10 != 0) continue;  // motion between two searches is then up to 20 px
    const Picture p = render(texture, m, kWidth, kHeight, static_cast<std::uint64_t>(k));
    REQUIRE(rig.after.build(p.frame()) == Status::ok);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec2 guess = moved(m, first, points[i]) + Vec2{1.5f, -1};
      const PatchResult r = rig.tracker.track(static_cast<int>(i), rig.after, guess, warp_of(m));
      if (r.status == PatchStatus::ok) now[i] = r.x;
    }
  }
  Errors errors;
  for (std::size_t i = 0; i < points.size(); ++i) {
    PatchResult r;
    r.status = PatchStatus::ok;
    r.x = now[i];
    errors.add(r, moved(m, first, points[i]));
  }
  CHECK(errors.rms() < 0.1);
  CHECK(errors.wrong == 0);
}

TEST_CASE("a search may start at any level, and needs the coarse ones for large motions") {
  PatchOptions fine;
  fine.first_level = 0;
  CHECK(track_anchors(shift(0.8, 0.5), {}, fine).rms() < 0.02);
  const Errors e = track_anchors(shift(9, 7), {}, fine);
  CHECK(e.lost + e.wrong > 10);
  fine.first_level = 99;
  CHECK(track_anchors(shift(9, 7), {}, fine).lost == 0);
}

TEST_CASE("kept templates give the same positions to less than their deviation, and take the stated room") {
  const Texture texture(11);
  const Picture a = render(texture, {}, kWidth, kHeight);
  PatchLimits limits{200, 11, 3, 5};
  Rig plain(limits);
  limits.keeps_templates = true;
  Rig keeping(limits);
  for (double degrees = 0; degrees <= 4; degrees += 0.5) {
    CAPTURE(degrees);
    Motion m = similarity(degrees, 1, 0.3, -0.4);
    m.noise = 2;
    const Picture b = render(texture, m, kWidth, kHeight, 7);
    int slot = 0;
    for (Rig* rig : {&plain, &keeping}) rig->show(a, b);
    for (const Vec2 x : corners_of(a, 60, 50)) {
      const Vec2 truth = moved(m, a, x);
      PatchResult r[2];
      for (int k = 0; k < 2; ++k) {
        Rig& rig = k == 0 ? plain : keeping;
        if (degrees == 0) REQUIRE(rig.tracker.capture(slot, rig.before, x) == PatchStatus::ok);
        r[k] = rig.tracker.track(slot, rig.after, truth + Vec2{0.2f, -0.1f}, warp_of(m));
        REQUIRE(r[k].status == PatchStatus::ok);
      }
      const Vec2 e = r[1].x - r[0].x;
      const Sym2& s = r[0].information;
      CHECK(s.xx * e.x * e.x + 2 * s.xy * e.x * e.y + s.yy * e.y * e.y < 1);
      ++slot;
    }
  }
  PatchLimits one{1, 11, 2, 1}, two{2, 11, 2, 1};
  one.keeps_templates = two.keeps_templates = true;
  const auto bytes = measured_bytes<PatchTracker>(two) - measured_bytes<PatchTracker>(one);
  CHECK(bytes - static_cast<std::size_t>(patch_slot_bytes(one)) < 2000);
}

TEST_CASE("a result farther from the start than allowed is refused, and the start is given back") {
  const Texture texture(11);
  const Motion m = shift(3, 4);
  const Picture a = render(texture, {}, kWidth, kHeight);
  Rig rig;
  rig.show(a, render(texture, m, kWidth, kHeight));
  PatchOptions o;
  for (const Vec2 x : corners_of(a, 20)) {
    REQUIRE(rig.tracker.capture(0, rig.before, x) == PatchStatus::ok);
    o.max_move_px = 5.2f;
    CHECK(rig.tracker.track(0, rig.after, x, {}, o).status == PatchStatus::ok);
    o.max_move_px = 4.8f;
    const PatchResult r = rig.tracker.track(0, rig.after, x, {}, o);
    CHECK(r.status == PatchStatus::diverged);
    CHECK(length(r.x - x) == 0);
  }
}

TEST_CASE("the same call gives the same bits, whatever was tracked before") {
  const Texture texture(2);
  const Picture a = render(texture, {}, kWidth, kHeight),
                b = render(texture, similarity(3, 1.02, 2, 1), kWidth, kHeight);
  Rig one, two;
  one.show(a, b);
  two.show(a, b);
  const std::vector<Vec2> points = corners_of(a);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const PatchResult r = one.tracker.track_between(one.before, points[i], one.after, points[i]);
    const Vec2 elsewhere = points[points.size() - 1 - i];
    (void)two.tracker.track_between(two.after, elsewhere, two.before, elsewhere);
    const PatchResult s = two.tracker.track_between(two.before, points[i], two.after, points[i]);
    CHECK(r.status == s.status);
    CHECK(std::memcmp(&r.x, &s.x, sizeof r.x) == 0);
    CHECK(std::memcmp(&r.information, &s.information, sizeof r.information) == 0);
    CHECK(r.correlation == s.correlation);
    CHECK(r.iterations == s.iterations);
  }
}

}  // namespace patch_tracker_test
