// The noise of a picture (docs/algorithms.md, section 7.22).
#include "vision/noise.hpp"

#include "base/integers.hpp"
#include "pliant/geometry.hpp"

namespace pliant {

namespace {

constexpr const NoiseTuning& kTuning = kNoiseTuning;
/// Deviation of the response over that of the noise, sqrt(36), times the median of |x| of a normal x over its deviation.
constexpr float kMedianOverNoise = 6 * 0.6745f;

/// [1 -2 1] along both axes, at a pixel that is not at the border.
int response(const std::uint8_t* at, std::ptrdiff_t down, std::ptrdiff_t right) {
  const auto row = [right](const std::uint8_t* p) { return p[-right] - 2 * p[0] + p[right]; };
  const int r = row(at - down) - 2 * row(at) + row(at + down);
  return r < 0 ? -r : r;
}

}  // namespace

int noise_places(int side, int step) {
  return side < 3 ? 0 : (side - 3) / step + 1;
}

int noise_step(int width, int height, int most_places) {
  int step = 1;
  while (noise_places(width, step) * noise_places(height, step) > most_places) step += 2;
  return step;
}

FrameNoise noise_of(const FrameView& frame, int most_places) {
  const auto down = static_cast<std::ptrdiff_t>(frame.stride_bytes);
  const std::ptrdiff_t right = frame.pixel_step_bytes;
  const int step = noise_step(frame.width, frame.height, most_places);
  std::uint16_t of_response[256] = {};
  int places = 0, sum = 0, squares = 0;
  for (int y = 1; y + 1 < frame.height; y += step)
    for (int x = 1; x + 1 < frame.width; x += step) {
      const std::uint8_t* const at = frame.data + y * down + x * right;
      if (*at < kTuning.darkest || *at > kTuning.brightest) continue;
      ++of_response[smaller(response(at, down, right), 255)];
      sum += *at;
      squares += *at * *at;
      ++places;
    }
  if (kTuning.least_divisor * places < most_places) return {};
  int median = 0;
  for (int below = of_response[0]; 2 * below < places; below += of_response[median]) ++median;
  const float count = static_cast<float>(places), mean = static_cast<float>(sum) / count;
  return {static_cast<float>(median) / kMedianOverNoise,
          square_root(static_cast<float>(squares) / count - mean * mean)};
}

}  // namespace pliant
