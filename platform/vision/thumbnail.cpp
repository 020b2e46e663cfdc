#include "vision/thumbnail.hpp"

#include "base/integers.hpp"
#include "base/wide_vectors.hpp"
#include "vision/halfwords.hpp"

namespace pliant {

namespace {

/// Tuning of levelled rows. Each constant: unit, reason, experiment.
struct LevelTuning {
  /// Mean of every row, grey levels. A pixel may be 2.7 times as bright as its row before it is cut. Round value, not tuned.
  int mean = 96;
  /// Grey levels added to every pixel, so that the noise of a dark row does not grow without bound. Round value, not tuned.
  int offset = 16;
};
constexpr LevelTuning kLevel{};
constexpr int kGainBits = 8;  // fraction of a gain, which is at most mean / offset

}  // namespace

#if PLIANT_HAS_HALFWORDS

namespace {

// Sum of `n` pixels of a row, four at a time where they are contiguous.
unsigned sum_of(const std::uint8_t* row, int n, int pixel_step) {
  unsigned sum = 0;
  for (; pixel_step == 1 && n >= 4; n -= 4, row += 4) sum = patch::add_bytes(sum, patch::load_bytes(row));
  for (; n > 0; --n, row += pixel_step) sum += *row;
  return sum;
}

}  // namespace

void make_thumbnail(const FrameView& frame, int factor, std::uint16_t*, std::uint8_t* out) {
  PLIANT_ASSERT(check(frame) == Status::ok && factor >= 1 && factor <= 64 && (factor & (factor - 1)) == 0);
  const int columns = frame.width / factor, rows = frame.height / factor, row_step = factor > 1 ? 2 : 1;
  const unsigned pixels = static_cast<unsigned>(factor * (factor / row_step));
  const std::uint8_t* band = frame.data;
  for (int y = 0; y < rows; ++y, band += static_cast<std::size_t>(factor) * frame.stride_bytes)
    for (int x = 0; x < columns; ++x) {
      const std::uint8_t* row = band + x * factor * frame.pixel_step_bytes;
      unsigned sum = pixels / 2;
      for (int k = 0; k < factor;
           k += row_step, row += row_step * static_cast<std::ptrdiff_t>(frame.stride_bytes))
        sum += sum_of(row, factor, frame.pixel_step_bytes);
      *out++ = static_cast<std::uint8_t>(sum / pixels);
    }
}

#else

namespace {

// Frames usually have contiguous pixels. The compiler vectorises this separate loop for them.
PLIANT_WIDE_VECTORS
void add_row(const std::uint8_t* __restrict row, int width, std::uint16_t* __restrict line) {
  for (int x = 0; x < width; ++x) line[x] = static_cast<std::uint16_t>(line[x] + row[x]);
}

void add_packed_row(const std::uint8_t* row, int pixel_step, int width, std::uint16_t* line) {
  for (int x = 0; x < width; ++x) line[x] = static_cast<std::uint16_t>(line[x] + row[x * pixel_step]);
}

/// Means of `factor` neighbours.
inline void average(const std::uint16_t* __restrict line, int factor, int columns, unsigned shift,
                    std::uint8_t* __restrict out) {
  for (int x = 0; x < columns; ++x) {
    unsigned sum = (1u << shift) / 2;
    for (int k = 0; k < factor; ++k) sum += line[x * factor + k];
    out[x] = static_cast<std::uint8_t>(sum >> shift);
  }
}

/// The same; the factors of frames of 200 to 800 px have loops of their own, which take a third of the time.
PLIANT_WIDE_VECTORS
void average_row(const std::uint16_t* line, int factor, int columns, unsigned shift, std::uint8_t* out) {
  if (factor == 4)
    average(line, 4, columns, shift, out);
  else if (factor == 8)
    average(line, 8, columns, shift, out);
  else
    average(line, factor, columns, shift, out);
}

}  // namespace

void make_thumbnail(const FrameView& frame, int factor, std::uint16_t* line, std::uint8_t* out) {
  PLIANT_ASSERT(check(frame) == Status::ok && factor >= 1 && factor <= 64 && (factor & (factor - 1)) == 0);
  const int columns = frame.width / factor, rows = frame.height / factor, width = columns * factor;
  const int row_step = factor > 1 ? 2 : 1;
  unsigned shift = 0;
  while ((1 << shift) < factor * (factor / row_step)) ++shift;
  const std::uint8_t* block = frame.data;
  for (int y = 0; y < rows;
       ++y, block += static_cast<std::size_t>(factor) * frame.stride_bytes, out += columns) {
    for (int x = 0; x < width; ++x) line[x] = 0;
    for (int k = 0; k < factor; k += row_step) {
      const std::uint8_t* row = block + static_cast<std::size_t>(k) * frame.stride_bytes;
      if (frame.pixel_step_bytes == 1)
        add_row(row, width, line);
      else
        add_packed_row(row, frame.pixel_step_bytes, width, line);
    }
    average_row(line, factor, columns, shift, out);
  }
}

#endif

PLIANT_WIDE_VECTORS
void level_rows(std::uint8_t* pixels, int columns, int rows) {
  for (std::uint8_t* const end = pixels + columns * rows; pixels != end; pixels += columns) {
    int sum = 0;
    for (int x = 0; x < columns; ++x) sum += pixels[x];
    const int gain = (kLevel.mean << kGainBits) * columns / (sum + kLevel.offset * columns);
    for (int x = 0; x < columns; ++x)
      pixels[x] = static_cast<std::uint8_t>(smaller(gain * (pixels[x] + kLevel.offset) >> kGainBits, 255));
  }
}

}  // namespace pliant
