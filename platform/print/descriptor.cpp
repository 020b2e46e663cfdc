// Oriented binary descriptors: the direction as in ORB (Rublee et al. 2011), the comparisons as in BRIEF (Calonder et al.
// 2010). A comparison asks for a difference beyond noise, so that flat parts of a print give the same bits in every picture.
#include "print/descriptor.hpp"

#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>

namespace pliant {

namespace {

/// Tuning of descriptors. Each constant: unit, reason, experiment.
struct DescriptorTuning {
  /// Distance of neighbouring samples, px / 4: 1.75 px, so that means of 3 x 3 px touch.
  int spacing_quarter_px = 7;
  /// Difference that a comparison asks for, in 1/256 of the mean deviation of the patch's samples.
  int least_difference = 64;
  /// Mean deviation of the samples (sums over 9 pixels) below which a patch is flat: 2 grey levels.
  int flat_sum = 18;
};
constexpr DescriptorTuning kTuning;

constexpr int kHalf = 6, kSide = 2 * kHalf + 1;  // samples
constexpr int kRadius = 9;                       // px, of the circle that gives the direction
constexpr int kPairs = 32 * kDescriptorWords;

struct Pairs {
  std::uint8_t first[kPairs] = {}, second[kPairs] = {};
};

/// Whether a sample lies inside the circle that every direction covers.
constexpr bool is_inside(int index) {
  const int x = index % kSide - kHalf, y = index / kSide - kHalf;
  return x * x + y * y <= kHalf * kHalf;
}

constexpr int square_distance(int a, int b) {
  const int x = a % kSide - b % kSide, y = a / kSide - b / kSide;
  return x * x + y * y;
}

/// Random pairs, two samples or more apart.
constexpr Pairs make_pairs() {
  Pairs pairs;
  std::uint32_t state = 1;
  for (int count = 0; count < kPairs;) {
    state = state * 1664525u + 1013904223u;
    const int a = static_cast<int>((state >> 8) % (kSide * kSide));
    state = state * 1664525u + 1013904223u;
    const int b = static_cast<int>((state >> 8) % (kSide * kSide));
    if (!is_inside(a) || !is_inside(b) || square_distance(a, b) < 4) continue;
    pairs.first[count] = static_cast<std::uint8_t>(a);
    pairs.second[count++] = static_cast<std::uint8_t>(b);
  }
  return pairs;
}
constexpr Pairs kPairTable = make_pairs();

/// Direction from the corner to the centre of brightness of a circle. \return false where there is none.
bool find_direction(const ImageView& image, int x, int y, int radius, Vec2* direction) {
  int mx = 0, my = 0;
  for (int dy = -radius; dy <= radius; ++dy) {
    const std::uint8_t* const row = image.data + static_cast<std::ptrdiff_t>(y + dy) * image.stride + x;
    int sum = 0;
    for (int dx = -radius; dx <= radius; ++dx) {
      if (dx * dx + dy * dy > radius * radius) continue;
      sum += row[dx];
      mx += dx * row[dx];
    }
    my += dy * sum;
  }
  const auto fx = static_cast<float>(mx), fy = static_cast<float>(my);
  const float norm = std::sqrt(fx * fx + fy * fy);
  if (!(norm > 0)) return false;
  *direction = {fx / norm, fy / norm};
  return true;
}

/// Sum over 3 x 3 pixels around the nearest pixel. Coordinates in 1/4096 px.
int box_sum(const ImageView& image, int x, int y) {
  const std::uint8_t* const p =
      image.data + static_cast<std::ptrdiff_t>((y + 2048) >> 12) * image.stride + ((x + 2048) >> 12);
  int sum = 0;
  for (std::ptrdiff_t row = -image.stride; row <= image.stride; row += image.stride)
    sum += p[row - 1] + p[row] + p[row + 1];
  return sum;
}

/// Nine times the bilinear value: the sum over 3 x 3 pixels of the image at twice the size, nearly. Coordinates in 1/4096 px.
int bilinear_sum(const ImageView& image, int x, int y) {
  const std::uint8_t* const p = image.data + static_cast<std::ptrdiff_t>(y >> 12) * image.stride + (x >> 12);
  const int a = (x & 4095) >> 4, b = (y & 4095) >> 4;
  const int upper = (256 - a) * p[0] + a * p[1],
            lower = (256 - a) * p[image.stride] + a * p[image.stride + 1];
  return 9 * ((256 - b) * upper + b * lower) >> 16;
}

/// Samples the grid turned into the direction. \return the mean deviation of the samples inside the circle.
int sample(const ImageView& image, int x, int y, PatchScale scale, Vec2 direction,
           std::int16_t (&sums)[kSide * kSide]) {
  const bool is_half = scale == PatchScale::half;
  const int spacing = is_half ? kTuning.spacing_quarter_px : 2 * kTuning.spacing_quarter_px;  // px / 8
  const int c = static_cast<int>(512 * direction.x), s = static_cast<int>(512 * direction.y);
  int total = 0, count = 0;
  for (int k = 0; k < kSide * kSide; ++k) {
    if (!is_inside(k)) continue;
    const int gx = spacing * (k % kSide - kHalf), gy = spacing * (k / kSide - kHalf);
    const int px = 4096 * x + gx * c - gy * s, py = 4096 * y + gx * s + gy * c;
    const int sum = is_half ? bilinear_sum(image, px, py) : box_sum(image, px, py);
    sums[k] = static_cast<std::int16_t>(sum);
    total += sum;
    ++count;
  }
  const int mean = total / count;
  int deviation = 0;
  for (int k = 0; k < kSide * kSide; ++k)
    if (is_inside(k)) deviation += sums[k] > mean ? sums[k] - mean : mean - sums[k];
  return deviation / count;
}

/// A word of the processor, of which bits are counted at once: groups of 4, 8 and 16 bits hold the number of their own bits
/// (Warren 2012, chapter 5).
using Word = std::size_t;
constexpr Word kAll = std::numeric_limits<Word>::max();

Word counts_of_nibbles(Word x) {
  x -= x >> 1 & kAll / 3;
  return (x & kAll / 5) + (x >> 2 & kAll / 5);
}

Word in_bytes(Word nibbles) {
  return (nibbles & kAll / 17) + (nibbles >> 4 & kAll / 17);
}

}  // namespace

bool describe(const ImageView& image, int x, int y, PatchScale scale, Descriptor* descriptor) {
  const int reach = descriptor_reach(scale);
  if (x < reach || y < reach || x >= image.width - reach || y >= image.height - reach) return false;
  Vec2 direction;
  std::int16_t sums[kSide * kSide];
  const int radius = scale == PatchScale::half ? (kRadius + 1) / 2 : kRadius;
  if (!find_direction(image, x, y, radius, &direction)) return false;
  const int deviation = sample(image, x, y, scale, direction, sums);
  if (deviation < kTuning.flat_sum) return false;
  const int least = kTuning.least_difference * deviation / 256;
  descriptor->direction = direction;
  for (int word = 0; word < kDescriptorWords; ++word) {
    std::uint32_t bits = 0;
    for (int k = 32 * word; k < 32 * word + 32; ++k)
      bits = bits << 1 | (sums[kPairTable.first[k]] + least < sums[kPairTable.second[k]] ? 1u : 0u);
    descriptor->bits[word] = bits;
  }
  return true;
}

int distance_of(const std::uint32_t (&a)[kDescriptorWords], const std::uint32_t (&b)[kDescriptorWords]) {
  constexpr std::size_t kBytes = kDescriptorWords * sizeof(std::uint32_t), kWords = kBytes / sizeof(Word);
  Word x[kWords], y[kWords], sum = 0;
  std::memcpy(x, a, kBytes);
  std::memcpy(y, b, kBytes);
  for (std::size_t k = 0; k < kWords; k += 2)
    sum += in_bytes(counts_of_nibbles(x[k] ^ y[k]) + counts_of_nibbles(x[k + 1] ^ y[k + 1]));
  constexpr int kTop = std::numeric_limits<Word>::digits - 16;
  return static_cast<int>(((sum & kAll / 257) + (sum >> 8 & kAll / 257)) * (kAll / 65535) >> kTop);
}

}  // namespace pliant
