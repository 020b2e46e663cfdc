#pragma once
// Which way grey values rise at each pixel, and how clearly: what a lamp or a camera's gain does not change.
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/geometry.hpp"
#include "pliant/pyramid.hpp"

namespace pliant {

/// A gradient against those around it: length 127 for one that stands alone, less in the middle of others.
struct Direction {
  std::int16_t x, y;
};

inline int dot(Direction a, Direction b) {
  return a.x * b.x + a.y * b.y;
}

/// Works on pictures of up to so many pixels. Bytes: 4 a pixel, and 4 a column.
class DirectionFinder {
 public:
  void lay_out(Arena& arena, int pixels, int columns);

  /// One direction a pixel, rows without padding; zero along the picture's rim. `reach` px is how far around a gradient
  /// is compared. Cost: a square root and about 40 operations a pixel.
  void find(const ImageView& image, int reach, Direction* out);

 private:
  void find_gradients(const ImageView& image, Direction* out);
  void sum_around(int width, int height, int reach);

  std::uint16_t *length_ = nullptr, *row_sum_ = nullptr;
  std::uint32_t* column_sum_ = nullptr;
};

/// A frame to be looked at `ratio` (at most 1, or little more) times its size: grey values between pixels, of the level that
/// is not much finer.
class PictureAt {
 public:
  PictureAt(const Pyramid& pyramid, float ratio);
  /// \param x  px of the frame; outside it is as its rim.
  std::uint8_t grey(Vec2 x) const;

 private:
  ImageView image_;
  float share_ = 1;  // of the level to the frame
};

}  // namespace pliant
