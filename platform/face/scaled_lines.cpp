#include "face/scaled_lines.hpp"

#include "base/integers.hpp"

namespace pliant {

namespace {

constexpr int kSamples = 4;  // a side, for large ratios

}  // namespace

ScaledLines::ScaledLines(const FrameView& frame, int ratio)
    : frame_(frame),
      ratio_(ratio),
      width_(frame.width * kUnit / ratio),
      height_(frame.height * kUnit / ratio) {
  PLIANT_ASSERT(check(frame) == Status::ok && frame.width <= kLargestFramePx && frame.height <= kLargestFramePx);
  PLIANT_ASSERT(ratio >= kUnit && ratio <= kLargestRatio);
}

void ScaledLines::read(int x, int y, int count, std::uint32_t* scratch, std::uint8_t* out) const {
  PLIANT_ASSERT(width_ > 0 && height_ > 0);
  const int inside_y = within(y, 0, height_ - 1);
  // The pixels inside, at least one; those beyond the border are copies.
  const int first = within(x, 0, width_ - 1), last = within(x + count - 1, 0, width_ - 1);
  std::uint8_t* const inside = out + within(first - x, 0, count - 1);
  if (ratio_ == kUnit)
    copy(first, inside_y, last - first + 1, inside);
  else if (ratio_ < kLargestAreaRatio)
    average(first, inside_y, last - first + 1, scratch, inside);
  else
    sample(first, inside_y, last - first + 1, inside);
  const std::uint8_t left = *inside, right = inside[last - first];
  for (int k = 0; k < count && x + k < first; ++k) out[k] = left;
  for (int k = larger(last + 1 - x, 0); k < count; ++k) out[k] = right;
}

void ScaledLines::copy(int x, int y, int count, std::uint8_t* out) const {
  const std::uint8_t* const from = line(y) + x * frame_.pixel_step_bytes;
  for (int k = 0; k < count; ++k) out[k] = from[k * frame_.pixel_step_bytes];
}

// Adds the pixels of one line of the frame, each times the part of it that an output pixel covers, in 1/kUnit.
void ScaledLines::add_line(const std::uint8_t* from, int x, int count, std::uint32_t weight,
                           std::uint32_t* sums) const {
  const int step = frame_.pixel_step_bytes;
  constexpr unsigned kOne = kUnit;
  const unsigned ratio = static_cast<unsigned>(ratio_);
  unsigned begin = static_cast<unsigned>(x) * ratio;
  for (int k = 0; k < count; ++k) {
    const unsigned end = begin + ratio;
    const std::uint8_t* p = from + static_cast<int>(begin / kOne) * step;
    const std::uint8_t* const last = from + static_cast<int>(end / kOne) * step;
    unsigned whole = 0;
    const unsigned part = *p * (kOne - begin % kOne);
    for (p += step; p < last; p += step) whole += *p;
    const unsigned rest = end % kOne;
    sums[k] += weight * (part + whole * kOne + (rest != 0 ? *last * rest : 0));
    begin = end;
  }
}

void ScaledLines::average(int x, int y, int count, std::uint32_t* sums, std::uint8_t* out) const {
  for (int k = 0; k < count; ++k) sums[k] = 0;
  const int begin = y * ratio_, end = begin + ratio_;
  for (int j = begin / kUnit; j * kUnit < end; ++j) {
    const int covered = smaller(end, (j + 1) * kUnit) - larger(begin, j * kUnit);
    add_line(line(j), x, count, static_cast<std::uint32_t>(covered), sums);
  }
  // Sums are at most 255 * 2^20. The reciprocal of the area has 32 bits behind the point, its rounding adds at most 1/16.
  const auto area = static_cast<std::uint32_t>(ratio_) * static_cast<std::uint32_t>(ratio_);
  const std::uint32_t by = 0xffffffffu / area;
  for (int k = 0; k < count; ++k)
    out[k] = static_cast<std::uint8_t>((static_cast<std::uint64_t>(sums[k] + area / 2) * by) >> 32);
}

void ScaledLines::sample(int x, int y, int count, std::uint8_t* out) const {
  const int step = frame_.pixel_step_bytes;
  const std::uint8_t* lines[kSamples];
  for (int j = 0; j < kSamples; ++j)
    lines[j] = line((y * ratio_ + (2 * j + 1) * ratio_ / (2 * kSamples)) / kUnit);
  for (int k = 0; k < count; ++k) {
    int sum = kSamples * kSamples / 2;
    for (int i = 0; i < kSamples; ++i) {
      const int column = ((x + k) * ratio_ + (2 * i + 1) * ratio_ / (2 * kSamples)) / kUnit;
      for (const std::uint8_t* l : lines) sum += l[column * step];
    }
    out[k] = static_cast<std::uint8_t>(sum / (kSamples * kSamples));
  }
}

}  // namespace pliant
