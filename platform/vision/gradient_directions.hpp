#pragma once
// Normalised gradients: the direction in which grey levels rise at each pixel, and how clearly. Gain and bias of the
// light do not change them.
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/geometry.hpp"
#include "pliant/pyramid.hpp"

namespace pliant {

/// A gradient relative to those around it: of length 127 if it stands alone, shorter among others.
struct GradientDirection {
  std::int16_t x, y;
};

inline int dot(GradientDirection a, GradientDirection b) {
  return a.x * b.x + a.y * b.y;
}

/// Computes gradient directions of images with a limited number of pixels. Bytes: 4 a pixel, and 4 a column.
class GradientDirectionFilter {
 public:
  void lay_out(Arena& arena, int pixels, int columns);

  /// Writes one direction a pixel, rows without padding; zero along the image's border. A gradient is compared with
  /// those up to `reach` px around it. Precondition: the image fits the layout. Cost: a square root and about 40
  /// operations a pixel.
  void compute(const ImageView& image, int reach, GradientDirection* out);

 private:
  void compute_gradients(const ImageView& image, GradientDirection* out);
  void sum_rows(int width, int height, int reach);

  int pixels_ = 0, columns_ = 0;
  std::uint16_t *length_ = nullptr, *row_sum_ = nullptr;
  std::uint32_t* column_sum_ = nullptr;
};

/// Sums of the squared lengths of gradient directions over any rectangle in constant time (a summed-area table).
class EnergyTable {
 public:
  /// For images of up to width x height pixels. Bytes: 4 a pixel.
  void lay_out(Arena& arena, int width, int height);
  void build(const GradientDirection* directions, int width, int height);
  /// The sum over [x0, x1) x [y0, y1).
  std::uint32_t sum(int x0, int y0, int x1, int y1) const {
    const std::uint32_t *top = sums_ + y0 * stride_, *bottom = sums_ + y1 * stride_;
    return bottom[x1] - bottom[x0] - top[x1] + top[x0];
  }

 private:
  int capacity_ = 0, stride_ = 0;
  std::uint32_t* sums_ = nullptr;
};

}  // namespace pliant
