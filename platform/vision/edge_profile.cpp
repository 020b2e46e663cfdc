// One line of samples is usual. A strip of five costs little, halves the noise, and its differences across the edge
// measure the local noise, from which the variance of the edge's position follows.
#include "vision/edge_profile.hpp"

#include "base/lanes.hpp"
#include "base/wide_vectors.hpp"
#include "vision/bilinear.hpp"

namespace pliant {
namespace {

constexpr int kHalfWidth = kProfileLines / 2;
constexpr int kBits = 16;  // fractional bits of positions
// Samples of a line at most, in whole vectors of eight.
constexpr int kMostSamples = (2 * (kMaxProfileReach + kProfileBorder) + 1 + 7) & ~7;

struct Fixed {
  int x, y;
};

Fixed fixed(Vec2 v) {
  return {static_cast<int>(v.x * (1 << kBits)), static_cast<int>(v.y * (1 << kBits))};
}

// The strip in the image: sample (j, t) lies at origin + j * across + t * along.
struct Strip {
  Fixed origin, along, across;

  Fixed at(int j, int t) const {
    return {origin.x + j * across.x + t * along.x, origin.y + j * across.y + t * along.y};
  }
};

bool is_inside(const ImageView& image, Fixed p) {
  return p.x >= 0 && p.y >= 0 && p.x < (image.width - 1) << kBits && p.y < (image.height - 1) << kBits;
}

// In 1/256, of a pixel.
int fraction(int coordinate) {
  return (coordinate >> (kBits - 8)) & 255;
}

// Steps, up to `most`, that the whole width of the strip stays inside the image on the side of `sign`; -1: not even
// at 0.
int steps_inside(const ImageView& image, const Strip& strip, int sign, int most) {
  int t = 0;
  while (t <= most && is_inside(image, strip.at(-kHalfWidth, sign * t)) &&
         is_inside(image, strip.at(kHalfWidth, sign * t)))
    ++t;
  return t - 1;
}

// Sums of the samples across the strip, at each of the steps from `low` on; kMostSamples have room. \return the sum of the
// squared bends across it.
#if PLIANT_HAS_VECTORS

// A line at a time: scalar code fetches the four pixels of each sample, vectors do the rest. They are whole: beyond the last
// sample all pixels are zero.
PLIANT_WIDE_VECTORS
std::int64_t sum_across(const ImageView& image, const Strip& strip, int low, int samples,
                        std::int32_t* __restrict sum) {
  constexpr int kBend[kProfileLines] = {1, 0, -2, 0, 1};
  std::uint32_t pixels[kMostSamples] = {};  // of each sample: two of a line, two of the line below
  std::int32_t bend[kMostSamples] = {};
  const int whole = (samples + 7) & ~7;
  const Fixed along = strip.along;
  for (int t = 0; t < whole; ++t) sum[t] = 0;
  for (int j = 0; j < kProfileLines; ++j) {
    const Fixed first = strip.at(j - kHalfWidth, low);
    // As wide as addresses, so that no index is widened for each sample.
    std::ptrdiff_t x = first.x, y = first.y, stride = image.stride;
    for (int t = 0; t < samples; ++t, x += along.x, y += along.y) {
      const std::uint8_t *p = image.data + (y >> kBits) * stride + (x >> kBits), *q = p + stride;
      const int upper = p[0] | p[1] << 8, lower = q[0] | q[1] << 8;
      pixels[t] = static_cast<std::uint32_t>(upper) | static_cast<std::uint32_t>(lower) << 16;
    }
    for (int t = 0; t < whole; ++t) {
      const auto pixel = [&](int k) { return static_cast<int>(pixels[t] >> (8 * k) & 255); };
      const int v = bilinear_sixteenths(pixel(0), pixel(1), pixel(2), pixel(3),
                                        fraction(first.x + t * along.x), fraction(first.y + t * along.y));
      sum[t] += v;
      bend[t] += kBend[j] * v;
    }
  }
  std::int64_t roughness = 0;
  for (int t = 0; t < samples; ++t) roughness += std::int64_t{bend[t]} * bend[t];
  return roughness;
}

#else

std::int64_t sum_across(const ImageView& image, const Strip& strip, int low, int samples, std::int32_t* sum) {
  std::int64_t roughness = 0;
  for (int t = 0; t < samples; ++t) {
    int v[kProfileLines];
    for (int j = 0; j < kProfileLines; ++j) {
      const Fixed at = strip.at(j - kHalfWidth, low + t);
      const std::uint8_t* q = image.data + std::ptrdiff_t{at.y >> kBits} * image.stride + (at.x >> kBits);
      v[j] = bilinear_sixteenths(q, image.stride, fraction(at.x), fraction(at.y));
    }
    sum[t] = v[0] + v[1] + v[2] + v[3] + v[4];
    const int bend = v[0] - 2 * v[2] + v[4];
    roughness += std::int64_t{bend} * bend;
  }
  return roughness;
}

#endif

}  // namespace

void sample_profile(const ImageView& image, Vec2 x, Vec2 normal, int reach, EdgeProfile& profile) {
  PLIANT_ASSERT(reach >= 0 && reach <= kMaxProfileReach);
  const Strip strip{fixed(x), fixed(normal), fixed({-normal.y, normal.x})};
  PLIANT_ASSERT(is_inside(image, strip.origin));
  profile.count = 0;
  const int low = -steps_inside(image, strip, -1, reach + kProfileBorder);
  const int high = steps_inside(image, strip, 1, reach + kProfileBorder);
  if (low > -kProfileBorder || high < kProfileBorder) return;
  std::int32_t sum[kMostSamples];
  const int samples = high - low + 1;
  const std::int64_t roughness = sum_across(image, strip, low, samples, sum);
  profile.first = low + 2;
  profile.count = samples - 4;
  for (int i = 0; i < profile.count; ++i)
    profile.derivative[i] = sum[i + 4] - sum[i] + 2 * (sum[i + 3] - sum[i + 1]);
  profile.noise = static_cast<float>(roughness) / static_cast<float>(6 * samples);
}

}  // namespace pliant
