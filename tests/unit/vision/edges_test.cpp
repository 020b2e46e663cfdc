// The edge finder on edges of known position: its error, its claimed deviation, and what it refuses.
#include "pliant/edges.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "aligned_block.hpp"
#include "texture.hpp"

namespace edges_test {

using namespace pliant;
using texture::Picture;

namespace {

constexpr int kSide = 96;
constexpr double kPi = 3.14159265358979;

// Straight edges across the image, all with one normal: steps of a height in greys at a distance in px from the
// middle, blurred by a Gaussian.
struct Scene {
  double degrees = 0, blur = 1, noise = 0, dark = 70;
  struct Step {
    double at, height;
  };
  std::vector<Step> steps;

  void step(double at, double height) { steps.push_back({at, height}); }
  Vec2 normal() const {
    return {static_cast<float>(std::cos(degrees * kPi / 180)),
            static_cast<float>(std::sin(degrees * kPi / 180))};
  }
  Picture render(std::uint64_t seed = 1) const {
    Picture p(kSide, kSide);
    texture::Random random(seed);
    const Vec2 n = normal();
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        const double t = double(n.x) * (x - 47.5) + double(n.y) * (y - 47.5);
        double g = dark;
        for (const Step& s : steps)
          g += 0.5 * s.height * (1 + std::erf((t - s.at) / (std::sqrt(2.0) * blur)));
        if (noise > 0) g += noise * random.normal();
        p.at(x, y) = static_cast<std::uint8_t>(g < 0 ? 0 : g > 255 ? 255 : g + 0.5);
      }
    return p;
  }
};

struct Shown {
  AlignedBlock block;
  Pyramid pyramid;

  explicit Shown(const Picture& p, int levels = 3) : block(std::size_t{1} << 15) {
    const PyramidLimits limits{p.width, p.height, levels, true};
    Arena arena(block.data(), block.size());
    REQUIRE(pyramid.create(arena, limits) == Status::ok);
    REQUIRE(pyramid.build(p.frame()) == Status::ok);
  }
};

EdgePoint point_at(Vec2 x, Vec2 normal, float sd = 2, float contrast = 0) {
  EdgePoint p;
  p.id = 7;
  p.x = x;
  p.normal = normal;
  p.covariance = {sd * sd, 0, sd * sd};
  p.contrast = contrast;
  return p;
}

const Vec2 kMiddle{47.5f, 47.5f};

std::vector<Observation> find_at(const Pyramid& pyramid, const EdgePoint& p, const EdgeOptions& o = {}) {
  Observation out[kMaxEdgeHypotheses];
  const int n = find_edge(pyramid, p, o, {out, kMaxEdgeHypotheses});
  return std::vector<Observation>(out, out + n);
}

// Signed distance along the normal from the middle, and its claimed variance.
double distance(const Observation& o, Vec2 normal) {
  return double(dot(o.x - kMiddle, normal));
}
double variance(const Observation& o) {
  return 1 / double(o.information.xx + o.information.yy);
}

struct Errors {
  int tried = 0, found = 0;
  double sum = 0, square = 0, normalised = 0, claimed = 0;

  double bias() const { return sum / found; }
  double rms() const { return std::sqrt(square / found); }
  double normalised_rms() const { return std::sqrt(normalised / found); }
};

// Edges at many places and angles, expected up to 3 px beside where they are.
Errors measure(double blur, double noise, double height, const EdgeOptions& options = {}) {
  Errors e;
  texture::Random random(17);
  for (int k = 0; k < 240; ++k) {
    Scene s;
    s.degrees = 1.5 * k;
    s.blur = blur;
    s.noise = noise;
    const double at = random.uniform(-1.5, 1.5);
    if (height < 0) s.dark = 170;
    s.step(at, height);
    const Shown shown(s.render(static_cast<std::uint64_t>(k) + 1));
    const Vec2 n = s.normal(), across{-n.y, n.x};
    for (const float along : {-14.3f, 0.0f, 9.6f}) {
      ++e.tried;
      const Vec2 x = kMiddle + static_cast<float>(random.uniform(-1.5, 1.5)) * n + along * across;
      const std::vector<Observation> found = find_at(shown.pyramid, point_at(x, n), options);
      if (found[0].reason != Reason::found) continue;
      ++e.found;
      const double error = distance(found[0], n) - at;
      e.sum += error;
      e.square += error * error;
      e.normalised += error * error / variance(found[0]);
      e.claimed += std::sqrt(variance(found[0]));
    }
  }
  return e;
}

}  // namespace

TEST_CASE("a clean edge is found to a few hundredths of a pixel, sharp or blurred, at any angle") {
  for (const double blur : {0.5, 1.0, 2.0, 3.0})
    for (const double height : {-100.0, 40.0, 100.0}) {
      CAPTURE(blur);
      CAPTURE(height);
      const Errors e = measure(blur, 0, height);
      CHECK(e.found == e.tried);
      CHECK(std::abs(e.bias()) < 0.004);
      CHECK(e.rms() < (blur < 2 ? 0.012 : 0.05));
    }
}

TEST_CASE("with noise the claimed deviation is the real one") {
  for (const double blur : {0.5, 1.0, 2.0, 3.0})
    for (const double noise : {1.0, 3.0, 6.0, 10.0}) {
      CAPTURE(blur);
      CAPTURE(noise);
      const Errors e = measure(blur, noise, 80);
      CHECK(e.found == e.tried);
      CHECK(std::abs(e.bias()) < 0.02);
      CHECK(e.rms() < 0.05 + 0.01 * noise + 0.003 * noise * blur);
      // The floor, 0.05 px, is most of what is claimed where there is next to no noise.
      CHECK(e.normalised_rms() < 1.35);
      if (noise >= 6) CHECK(e.normalised_rms() > 0.65);
    }
}

TEST_CASE("information is of rank one, along the normal, and x lies on the normal through the prediction") {
  Scene s;
  s.degrees = 33;
  s.step(0.4, 90);
  const Shown shown(s.render());
  const Vec2 n = s.normal(), x = kMiddle + 3.0f * Vec2{-n.y, n.x} + 1.5f * n;
  const std::vector<Observation> found = find_at(shown.pyramid, point_at(x, 2.5f * n));
  REQUIRE(found.size() == 1);
  const Observation& o = found[0];
  CHECK(o.reason == Reason::found);
  CHECK(o.cue == Cue::edge);
  CHECK(o.id == 7);
  CHECK(magnitude(dot(o.x - x, {-n.y, n.x})) < 1e-4f);
  CHECK(magnitude(o.information.xx * o.information.yy - o.information.xy * o.information.xy) <
        1e-5f * o.information.xx * o.information.yy);
  CHECK(magnitude(o.information.xx * n.y - o.information.xy * n.x) < 1e-3f * o.information.xx);
  CHECK(magnitude(o.score - 90.0f / 255) < 0.1f);
}

TEST_CASE("a thin line has two edges of opposite polarity, and the remembered contrast tells them apart") {
  for (const double width : {3.0, 4.0, 6.0}) {
    CAPTURE(width);
    Scene s;
    s.degrees = 20;
    s.step(-width / 2, 100);
    s.step(width / 2, -100);
    const Shown shown(s.render());
    const Vec2 n = s.normal();
    const std::vector<Observation> both = find_at(shown.pyramid, point_at(kMiddle + 0.3f * n, n));
    REQUIRE(both.size() == 2);
    CHECK(both[0].id == both[1].id);
    for (const Observation& o : both) {
      CHECK(o.reason == Reason::found);
      CHECK(std::abs(distance(o, n) - (o.score > 0 ? -width / 2 : width / 2)) < 0.4);
    }
    CHECK(both[0].score * both[1].score < 0);
    for (const float contrast : {0.3f, -0.3f}) {
      const std::vector<Observation> one = find_at(shown.pyramid, point_at(kMiddle, n, 2, contrast));
      REQUIRE(one.size() == 1);
      CHECK(one[0].score * contrast > 0);
    }
    // With the opposite normal all signs are opposite.
    const std::vector<Observation> turned = find_at(shown.pyramid, point_at(kMiddle, -1.0f * n, 2, 0.3f));
    REQUIRE(turned.size() == 1);
    CHECK(std::abs(distance(turned[0], n) - width / 2) < 0.4);
  }
}

TEST_CASE("an edge of another contrast than the one remembered is refused") {
  Scene s;
  s.step(0, 60);
  const Shown shown(s.render());
  const float seen = find_at(shown.pyramid, point_at(kMiddle, {1, 0}))[0].score;
  const auto reason = [&](float contrast) {
    return find_at(shown.pyramid, point_at(kMiddle, {1, 0}, 2, contrast))[0].reason;
  };
  for (const float ratio : {0.55f, 1.0f, 1.9f}) CHECK(reason(ratio * seen) == Reason::found);
  for (const float ratio : {0.4f, 2.2f, -1.0f}) CHECK(reason(ratio * seen) == Reason::low_correlation);
  EdgeOptions sign_only;
  sign_only.min_ratio = 0;
  sign_only.max_ratio = 1e6f;
  for (const float ratio : {0.1f, 5.0f})
    CHECK(find_at(shown.pyramid, point_at(kMiddle, {1, 0}, 2, ratio * seen), sign_only)[0].reason ==
          Reason::found);
  CHECK(find_at(shown.pyramid, point_at(kMiddle, {1, 0}, 2, -seen), sign_only)[0].reason ==
        Reason::low_correlation);
}

TEST_CASE("a finest level leaves out what only the finer ones show") {
  Scene s;
  s.step(-1, 120);
  s.step(1, -120);
  const Shown line(s.render());
  EdgeOptions coarse;
  coarse.finest_level = 2;
  CHECK(find_at(line.pyramid, point_at(kMiddle, {1, 0}))[0].reason == Reason::found);
  const Observation seen = find_at(line.pyramid, point_at(kMiddle, {1, 0}), coarse)[0];
  CHECK((seen.reason != Reason::found || magnitude(seen.score) < 0.2f));
  coarse.finest_level = 99;  // as if it were the coarsest there is
  s.steps.clear();
  s.step(0.3, 90);
  const Shown edge(s.render());
  const std::vector<Observation> found = find_at(edge.pyramid, point_at(kMiddle, {1, 0}), coarse);
  REQUIRE(found[0].reason == Reason::found);
  CHECK(std::abs(distance(found[0], {1, 0}) - 0.3) < 0.3);
}

TEST_CASE("the nearer of two equal edges is preferred, and many similar ones are ambiguous") {
  Scene s;
  s.step(-6, 60);
  s.step(5, 60);
  const Shown two(s.render());
  EdgeOptions one;
  one.hypotheses = 1;
  const std::vector<Observation> near = find_at(two.pyramid, point_at({50, 47.5f}, {1, 0}, 3), one);
  REQUIRE(near.size() == 1);
  CHECK(std::abs(distance(near[0], {1, 0}) - 5) < 0.1);
  CHECK(find_at(two.pyramid, point_at({47, 47.5f}, {1, 0}, 3), one)[0].reason == Reason::ambiguous);
  CHECK(find_at(two.pyramid, point_at({47, 47.5f}, {1, 0}, 3)).size() == 2);
  s.steps.clear();
  for (int k = -20; k <= 20; ++k) s.step(3.0 * k, k % 2 == 0 ? 80 : -80);
  const Shown grating(s.render());
  CHECK(find_at(grating.pyramid, point_at(kMiddle, {1, 0}, 5))[0].reason == Reason::ambiguous);
}

TEST_CASE("an uncertain prediction is searched for farther away, on a coarser level") {
  for (const float away : {5.0f, 14.0f, 22.0f}) {
    CAPTURE(away);
    Scene s;
    s.degrees = 70;
    s.step(0.3, 90);
    const Shown shown(s.render());
    const Vec2 n = s.normal(), x = kMiddle - away * n;
    const std::vector<Observation> found = find_at(shown.pyramid, point_at(x, n, 8));
    REQUIRE(found[0].reason == Reason::found);
    CHECK(std::abs(distance(found[0], n) - 0.3) < 0.15);
    if (away > 6) CHECK(find_at(shown.pyramid, point_at(x, n, 1.5f))[0].reason == Reason::no_texture);
  }
}

TEST_CASE("without an edge none is found: black, white, grey, a slope, one pixel, noise") {
  Picture slope(kSide, kSide), dot(kSide, kSide, 128), noisy(kSide, kSide);
  texture::Random random(5);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      slope.at(x, y) = static_cast<std::uint8_t>(2 * x);
      noisy.at(x, y) = static_cast<std::uint8_t>(128 + 8 * random.normal());
    }
  dot.at(48, 48) = 129;
  for (const Picture& p :
       {Picture(kSide, kSide, 0), Picture(kSide, kSide, 255), Picture(kSide, kSide, 128), slope, dot}) {
    const Shown shown(p);
    for (const float x : {20.0f, 47.3f, 48.0f, 60.7f})
      CHECK(find_at(shown.pyramid, point_at({x, 48}, {0.8f, 0.6f}, 4))[0].reason == Reason::no_texture);
  }
  const Shown shown(noisy);
  int found = 0, tried = 0;
  for (float y = 16; y < 80; y += 3)
    for (float x = 16; x < 80; x += 3, ++tried)
      found += find_at(shown.pyramid, point_at({x, y}, {y - 40, x - 30.5f}, 2))[0].reason == Reason::found;
  CHECK(100 * found < 3 * tried);
}

TEST_CASE(
    "a point outside, at the border, or in an image smaller than the strip is refused with that reason") {
  Scene s;
  s.step(0, 90);
  const Shown shown(s.render());
  for (const Vec2 x : {Vec2{-1, 40}, Vec2{40, -0.5f}, Vec2{95.5f, 40}, Vec2{40, 96}, Vec2{1e9f, 0},
                       Vec2{40, 0.5f}, Vec2{1, 40}})
    CHECK(find_at(shown.pyramid, point_at(x, {1, 0}))[0].reason == Reason::outside_image);
  // Near the border what is left of the strip is searched.
  CHECK(find_at(shown.pyramid, point_at({47.2f, 3}, {1, 0}))[0].reason == Reason::found);
  const Shown tiny(Picture(8, 8, 50));
  CHECK(find_at(tiny.pyramid, point_at({1, 4}, {1, 0}))[0].reason == Reason::outside_image);
  CHECK(find_at(tiny.pyramid, point_at({4, 4}, {1, 0}))[0].reason != Reason::found);
  CHECK(find_at(Pyramid{}, point_at(kMiddle, {1, 0}))[0].reason == Reason::outside_image);
}

TEST_CASE("bad arguments are refused or harmless") {
  Scene s;
  s.step(0.2, 90);
  const Shown shown(s.render());
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  EdgePoint p = point_at(kMiddle, {1, 0});
  const auto reason = [&](const EdgePoint& q, const EdgeOptions& o = {}) {
    return find_at(shown.pyramid, q, o)[0].reason;
  };
  for (const Vec2 v : {Vec2{nan, 1}, Vec2{1, inf}, Vec2{0, 0}, Vec2{1e-25f, 0}, Vec2{1e25f, 0}}) {
    EdgePoint q = p;
    q.normal = v;
    CHECK(reason(q) == Reason::not_visible);
  }
  for (const Vec2 v : {Vec2{1e-18f, 0}, Vec2{1e18f, 0}}) {
    EdgePoint q = p;
    q.normal = v;
    CHECK(reason(q) == Reason::found);
  }
  for (const Vec2 v : {Vec2{nan, 1}, Vec2{1, inf}}) CHECK(reason(point_at(v, {1, 0})) == Reason::not_visible);
  CHECK(reason(point_at(kMiddle, {1, 0}, nan)) == Reason::not_visible);
  CHECK(reason(point_at(kMiddle, {1, 0}, 2, nan)) == Reason::not_visible);
  CHECK(find_edge(shown.pyramid, p, {}, {}) == 0);
  Observation one;
  CHECK(find_edge(shown.pyramid, p, {}, {&one, 1}) == 1);
  // Without uncertainty the range is two pixels.
  CHECK(reason(point_at({47.7f, 47.5f}, {1, 0}, 0)) == Reason::found);
  CHECK(reason(point_at({50.7f, 47.5f}, {1, 0}, 0)) == Reason::no_texture);
  EdgeOptions odd;
  odd.hypotheses = -3;
  CHECK(reason(p, odd) == Reason::found);
  odd.hypotheses = 1000;
  CHECK(reason(p, odd) == Reason::found);
  CHECK(reason(point_at(kMiddle, {1, 0}, 1e9f)) == Reason::found);
}

TEST_CASE("for random images and points there is a reason and no NaN") {
  texture::Random random(3);
  int found = 0;
  for (int round = 0; round < 200; ++round) {
    Picture p(8 + round % 50, 8 + round % 37);
    for (int y = 0; y < p.height; ++y)
      for (int x = 0; x < p.width; ++x)
        p.at(x, y) =
            static_cast<std::uint8_t>(round % 2 == 0 ? random.uniform(0, 256) : 255 * ((x / 9 + y / 9) % 2));
    const Shown shown(p, 1 + round % 3);
    for (int k = 0; k < 30; ++k) {
      const auto within = [&](double low, double high) {
        return static_cast<float>(random.uniform(low, high));
      };
      // One after the other: arguments are evaluated in any order.
      const Vec2 x{within(-3, p.width + 3), within(-3, p.height + 3)}, normal{within(-1, 1), within(-1, 1)};
      const float sd = within(0, 9), contrast = k % 3 == 0 ? within(-0.5, 0.5) : 0;
      const EdgePoint q = point_at(x, normal, sd, contrast);
      for (const Observation& o : find_at(shown.pyramid, q)) {
        REQUIRE(is_finite(o.x));
        REQUIRE((is_finite(o.information.xx) && is_finite(o.information.xy) && is_finite(o.information.yy)));
        REQUIRE((o.information.xx >= 0 && magnitude(o.score) <= 1));
        found += o.reason == Reason::found;
      }
    }
  }
  CHECK(found > 20);
}

TEST_CASE(
    "a pyramid of one level is searched as far as a profile reaches, however uncertain the prediction") {
  Scene scene;
  scene.step(6, 60);
  const Shown one(scene.render(), 1);
  const Vec2 n = scene.normal();
  for (const float sd : {2.0f, 10.0f, 1000.0f}) {
    CAPTURE(sd);
    for (const int finest_level : {0, 2}) {
      EdgeOptions options;
      options.finest_level = finest_level;
      const auto found = find_at(one.pyramid, point_at(kMiddle, n, sd), options);
      REQUIRE(found.size() >= 1);
      REQUIRE(found[0].reason == Reason::found);
      CHECK(distance(found[0], n) == doctest::Approx(6).epsilon(0.05));
    }
  }
}

}  // namespace edges_test
