// Sums and masks against plain loops.
#include "vision/patch_sums.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "texture.hpp"

namespace patch_sums_test {

using namespace pliant::patch;

namespace {

constexpr int kCount = 96;

std::vector<i16> random_values(std::uint64_t seed, int low, int high) {
  texture::Random random(seed);
  std::vector<i16> v(kCount);
  for (i16& x : v) x = static_cast<i16>(random.uniform(low, high + 1));
  return v;
}

std::int64_t plain_dot(const std::vector<i16>& a, const std::vector<i16>& b) {
  std::int64_t s = 0;
  for (std::size_t k = 0; k < a.size(); ++k) s += std::int64_t{a[k]} * b[k];
  return s;
}

}  // namespace

TEST_CASE("sums of products are exact") {
  const auto v = random_values(1, -2048, 2047), a = random_values(2, -2048, 2047),
             b = random_values(3, -9, 9), c = random_values(4, 0, 1), d = random_values(5, -2000, 0);
  const Sums4 s = dot4(v.data(), a.data(), b.data(), c.data(), d.data(), kCount);
  CHECK(s.a == plain_dot(v, a));
  CHECK(s.b == plain_dot(v, b));
  CHECK(s.c == plain_dot(v, c));
  CHECK(s.d == plain_dot(v, d));
  CHECK(dot(v.data(), d.data(), kCount) == plain_dot(v, d));
  std::vector<i16> masked(kCount);
  apply_mask(v.data(), c.data(), kCount, masked.data());
  CHECK(sum_squares(v.data(), c.data(), kCount) == plain_dot(masked, masked));
}

TEST_CASE("sums of the products of four arrays are those of two at a time") {
  const std::vector<i16> of[] = {random_values(6, 0, 1), random_values(7, -2048, 2047),
                                 random_values(8, -1280, 1280), random_values(9, -2000, 9)};
  const Sums10 s = products_of(of[0].data(), of[1].data(), of[2].data(), of[3].data(), kCount);
  const i32 sums[] = {s.aa, s.ab, s.ac, s.ad, s.bb, s.bc, s.bd, s.cc, s.cd, s.dd};
  const i32* next = sums;
  for (int i = 0; i < 4; ++i)
    for (int k = i; k < 4; ++k) CHECK(*next++ == plain_dot(of[i], of[k]));
}

TEST_CASE("the largest window of the largest values does not overflow") {
  std::vector<i16> v(static_cast<std::size_t>(padded(kMaxWindow)), 0);
  for (int k = 0; k < kMaxWindow * kMaxWindow; ++k) v[static_cast<std::size_t>(k)] = -2048;
  CHECK(dot(v.data(), v.data(), padded(kMaxWindow)) == 441 * 2048 * 2048);
}

TEST_CASE("a centred sum is the covariance times the number of pixels") {
  const auto a = random_values(8, -2048, 2047), b = random_values(9, -2048, 2047),
             one = random_values(1, 1, 1);
  double ma = 0, mb = 0, covariance = 0;
  for (std::size_t k = 0; k < kCount; ++k) {
    ma += a[k] / double{kCount};
    mb += b[k] / double{kCount};
  }
  for (std::size_t k = 0; k < kCount; ++k) covariance += (a[k] - ma) * (b[k] - mb);
  const float c = centred(kCount, 1.0f / kCount, dot(a.data(), b.data(), kCount),
                          dot(a.data(), one.data(), kCount), dot(b.data(), one.data(), kCount));
  CHECK(double(c) == doctest::Approx(covariance).epsilon(1e-5));
}

TEST_CASE("clipped pixels are told from usable ones") {
  auto v = random_values(6, -1000, 1000);
  const auto m = random_values(7, 0, 1);
  CHECK(is_within(v.data(), kCount, kUsableGrey));
  std::vector<i16> out(kCount);
  CHECK(mask_extremes(v.data(), m.data(), kCount, kUsableGrey, out.data()) == plain_dot(m, m));
  CHECK(out == m);
  // 5 and 250 grey levels count as clipped, 6 and 249 do not.
  for (const int grey : {5, 250, 0, 255, 6, 249}) {
    v[17] = static_cast<i16>(grey * kGreyScale - kGreyOffset);
    const bool is_usable = grey > 5 && grey < 250;
    CHECK(is_within(v.data(), kCount, kUsableGrey) == is_usable);
    CHECK(mask_extremes(v.data(), m.data(), kCount, kUsableGrey, out.data()) ==
          plain_dot(m, m) - (is_usable ? 0 : m[17]));
    CHECK(out[17] == (is_usable ? m[17] : 0));
  }
}

TEST_CASE("stretch images are gradients times positions, over sixteen") {
  const auto g = random_values(3, -1800, 1800), x = random_values(4, -10, 10), y = random_values(5, -10, 10);
  std::vector<i16> by_x(kCount), by_y(kCount);
  multiply_by_position(g.data(), x.data(), y.data(), kCount, by_x.data(), by_y.data());
  for (std::size_t k = 0; k < kCount; ++k) {
    CHECK(by_x[k] == (x[k] * g[k]) >> 4);
    CHECK(by_y[k] == (y[k] * g[k]) >> 4);
  }
}

}  // namespace patch_sums_test
