// Eigenvalues of a structure tensor, and which textures can be matched.
#include "vision/patch_texture.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "base/symmetric.hpp"
#include "vision/patch_arrays.hpp"
#include "vision/patch_tuning.hpp"

namespace patch_texture_test {

using namespace pliant;
using namespace pliant::patch;

namespace {

constexpr int kWindow = 11;
constexpr float kPixels = kWindow * kWindow, kScale = kGreyScale * kGreyScale;

// A texture with these mean eigenvalues, (grey/px)^2, the larger one at an angle.
Texture texture_of(float large, float small, double radians = 0.4) {
  const float c = static_cast<float>(std::cos(radians)), s = static_cast<float>(std::sin(radians));
  const float a = large * kScale * kPixels, b = small * kScale * kPixels;
  return {kWindow * kWindow,
          100 * kScale * kPixels,
          {a * c * c + b * s * s, (a - b) * c * s, a * s * s + b * c * c}};
}

}  // namespace

TEST_CASE("eigenvalues and the direction of the larger one are those the tensor was made of") {
  for (double angle = -1.5; angle <= 1.5; angle += 0.25) {
    const Sym2 s = texture_of(9, 2, angle).tensor;
    const Eigenvalues e = eigenvalues(s);
    CHECK(double(e.largest) == doctest::Approx(double(9 * kScale * kPixels)).epsilon(1e-4));
    CHECK(double(e.smallest) == doctest::Approx(double(2 * kScale * kPixels)).epsilon(1e-4));
    const Vec2 d = strongest_direction(s, e.smallest);
    CHECK(double(d.x) == doctest::Approx(std::cos(angle)).epsilon(1e-3));
    CHECK(double(d.y) == doctest::Approx(std::sin(angle)).epsilon(1e-3));
  }
  CHECK(length(strongest_direction({3, 0, 3}, 3)) == 0);
}

TEST_CASE("a patch is usable with enough texture in both directions, or in one if edges are accepted") {
  Vec2 along;
  CHECK(is_usable(texture_of(9, 2), kWindow, false, along));
  CHECK_FALSE(is_edge(along));
  const float least = kPatchTuning.min_eigenvalue;
  CHECK_FALSE(is_usable(texture_of(9, 0.9f * least), kWindow, false, along));
  CHECK(is_usable(texture_of(9, 0.9f * least), kWindow, true, along));
  CHECK(is_edge(along));
  CHECK(double(along.x) == doctest::Approx(std::cos(0.4)).epsilon(1e-3));
  CHECK_FALSE(is_usable(texture_of(0.9f * least, 0), kWindow, true, along));
  // Above the smallest texture, the ratio of the eigenvalues tells an edge from a corner.
  CHECK(is_usable(texture_of(100, 0.9f * 100 * kPatchTuning.edge_eigenvalue_ratio), kWindow, true, along));
  CHECK(is_edge(along));
}

TEST_CASE("too few pixels or too little contrast make a patch unusable") {
  Vec2 along;
  Texture few = texture_of(9, 2), pale = few;
  few.pixels = kWindow * kWindow / 2;
  CHECK_FALSE(is_usable(few, kWindow, true, along));
  pale.variance_sum = 0.9f * kPatchTuning.min_variance * kScale * kPixels;
  CHECK_FALSE(is_usable(pale, kWindow, true, along));
}

TEST_CASE("a confined tensor is regular, and its solution does not move along the edge") {
  const Vec2 along{0.6f, 0.8f};
  Sym2 s{9 * along.x * along.x, 9 * along.x * along.y, 9 * along.y * along.y};
  confine(s, along, 9);
  CHECK(s.xx == doctest::Approx(9));
  CHECK(s.xy == doctest::Approx(0).scale(1));
  CHECK(s.yy == doctest::Approx(9));
}

}  // namespace patch_texture_test
