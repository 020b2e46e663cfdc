// Where templates come from: a window of an image, or the stored surroundings of an anchor, resampled under a
// warp. A template's centre is always a whole pixel of its source, so that an unwarped one needs no
// interpolation at all; the caller accounts for the rest of the position.
#include <cstring>

#include "patch_work.hpp"

namespace pliant::patch {
namespace {

int clamped(int i, int n) {
  return i < 0 ? 0 : i >= n ? n - 1 : i;
}

int rounded(float x) {
  return static_cast<int>(x + 16384.5f) - 16384;
}

// Rows and columns [left, right) x [top, bottom) of the window count.
void set_mask(int left, int top, int right, int bottom, Work& work) {
  const int w = work.window, stride = lanes(w);
  std::memcpy(work.plain.m, work.all, static_cast<std::size_t>(w * stride) * sizeof(std::int16_t));
  if (left <= 0 && top <= 0 && right >= w && bottom >= w) return;
  for (int y = 0; y < w; ++y)
    for (int x = 0; x < w; ++x)
      if (x < left || x >= right || y < top || y >= bottom) work.plain.m[y * stride + x] = 0;
}

// Samples a stored square along straight lines, in 16.16 fixed point.
class Resampler {
 public:
  Resampler(const Surround& around, const std::uint8_t* pixels, int side, const Mat2& m)
      : around_(around),
        pixels_(pixels),
        side_(side),
        a_(fixed(m.a)),
        b_(fixed(m.b)),
        c_(fixed(m.c)),
        d_(fixed(m.d)) {}

  // Position of the block's pixel (i, j) from the centre; true if all four pixels around it are inside the
  // image.
  bool seek(int i, int j) {
    const int half = side_ / 2 << kBits;
    x_ = half + a_ * i + b_ * j;
    y_ = half + c_ * i + d_ * j;
    const bool is_inside_x = clamp_to(around_.left, around_.right, x_);
    const bool is_inside_y = clamp_to(around_.top, around_.bottom, y_);
    return is_inside_x && is_inside_y;
  }
  std::int16_t value() const {
    const std::uint8_t* p = pixels_ + (y_ >> kBits) * side_ + (x_ >> kBits);
    const int fx = (x_ >> (kBits - 8)) & 255, fy = (y_ >> (kBits - 8)) & 255;
    const int upper = p[0] * (256 - fx) + p[1] * fx;
    const int lower = p[side_] * (256 - fx) + p[side_ + 1] * fx;
    return static_cast<std::int16_t>(((upper * (256 - fy) + lower * fy + 2048) >> 12) - kGreyOffset);
  }

 private:
  static constexpr int kBits = 16;
  static int fixed(float v) { return static_cast<int>(v * (1 << kBits)); }
  static bool clamp_to(int low, int end, int& v) {
    const int lo = low << kBits, hi = ((end - 1) << kBits) - 1;
    const int inside = v < lo ? lo : v > hi ? hi : v;
    const bool was_inside = inside == v;
    v = inside;
    return was_inside;
  }

  const Surround& around_;
  const std::uint8_t* pixels_;
  int side_, a_, b_, c_, d_, x_ = 0, y_ = 0;
};

void load_warped(const Surround& around, const std::uint8_t* pixels, int side, const Mat2& to_anchor,
                 Work& work) {
  const int w = work.window, r = w / 2, stride = block_stride(w);
  set_mask(0, 0, w, w, work);
  Resampler from(around, pixels, side, to_anchor);
  for (int y = 0; y < w + 2; ++y)
    for (int x = 0; x < w + 2; ++x) {
      const bool is_inside = from.seek(x - r - 1, y - r - 1);
      work.block[y * stride + x] = from.value();
      if (!is_inside && x > 0 && x <= w && y > 0 && y <= w) work.plain.m[(y - 1) * lanes(w) + x - 1] = 0;
    }
}

}  // namespace

Pixels readable(const ImageView& image, int left, int top, int rows, int columns, std::uint8_t* scratch) {
  const std::ptrdiff_t stride = image.stride;
  // Columns past a row's end are read only where they do not count; so they need only be memory of the image.
  const std::ptrdiff_t end = (top + rows - 1) * stride + left + columns;
  if (left >= 0 && top >= 0 && top + rows <= image.height && end <= (image.height - 1) * stride + image.width)
    return {image.data + top * stride + left, stride};
  for (int y = 0; y < rows; ++y) {
    const std::uint8_t* row = image.data + clamped(top + y, image.height) * stride;
    for (int x = 0; x < columns; ++x) scratch[y * columns + x] = row[clamped(left + x, image.width)];
  }
  return {scratch, columns};
}

void load_template(const ImageView& image, int left, int top, GreyRange range, Work& work) {
  const int w = work.window;
  set_mask(-left, -top, image.width - left, image.height - top, work);
  load_block(readable(image, left - 1, top - 1, w + 2, block_stride(w), work.bytes), w, work.block);
  make_template(work.block, w, range.lowest, range.highest, work.plain);
}

void load_template(const Surround& around, const std::uint8_t* pixels, int side, const Mat2* to_anchor,
                   GreyRange range, Work& work) {
  const int w = work.window, first = side / 2 - w / 2;
  if (to_anchor != nullptr) {
    load_warped(around, pixels, side, *to_anchor, work);
  } else {
    set_mask(around.left - first, around.top - first, around.right - first, around.bottom - first, work);
    load_block({pixels + (first - 1) * side + first - 1, side}, w, work.block);
  }
  make_template(work.block, w, range.lowest, range.highest, work.plain);
}

void store_surround(const ImageView& image, Vec2 x, int side, Surround& around, std::uint8_t* pixels) {
  const int cx = rounded(x.x), cy = rounded(x.y), left = cx - side / 2, top = cy - side / 2;
  around.offset = {x.x - static_cast<float>(cx), x.y - static_cast<float>(cy)};
  around.left = static_cast<std::int16_t>(left < 0 ? -left : 0);
  around.top = static_cast<std::int16_t>(top < 0 ? -top : 0);
  around.right = static_cast<std::int16_t>(image.width - left < side ? image.width - left : side);
  around.bottom = static_cast<std::int16_t>(image.height - top < side ? image.height - top : side);
  for (int y = 0; y < side; ++y) {
    const std::uint8_t* row = image.data + std::ptrdiff_t{clamped(top + y, image.height)} * image.stride;
    for (int k = 0; k < side; ++k) pixels[y * side + k] = row[clamped(left + k, image.width)];
  }
}

}  // namespace pliant::patch
