#include "face/picture_noise.hpp"

#include <cstddef>
#include <cstring>

#include "base/wide_vectors.hpp"
#include "pliant/pyramid.hpp"
#include "pliant/status.hpp"
#include "vision/noise.hpp"
#include "vision/noise_tuning.hpp"

namespace pliant {

namespace {

PLIANT_WIDE_VECTORS
void add_lines(const std::uint8_t* __restrict above, const std::uint8_t* __restrict line,
               const std::uint8_t* __restrict below, int side, std::uint16_t* __restrict out) {
  for (int x = 0; x < side; ++x) out[x] = static_cast<std::uint16_t>(above[x] + 2 * line[x] + below[x]);
}

/// \param sums  of `add_lines`, with one more on each side.
PLIANT_WIDE_VECTORS
void smooth_sums(const std::uint16_t* __restrict sums, int side, std::uint8_t* __restrict out) {
  for (int x = 0; x < side; ++x)
    out[x] = static_cast<std::uint8_t>((sums[x] + 2 * sums[x + 1] + sums[x + 2] + 8) >> 4);
}

/// In place.
void smooth(std::uint8_t* pixels, int side) {
  const auto bytes = static_cast<std::size_t>(side);
  std::uint8_t above[kMostPictureSide];  // the line above as it was
  std::uint16_t sums[kMostPictureSide + 2];
  std::memcpy(above, pixels, bytes);
  std::uint8_t* line = pixels;
  for (int y = 0; y < side; ++y, line += side) {
    add_lines(above, line, y + 1 < side ? line + side : line, side, sums + 1);
    sums[0] = sums[1];
    sums[side + 1] = sums[side];
    std::memcpy(above, line, bytes);
    smooth_sums(sums, side, line);
  }
}

}  // namespace

void smooth_noise(std::uint8_t* pixels, int side, int most_places) {
  PLIANT_ASSERT(side >= 1 && side <= kMostPictureSide);
  const FrameNoise of = noise_of(frame_of(ImageView{pixels, side, side, side}), most_places);
  if (of.noise < kNoiseTuning.least_noise) return;
  if (of.noise >= kPictureNoiseTuning.noisy * of.contrast) smooth(pixels, side);
  if (of.noise >= kPictureNoiseTuning.very_noisy * of.contrast) smooth(pixels, side);
}

}  // namespace pliant
