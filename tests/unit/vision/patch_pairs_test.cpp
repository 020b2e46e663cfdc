// Pairs of 16-bit integers, and the kernels made of them, against plain loops: the same integers. Where a processor has the
// instructions, the first case runs them; elsewhere it compares the plain stand-ins.
#include "vision/patch_pairs.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "texture.hpp"
#include "vision/patch_sampling.hpp"

namespace patch_pairs_test {

using namespace pliant::patch;

namespace {

using Array = std::vector<i16>;

Array random_values(std::uint64_t seed, int count, int low, int high) {
  texture::Random random(seed);
  Array v(static_cast<std::size_t>(count));
  for (i16& x : v) x = static_cast<i16>(random.uniform(low, high + 1));
  return v;
}

// The window's elements of an array; what lies behind them is not compared.
Array window_of(const Array& v, int window) {
  return Array(v.begin(), v.begin() + window * window);
}

}  // namespace

TEST_CASE("operations on pairs are those on both elements") {
  const Array a = random_values(1, 2000, -16000, 16000), b = random_values(2, 2000, -16000, 16000);
  for (std::size_t k = 0; k + 1 < a.size(); k += 2) {
    const Pair p = load_pair(&a[k]), q = load_pair(&b[k]);
    const int a0 = a[k], a1 = a[k + 1], b0 = b[k], b1 = b[k + 1];
    REQUIRE(p == pair_of(a0, a1));
    REQUIRE(add(p, q) == pair_of(a0 + b0, a1 + b1));
    REQUIRE(subtract(p, q) == pair_of(a0 - b0, a1 - b1));
    REQUIRE(half_sum(p, q) == pair_of((a0 + b0) >> 1, (a1 + b1) >> 1));
    REQUIRE(add_products(p, q, a0) == a0 + a0 * b0 + a1 * b1);
    REQUIRE(add_difference(p, q, b1) == b1 + a0 * b0 - a1 * b1);
    REQUIRE(product_high_low(p, q) == a1 * b0);
    REQUIRE(saturated12(p) == pair_of(std::clamp(a0, -2048, 2047), std::clamp(a1, -2048, 2047)));
    REQUIRE(shifted<5>(a0 * b0, a1 * b1) == pair_of((a0 * b0) >> 5, (a1 * b1) >> 5));
    REQUIRE(uppers(a0 * b0, a1 * b1) == pair_of((a0 * b0) >> 16, (a1 * b1) >> 16));
    REQUIRE(mulhi(p, b[k]) == pair_of((a0 * b0) >> 16, (a1 * b0) >> 16));
  }
}

TEST_CASE("bytes of a word become pairs") {
  texture::Random random(4);
  for (int k = 0; k < 1000; ++k) {
    std::uint8_t b[4];
    for (auto& x : b) x = static_cast<std::uint8_t>(random.uniform(0, 256));
    const auto sign = [](std::uint8_t x) { return x < 128 ? x : x - 256; };
    const std::uint32_t word = load_bytes(b);
    const Pair before = pair_of(k, 3 * k);
    REQUIRE(add_even_bytes(before, word) == pair_of(k + b[0], 3 * k + b[2]));
    REQUIRE(add_odd_bytes(before, word) == pair_of(k + b[1], 3 * k + b[3]));
    REQUIRE(signed_even_bytes(word) == pair_of(sign(b[0]), sign(b[2])));
    REQUIRE(signed_odd_bytes(word) == pair_of(sign(b[1]), sign(b[3])));
    REQUIRE(add_bytes(7, word) == 7u + b[0] + b[1] + b[2] + b[3]);
    REQUIRE(lowers(k, 5 * k) == pair_of(k, 5 * k));
  }
}

TEST_CASE("sums of pairs are the plain sums") {
  constexpr int kCount = 96;
  const auto v = random_values(1, kCount, -2048, 2047), a = random_values(2, kCount, -2048, 2047),
             b = random_values(3, kCount, -9, 9), c = random_values(4, kCount, 0, 1),
             d = random_values(5, kCount, -2000, 0);
  const Sums4 s = dot4(v.data(), a.data(), b.data(), c.data(), d.data(), kCount),
              t = pairs::dot4(v.data(), a.data(), b.data(), c.data(), d.data(), kCount);
  CHECK((s.a == t.a && s.b == t.b && s.c == t.c && s.d == t.d));
  CHECK(pairs::dot(v.data(), d.data(), kCount) == dot(v.data(), d.data(), kCount));
  Array x(kCount), y(kCount), x2(kCount), y2(kCount);
  multiply_by_position(v.data(), b.data(), c.data(), kCount, x.data(), y.data());
  pairs::multiply_by_position(v.data(), b.data(), c.data(), kCount, x2.data(), y2.data());
  CHECK(x == x2);
  CHECK(y == y2);
  for (const int grey : {5, 250, 0, 255, 6, 249})
    for (const std::size_t at : {std::size_t{0}, std::size_t{17}, std::size_t{95}}) {
      Array w = random_values(6, kCount, -1000, 1000);
      w[at] = static_cast<i16>(grey * kGreyScale - kGreyOffset);
      CHECK(pairs::is_within(w.data(), kCount, kUsableGrey) == (grey > 5 && grey < 250));
    }
}

TEST_CASE("samples by pairs are the plain samples, for every window and phase") {
  texture::Random random(5);
  std::vector<std::uint8_t> pixels(64 * 64);
  for (auto& p : pixels) {
    const int grey = static_cast<int>(random.uniform(0, 2) * random.uniform(0, 256));  // up to 512
    p = static_cast<std::uint8_t>(grey);
  }
  pixels[700] = 255;
  for (int window = kMinWindow; window <= kMaxWindow; window += 2) {
    const int row_length = block_stride(window);
    const auto size = static_cast<std::size_t>(block_size(window));
    Array block(size), block2(size), scratch(2 * size), out(size), out2(size);
    load_block(pixels.data() + 64 * 7 + 9, 64, window, block.data());
    pairs::load_rows(pixels.data() + 64 * 7 + 9, 64, block_rows(window), row_length, block2.data());
    REQUIRE(block == block2);
    for (int f = 0; f < kSubpixel; ++f) {
      const int other = kSubpixel - 1 - f;
      sample_linear(block.data(), f, other, window, scratch.data(), out.data());
      pairs::sample_linear(block.data(), f, other, window, scratch.data(), out2.data());
      REQUIRE(window_of(out, window) == window_of(out2, window));
      sample_cubic(block.data(), f, other, window, scratch.data(), out.data());
      pairs::sample_cubic(block.data(), f, other, window, scratch.data(), out2.data());
      REQUIRE(window_of(out, window) == window_of(out2, window));
    }
  }
}

TEST_CASE("samples on a lattice, one at a time, are the plain ones") {
  texture::Random random(7);
  std::vector<std::uint8_t> pixels(64 * 64);
  for (auto& p : pixels) p = static_cast<std::uint8_t>(random.uniform(0, 256));
  for (int window = kMinWindow; window <= kMaxWindow; window += 2) {
    const auto size = static_cast<std::size_t>(block_size(window));
    Array scratch(2 * size), block(size), block2(size);
    for (int turn = 0; turn < 20; ++turn) {
      constexpr int kOne = 1 << kLatticeBits;
      const auto near = [&](int middle) { return middle + static_cast<int>(random.uniform(-9000, 9000)); };
      const Lattice at{near(15 * kOne), near(15 * kOne), near(kOne), near(0), near(0), near(kOne)};
      sample_lattice(pixels.data(), 64, at, window, scratch.data(), block.data());
      pairs::sample_lattice(pixels.data(), 64, at, window, block2.data());
      for (int y = 0; y < window + 2; ++y)
        for (int x = 0; x < window + 2; ++x) {
          const auto k = static_cast<std::size_t>(y * block_stride(window) + x);
          REQUIRE(block[k] == block2[k]);
        }
    }
  }
}

TEST_CASE("a row of a template by pairs is the definition's") {
  constexpr int kCount = 12;
  const auto before = random_values(1, kCount, -15000, 15000),
             after = random_values(2, kCount, -15000, 15000), mask = random_values(3, kCount, 0, 1),
             v = random_values(4, kCount, -2048, 2047);
  Array t(kCount), m(kCount), g(kCount), smooth(kCount);
  pairs::mask_row(v.data(), mask.data(), kCount, t.data(), m.data());
  pairs::gradient_row(before.data(), after.data(), m.data(), kCount, g.data());
  pairs::smooth3(v.data(), 1, kCount - 2, smooth.data());
  for (std::size_t k = 0; k < kCount; ++k) {
    const bool is_used = mask[k] == 1 && v[k] > kUsableGrey.lowest && v[k] < kUsableGrey.highest;
    CHECK(m[k] == is_used);
    CHECK(t[k] == (is_used ? v[k] : 0));
    CHECK(g[k] == (is_used ? (after[k] - before[k]) >> 4 : 0));
    if (k + 2 < kCount) CHECK(smooth[k] == (3 * v[k] + 10 * v[k + 1] + 3 * v[k + 2]) >> 1);
  }
}

}  // namespace patch_pairs_test
