// Binomial smoothing of noisy frames (docs/algorithms.md, section 7.22).
#include "vision/noise_filter.hpp"

#include "base/integers.hpp"
#include "base/wide_vectors.hpp"
#include "vision/binomial.hpp"
#include "vision/noise.hpp"
#include "vision/noise_tuning.hpp"

namespace pliant {

namespace {

constexpr const NoiseTuning& kTuning = kNoiseTuning;
constexpr int kTaps = 5;

PLIANT_WIDE_VECTORS
void smooth_planar(const std::uint8_t* __restrict row, int width, std::uint16_t* __restrict out) {
  for (int x = 2; x + 2 < width; ++x)
    out[x] = static_cast<std::uint16_t>(binomial_sum(row[x - 2], row[x - 1], row[x], row[x + 1], row[x + 2]));
}

/// Along a line. The border's pixels count for those beyond.
void smooth_line(const std::uint8_t* row, int step, int width, std::uint16_t* out) {
  const auto smooth_at = [&](int x) {
    const auto pixel = [&](int k) { return row[within(x + k, 0, width - 1) * step]; };
    out[x] = static_cast<std::uint16_t>(binomial_sum(pixel(-2), pixel(-1), pixel(0), pixel(1), pixel(2)));
  };
  if (step == 1)
    smooth_planar(row, width, out);
  else
    for (int x = 2; x + 2 < width; ++x) smooth_at(x);
  const int border[] = {0, 1, width - 2, width - 1};
  for (const int x : border) smooth_at(x);
}

using Lines = const std::uint16_t* [kTaps];

PLIANT_WIDE_VECTORS
void smooth_columns(const Lines& line, int width, std::uint8_t* __restrict out) {
  const std::uint16_t *const a = line[0], *const b = line[1], *const c = line[2], *const d = line[3],
                             *const e = line[4];
  for (int x = 0; x < width; ++x) out[x] = binomial_mean(a[x], b[x], c[x], d[x], e[x]);
}

}  // namespace

void NoiseFilter::lay_out(Arena& arena, int width, int height) {
  const std::size_t w = static_cast<std::size_t>(width), h = static_cast<std::size_t>(height);
  pixels_ = arena.take<std::uint8_t>(w * h);
  lines_ = arena.take<std::uint16_t>(kTaps * w);
}

const FrameView& NoiseFilter::smoothed(const FrameView& frame) {
  const FrameNoise of = noise_of(frame);
  is_smoothing_ = of.noise >= kTuning.least_noise &&
                  of.noise >= (is_smoothing_ ? kTuning.still_noisy : kTuning.noisy) * of.contrast;
  if (!is_smoothing_) return frame;
  smooth(frame);
  copy_ = frame;
  copy_.data = pixels_;
  copy_.stride_bytes = static_cast<std::size_t>(frame.width);
  copy_.pixel_step_bytes = 1;
  return copy_;
}

/// Five lines of sums at a time, in turn.
void NoiseFilter::smooth(const FrameView& frame) {
  const int width = frame.width, height = frame.height;
  const auto line = [&](int y) {
    return lines_ + static_cast<std::ptrdiff_t>(within(y, 0, height - 1) % kTaps) * width;
  };
  const auto read = [&](int y) {
    smooth_line(frame.data + static_cast<std::size_t>(y) * frame.stride_bytes, frame.pixel_step_bytes, width,
                line(y));
  };
  for (int y = 0; y < 2; ++y) read(y);
  for (int y = 0; y < height; ++y) {
    if (y + 2 < height) read(y + 2);
    const Lines lines = {line(y - 2), line(y - 1), line(y), line(y + 1), line(y + 2)};
    smooth_columns(lines, width, pixels_ + static_cast<std::ptrdiff_t>(y) * width);
  }
}

}  // namespace pliant
