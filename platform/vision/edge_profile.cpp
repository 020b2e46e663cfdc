// One line of samples is usual. A strip of five costs little, halves the noise, and its differences across the edge
// measure the local noise, from which the variance of the edge's position follows.
#include "vision/edge_profile.hpp"

#include "vision/bilinear.hpp"

namespace pliant {
namespace {

constexpr int kHalfWidth = kProfileLines / 2;
constexpr int kBits = 16;  // fractional bits of positions

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

int sample(const ImageView& image, Fixed p) {
  const std::uint8_t* q = image.data + std::ptrdiff_t{p.y >> kBits} * image.stride + (p.x >> kBits);
  return bilinear_sixteenths(q, image.stride, (p.x >> (kBits - 8)) & 255, (p.y >> (kBits - 8)) & 255);
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

}  // namespace

void sample_profile(const ImageView& image, Vec2 x, Vec2 normal, int reach, EdgeProfile& profile) {
  PLIANT_ASSERT(reach >= 0 && reach <= kMaxProfileReach);
  const Strip strip{fixed(x), fixed(normal), fixed({-normal.y, normal.x})};
  PLIANT_ASSERT(is_inside(image, strip.origin));
  profile.count = 0;
  const int low = -steps_inside(image, strip, -1, reach + kProfileBorder);
  const int high = steps_inside(image, strip, 1, reach + kProfileBorder);
  if (low > -kProfileBorder || high < kProfileBorder) return;
  std::int32_t sum[2 * (kMaxProfileReach + kProfileBorder) + 1];
  std::int64_t roughness = 0;
  for (int t = low; t <= high; ++t) {
    int v[kProfileLines];
    for (int j = 0; j < kProfileLines; ++j) v[j] = sample(image, strip.at(j - kHalfWidth, t));
    sum[t - low] = v[0] + v[1] + v[2] + v[3] + v[4];
    const int bend = v[0] - 2 * v[2] + v[4];
    roughness += std::int64_t{bend} * bend;
  }
  const int samples = high - low + 1;
  profile.first = low + 2;
  profile.count = samples - 4;
  for (int i = 0; i < profile.count; ++i)
    profile.derivative[i] = sum[i + 4] - sum[i] + 2 * (sum[i + 3] - sum[i + 1]);
  profile.noise = static_cast<float>(roughness) / static_cast<float>(6 * samples);
}

}  // namespace pliant
