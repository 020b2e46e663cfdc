// The sampling kernels against their definitions in double, for every window and phase.
#include "vision/patch_sampling.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "texture.hpp"
#include "vision/bilinear.hpp"

namespace patch_sampling_test {

using namespace pliant;
using namespace pliant::patch;
using texture::Picture;

namespace {

constexpr int kLeft = 9, kTop = 7;  // of the block in the image

struct Arrays {
  std::vector<i16> block, scratch, out;
  explicit Arrays(int window)
      : block(static_cast<std::size_t>(block_size(window))),
        scratch(static_cast<std::size_t>(scratch_size(window))),
        out(static_cast<std::size_t>(padded(window) + 32)) {}
};

// Grey of pixel (i, j) of the window, less 128.
double grey(const Picture& p, int i, int j) {
  return p.pixels[static_cast<std::size_t>((kTop + 1 + j) * p.width + kLeft + 1 + i)] - 128.0;
}

double linear(const Picture& p, int i, int j, double fx, double fy) {
  return (1 - fy) * ((1 - fx) * grey(p, i, j) + fx * grey(p, i + 1, j)) +
         fy * ((1 - fx) * grey(p, i, j + 1) + fx * grey(p, i + 1, j + 1));
}

}  // namespace

TEST_CASE("a block holds the pixels in sixteenths of a grey level") {
  const Picture p = texture::noise(64, 64, 5);
  for (int window = kMinWindow; window <= kMaxWindow; window += 2) {
    Arrays a(window);
    load_block(p.pixels.data() + kTop * 64 + kLeft, 64, window, a.block.data());
    for (int j = -1; j < window + 2; ++j)
      for (int i = -1; i < window + 2; ++i)
        REQUIRE(a.block[static_cast<std::size_t>((j + 1) * block_stride(window) + i + 1)] ==
                kGreyScale * static_cast<int>(grey(p, i, j)));
  }
}

TEST_CASE("linear samples are those of the definition to a sixteenth of a grey level") {
  const Picture p = texture::noise(64, 64, 5);
  for (int window = kMinWindow; window <= kMaxWindow; window += 2)
    for (int f = 0; f < kSubpixel; f += 9) {
      CAPTURE(window);
      CAPTURE(f);
      Arrays a(window);
      const int fx = f, fy = (f * 5 + 3) % kSubpixel;
      load_block(p.pixels.data() + kTop * 64 + kLeft, 64, window, a.block.data());
      sample_linear(a.block.data(), fx, fy, window, a.scratch.data(), a.out.data());
      double worst = 0;
      for (int j = 0; j < window; ++j)
        for (int i = 0; i < window; ++i)
          worst = std::fmax(worst,
                            std::fabs(a.out[static_cast<std::size_t>(j * window + i)] / double{kGreyScale} -
                                      linear(p, i, j, fx / 128.0, fy / 128.0)));
      CHECK(worst < 1.01 / kGreyScale);
    }
}

TEST_CASE("cubic samples are exact on pixels, and on a plane wave much closer to it than linear ones") {
  const Picture p = texture::noise(64, 64, 5);
  Arrays a(13);
  load_block(p.pixels.data() + kTop * 64 + kLeft, 64, 13, a.block.data());
  sample_cubic(a.block.data(), 0, 0, 13, a.scratch.data(), a.out.data());
  for (int j = 0; j < 13; ++j)
    for (int i = 0; i < 13; ++i)
      CHECK(a.out[static_cast<std::size_t>(j * 13 + i)] == kGreyScale * static_cast<int>(grey(p, i, j)));

  const auto wave = [](double x, double y) {
    return 128 + 100 * std::sin(0.7 * x + 0.5 * y);
  };  // wavelength 7.3 px
  Picture w(64, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) w.at(x, y) = static_cast<std::uint8_t>(wave(x, y) + 0.5);
  load_block(w.pixels.data() + kTop * 64 + kLeft, 64, 13, a.block.data());
  double error[2] = {};
  for (int f = 0; f < kSubpixel; f += 7)
    for (const bool cubic : {false, true}) {
      (cubic ? sample_cubic : sample_linear)(a.block.data(), f, 127 - f, 13, a.scratch.data(), a.out.data());
      for (int j = 0; j < 13; ++j)
        for (int i = 0; i < 13; ++i) {
          const double e = a.out[static_cast<std::size_t>(j * 13 + i)] / 16.0 + 128 -
                           wave(kLeft + 1 + i + f / 128.0, kTop + 1 + j + (127 - f) / 128.0);
          error[cubic] += e * e;
        }
    }
  CHECK(std::sqrt(error[1]) < 0.35 * std::sqrt(error[0]));
}

TEST_CASE("cubic samples of black and white checks stay within the range of grey levels") {
  Picture p(64, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) p.at(x, y) = (x / 2 + y / 2) % 2 == 0 ? 0 : 255;
  Arrays a(21);
  load_block(p.pixels.data() + kTop * 64 + kLeft, 64, 21, a.block.data());
  for (int f = 0; f < kSubpixel; f += 5) {
    sample_cubic(a.block.data(), f, f, 21, a.scratch.data(), a.out.data());
    for (int k = 0; k < 21 * 21; ++k) {
      CHECK(a.out[static_cast<std::size_t>(k)] >= -kGreyOffset);
      CHECK(a.out[static_cast<std::size_t>(k)] < kGreyOffset);
    }
  }
}

TEST_CASE("a lattice that is turned and stretched gives the bilinear samples of its positions") {
  const Picture p = texture::noise(64, 64, 5);
  for (int window = kMinWindow; window <= kMaxWindow; window += 2) {
    CAPTURE(window);
    Arrays a(window);
    const Lattice l{20 << kLatticeBits, 6 << kLatticeBits, 30000, 11000, -9000, 33000};
    sample_lattice(p.pixels.data(), 64, l, window, a.scratch.data(), a.block.data());
    for (int j = 0; j < window + 2; ++j)
      for (int i = 0; i < window + 2; ++i) {
        const int x = l.x + i * l.across_x + j * l.down_x, y = l.y + i * l.across_y + j * l.down_y;
        const std::uint8_t* q = p.pixels.data() + (y >> 15) * 64 + (x >> 15);
        const auto fraction = [](int v) { return static_cast<float>(v & 32767) / 32768; };
        const float exact = 16 * (bilinear(q, q + 64, 1, fraction(x), fraction(y)) - 128);
        const int here = a.block[static_cast<std::size_t>(j * block_stride(window) + i)];
        CHECK(std::fabs(static_cast<float>(here) - exact) < 1.5f);
        const int plain = bilinear_sixteenths(q, 64, (x >> 7) & 255, (y >> 7) & 255) - kGreyOffset;
        CHECK(std::abs(here - plain) <=
              33);  // fractions of 8 bits: up to a 256th of 255 grey levels along each axis
      }
  }
}

}  // namespace patch_sampling_test
