#pragma once
/// \file noise_filter.hpp
/// Smooths frames with much noise (docs/algorithms.md, section 7.22).
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/frame.hpp"

namespace pliant {

/// Smooths noisy frames of one size, at least 4 x 4 pixels.
class NoiseFilter {
 public:
  /// Bytes: width * height, and five lines of 2 bytes a pixel.
  void lay_out(Arena& arena, int width, int height);

  /// The frame itself, if it has little noise. Else a copy, smoothed by the binomial [1 4 6 4 1]/16 along rows and columns, valid
  /// until the next call. Cost: the places, and 14 additions a pixel of a noisy frame.
  const FrameView& smoothed(const FrameView& frame);
  /// The next frame is of another stream.
  void forget() { is_smoothing_ = false; }

 private:
  void smooth(const FrameView& frame);

  std::uint8_t* pixels_ = nullptr;
  std::uint16_t* lines_ = nullptr;
  FrameView copy_;
  bool is_smoothing_ = false;  // the last frame was noisy
};

}  // namespace pliant
