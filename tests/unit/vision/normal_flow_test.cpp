// Optical flow at points: rank two at a corner, one along the gradient at an edge, none without texture.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "patch_rig.hpp"

namespace normal_flow_test {

using namespace patch_rig;

namespace {

constexpr double kPi = 3.14159265358979;

// A straight edge through the middle of the image, moved by t along its normal and by any amount along itself.
struct Edge {
  double degrees = 0, height = 60, blur = 1.2;

  Vec2 normal() const {
    return {static_cast<float>(std::cos(degrees * kPi / 180)),
            static_cast<float>(std::sin(degrees * kPi / 180))};
  }
  Picture render(double t, double noise = 0, double gain = 1, double bias = 0, std::uint64_t seed = 1) const {
    Picture p(kWidth, kHeight);
    texture::Random random(seed);
    const Vec2 n = normal();
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const double d = double(n.x) * (x - 119.5) + double(n.y) * (y - 89.5) - t;
        double g = gain * (110 + 0.5 * height * std::erf(d / (std::sqrt(2.0) * blur))) + bias;
        if (noise > 0) g += noise * random.normal();
        p.at(x, y) = static_cast<std::uint8_t>(g < 0 ? 0 : g > 255 ? 255 : g + 0.5);
      }
    return p;
  }
};

const Vec2 kMiddle{119.5f, 89.5f};

PatchOptions flow() {
  PatchOptions o;
  o.normal_flow = &kNormalFlow;
  return o;
}

struct Errors {
  int tried = 0, found = 0, of_rank_one = 0;
  double square = 0, normalised = 0;

  double rms() const { return std::sqrt(square / found); }
  double normalised_rms() const { return std::sqrt(normalised / found); }
};

// Points along edges at all angles that move by t along their normals.
Errors track_edges(double t, double noise, double height, double gain = 1, double bias = 0) {
  Errors e;
  Rig rig({0, 13, 3, 0});
  for (int k = 0; k < 40; ++k) {
    const Edge edge{9.0 * k + 2, height, 1.2};
    const auto seed = static_cast<std::uint64_t>(2 * k + 1);
    rig.show(edge.render(0, noise, 1, 0, seed), edge.render(t, noise, gain, bias, seed + 1));
    const Vec2 n = edge.normal(), tangent{-n.y, n.x};
    for (float along = -45; along <= 45; along += 15) {
      const Vec2 x = kMiddle + along * tangent + 0.6f * n;
      const PatchResult r = rig.tracker.track_between(rig.before, x, rig.after, x, flow());
      ++e.tried;
      if (r.status != PatchStatus::ok) continue;
      ++e.found;
      e.of_rank_one += r.rank == 1;
      const Vec2 error = r.x - x - static_cast<float>(t) * n;
      const double d = double(dot(error, n));
      e.square += d * d;
      const Sym2& s = r.information;
      e.normalised +=
          double(s.xx * error.x * error.x + 2 * s.xy * error.x * error.y + s.yy * error.y * error.y);
    }
  }
  return e;
}

}  // namespace

TEST_CASE("on a straight edge the flow is normal, of rank one, and its deviation is the claimed one") {
  for (const double t : {-2.4, 0.3, 1.7})
    for (const double noise : {0.0, 1.0, 3.0, 6.0})
      for (const double height : {60.0, 120.0}) {
        CAPTURE(t);
        CAPTURE(noise);
        CAPTURE(height);
        const Errors e = track_edges(t, noise, height);
        CHECK(e.found > 0.95 * e.tried);
        CHECK(e.of_rank_one == e.found);
        CHECK(e.rms() < 0.015 + 1.2 * noise / height);
        CHECK(e.normalised_rms() < 1.1);
        if (noise >= 3) CHECK(e.normalised_rms() > 0.65);
      }
}

TEST_CASE("gain and bias of the light do not matter on an edge") {
  const Errors e = track_edges(1.3, 1, 60, 1.15, -20);
  CHECK(e.found == e.tried);
  CHECK(e.rms() < 0.03);
  CHECK(e.normalised_rms() < 1.1);
}

TEST_CASE("information is along the gradient, and the result does not move along the edge") {
  const Edge edge{27, 90, 1.2};
  Rig rig({0, 13, 1, 0});
  rig.show(edge.render(0), edge.render(1.4));
  const Vec2 n = edge.normal(), tangent{-n.y, n.x}, x = kMiddle + 8.0f * tangent;
  for (const float beside : {0.0f, 2.5f}) {
    const Vec2 start = x + beside * tangent;
    const PatchResult r = rig.tracker.track_between(rig.before, x, rig.after, start, flow());
    REQUIRE(r.status == PatchStatus::ok);
    CHECK(r.rank == 1);
    CHECK(magnitude(dot(r.x - start, tangent)) < 0.02f);
    CHECK(magnitude(dot(r.x - start, n) - 1.4f) < 0.02f);
    const Sym2& s = r.information;
    CHECK(magnitude(s.xx * s.yy - s.xy * s.xy) < 1e-5f * s.xx * s.yy);
    CHECK(magnitude(s.xx * n.y - s.xy * n.x) < 0.02f * s.xx);
  }
  // A patch that must be a corner is refused there.
  CHECK(rig.tracker.track_between(rig.before, x, rig.after, x).status == PatchStatus::flat);
  // There and back: what counts is the distance across the edge.
  PatchOptions both = flow();
  both.max_return_px = 0.1f;
  const PatchResult r = rig.tracker.track_between(rig.before, x, rig.after, x + 3.0f * tangent, both);
  CHECK(r.status == PatchStatus::ok);
  CHECK(r.return_px < 0.05f);
}

TEST_CASE(
    "in texture the flow is of rank two, and its deviation is the claimed one where noise hides a "
    "direction") {
  for (const double noise : {1.0, 3.0, 6.0}) {
    CAPTURE(noise);
    Motion m = shift(1.3, -0.8), still;
    still.noise = m.noise = noise;
    const Texture texture(11);
    const Picture a = render(texture, still, kWidth, kHeight, 5), b = render(texture, m, kWidth, kHeight, 6);
    Rig rig({0, 13, 3, 0});
    rig.show(a, b);
    int of_rank[3] = {};
    double square[3] = {};
    for (float y = 40; y < 140; y += 5)
      for (float x = 40; x < 200; x += 5) {
        const PatchResult r = rig.tracker.track_between(rig.before, {x, y}, rig.after, {x, y}, flow());
        ++of_rank[r.rank];
        if (r.status != PatchStatus::ok) continue;
        const Vec2 e = r.x - moved(m, a, {x, y});
        const Sym2& s = r.information;
        square[r.rank] += double(s.xx * e.x * e.x + 2 * s.xy * e.x * e.y + s.yy * e.y * e.y) / r.rank;
      }
    CHECK(of_rank[2] > (noise < 4 ? 600 : 300));
    CHECK(std::sqrt(square[2] / of_rank[2]) < 1.1);
    CHECK(std::sqrt(square[2] / of_rank[2]) > 0.6);
    if (of_rank[1] > 50) CHECK(std::sqrt(square[1] / of_rank[1]) < 1.2);
    if (noise > 4) CHECK(of_rank[1] > 50);
  }
}

TEST_CASE("on even grey, on noise and on one pixel no flow is found") {
  Rig rig({0, 13, 3, 0});
  Picture dot(kWidth, kHeight, 128), noise[2] = {Picture(kWidth, kHeight), Picture(kWidth, kHeight)};
  dot.at(120, 90) = 129;
  texture::Random random(4);
  for (Picture& p : noise)
    for (std::uint8_t& v : p.pixels) v = static_cast<std::uint8_t>(128 + 4 * random.normal());
  for (const Picture& p :
       {Picture(kWidth, kHeight, 0), Picture(kWidth, kHeight, 255), Picture(kWidth, kHeight, 90), dot}) {
    rig.show(p, p);
    CHECK(rig.tracker.track_between(rig.before, {120, 90}, rig.after, {120, 90}, flow()).status ==
          PatchStatus::flat);
  }
  rig.show(noise[0], noise[1]);
  int found = 0;
  for (float y = 20; y < 160; y += 10)
    for (float x = 20; x < 220; x += 10)
      found +=
          rig.tracker.track_between(rig.before, {x, y}, rig.after, {x, y}, flow()).status == PatchStatus::ok;
  CHECK(found == 0);
}

TEST_CASE("slots accept edges too, with the predicted warp") {
  const Edge before{30, 80, 1.2}, after{42, 80, 1.2};
  Rig rig({2, 13, 3, 5});
  rig.show(before.render(0), after.render(0.7));
  const PatchOptions o = flow();
  CHECK(rig.tracker.capture(0, rig.before, kMiddle) == PatchStatus::flat);
  REQUIRE(rig.tracker.capture(0, rig.before, kMiddle, o) == PatchStatus::ok);
  const PatchResult r = rig.tracker.track(0, rig.after, kMiddle, warp_of(similarity(12, 1)), o);
  REQUIRE(r.status == PatchStatus::ok);
  CHECK(r.rank == 1);
  CHECK(magnitude(dot(r.x - kMiddle, after.normal()) - 0.7f) < 0.05f);
  const Sym2& s = r.information;
  CHECK(magnitude(s.xx * after.normal().y - s.xy * after.normal().x) < 0.05f * s.xx);
}

}  // namespace normal_flow_test
