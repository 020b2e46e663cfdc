// Where templates come from: a window of an image, or the stored surroundings of an anchor, resampled under a
// warp. A template's centre is always a whole pixel of its source, so that an unwarped one needs no
// interpolation at all; the caller accounts for the rest of the position.
#include <cstring>

#include "vision/patch_work.hpp"

namespace pliant::patch {
namespace {

int clamped(int i, int n) {
  return i < 0 ? 0 : i >= n ? n - 1 : i;
}

int rounded(float x) {
  return static_cast<int>(x + 16384.5f) - 16384;
}

// Copies `columns` pixels of a row from column `left` on, its ends repeated beyond them.
void copy_row(const std::uint8_t* row, int width, int left, int columns, std::uint8_t* out) {
  const int before = left < 0 ? (-left < columns ? -left : columns) : 0;
  const int end = width - left < columns ? (width - left > before ? width - left : before) : columns;
  std::memset(out, row[0], static_cast<std::size_t>(before));
  std::memcpy(out + before, row + left + before, static_cast<std::size_t>(end - before));
  std::memset(out + end, row[width - 1], static_cast<std::size_t>(columns - end));
}

void copy_square(const ImageView& image, int left, int top, int rows, int columns, std::uint8_t* out) {
  const bool is_whole = left >= 0 && left + columns <= image.width;
  for (int y = 0; y < rows; ++y, out += columns) {
    const std::uint8_t* row = image.data + std::ptrdiff_t{clamped(top + y, image.height)} * image.stride;
    if (is_whole) std::memcpy(out, row + left, static_cast<std::size_t>(columns));
    if (!is_whole) copy_row(row, image.width, left, columns, out);
  }
}

// The mask of [left, right) x [top, bottom) of the window.
const std::int16_t* mask_of(int left, int top, int right, int bottom, Work& work) {
  const int w = work.window;
  if (left <= 0 && top <= 0 && right >= w && bottom >= w) return work.all;
  std::int16_t row[kMaxWindow] = {};
  for (int x = left < 0 ? 0 : left; x < (right < w ? right : w); ++x) row[x] = 1;
  for (int y = 0; y < w; ++y) {
    std::int16_t* out = work.part + y * w;
    for (int x = 0; x < w; ++x) out[x] = y >= top && y < bottom ? row[x] : std::int16_t{0};
  }
  return work.part;
}

constexpr int kBits = kLatticeBits;

struct FixedPosition {
  int x, y;
};

std::int16_t bilinear(const std::uint8_t* pixels, int side, int x, int y) {
  const std::uint8_t* p = pixels + (y >> kBits) * side + (x >> kBits);
  const int fx = (x >> (kBits - 8)) & 255, fy = (y >> (kBits - 8)) & 255;
  const int upper = p[0] * 256 + (p[1] - p[0]) * fx;
  const int lower = p[side] * 256 + (p[side + 1] - p[side]) * fx;
  return static_cast<std::int16_t>(((upper * 256 + (lower - upper) * fy + 2048) >> 12) - kGreyOffset);
}

FixedPosition at(const Lattice& l, int i, int j) {
  return {l.x + l.across_x * i + l.down_x * j, l.y + l.across_y * i + l.down_y * j};
}

// Where the block's pixels come from in a stored square.
Lattice lattice_of(const Mat2& m, int side, int radius) {
  const auto fixed = [](float v) { return static_cast<int>(v * (1 << kBits)); };
  const int half = side / 2 << kBits;
  Lattice l{half, half, fixed(m.a), fixed(m.c), fixed(m.b), fixed(m.d)};
  l.x -= (l.across_x + l.down_x) * radius;
  l.y -= (l.across_y + l.down_y) * radius;
  return l;
}

// Where all four pixels around a position lie inside the image: [low, high] either way.
struct Bounds {
  FixedPosition low, high;

  bool contains(FixedPosition p) const {
    return p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y;
  }
  FixedPosition clamped(FixedPosition p) const {
    const auto within = [](int v, int lo, int hi) { return v < lo ? lo : v > hi ? hi : v; };
    return {within(p.x, low.x, high.x), within(p.y, low.y, high.y)};
  }
};

// Whatever leaves the stored square is masked out; its place is taken by the nearest stored value.
const std::int16_t* load_ragged(const Lattice& lattice, const Bounds& bounds, const std::uint8_t* pixels,
                                int side, Work& work) {
  const int w = work.window, stride = block_stride(w);
  for (int y = 0; y < w + 2; ++y)
    for (int x = 0; x < w + 2; ++x) {
      const FixedPosition exact = at(lattice, x, y), nearest = bounds.clamped(exact);
      work.block[y * stride + x] = bilinear(pixels, side, nearest.x, nearest.y);
      if (x > 0 && x <= w && y > 0 && y <= w) work.part[(y - 1) * w + x - 1] = bounds.contains(exact) ? 1 : 0;
    }
  return work.part;
}

const std::int16_t* load_warped(const Surround& around, const std::uint8_t* pixels, int side,
                                const Mat2& to_anchor, Work& work) {
  const int w = work.window, last = w + 1;
  const Lattice l = lattice_of(to_anchor, side, w / 2 + 1);
  const Bounds bounds{{around.left << kBits, around.top << kBits},
                      {((around.right - 1) << kBits) - 1, ((around.bottom - 1) << kBits) - 1}};
  if (!bounds.contains(at(l, 0, 0)) || !bounds.contains(at(l, last, 0)) || !bounds.contains(at(l, 0, last)) ||
      !bounds.contains(at(l, last, last)))
    return load_ragged(l, bounds, pixels, side, work);
  sample_lattice(pixels, side, l, w, work.scratch, work.block);
  return work.all;
}

}  // namespace

void load_block(const ImageView& image, int left, int top, Work& work) {
  const int rows = block_rows(work.window), columns = block_stride(work.window);
  const bool is_whole = left >= 0 && top >= 0 && left + columns <= image.width && top + rows <= image.height;
  if (is_whole)
    return load_block(image.data + std::ptrdiff_t{top} * image.stride + left, image.stride, work.window,
                      work.block);
  copy_square(image, left, top, rows, columns, work.bytes);
  load_block(work.bytes, columns, work.window, work.block);
}

void load_template(const ImageView& image, int left, int top, GreyRange range, Work& work) {
  const int w = work.window;
  const std::int16_t* mask = mask_of(-left, -top, image.width - left, image.height - top, work);
  load_block(image, left - 1, top - 1, work);
  make_template(work.block, mask, w, range.lowest, range.highest, work.scratch, work.plain);
}

void load_template(const Surround& around, const std::uint8_t* pixels, int side, const Mat2* to_anchor,
                   GreyRange range, Work& work) {
  const int w = work.window, first = side / 2 - w / 2;
  const std::int16_t* mask;
  if (to_anchor != nullptr) {
    mask = load_warped(around, pixels, side, *to_anchor, work);
  } else {
    mask =
        mask_of(around.left - first, around.top - first, around.right - first, around.bottom - first, work);
    load_block(pixels + (first - 1) * side + first - 1, side, w, work.block);
  }
  make_template(work.block, mask, w, range.lowest, range.highest, work.scratch, work.plain);
}

void store_surround(const ImageView& image, Vec2 x, int side, Surround& around, std::uint8_t* pixels) {
  const int cx = rounded(x.x), cy = rounded(x.y), left = cx - side / 2, top = cy - side / 2;
  const auto inside = [side](int v) { return static_cast<std::int16_t>(v < 0 ? 0 : v > side ? side : v); };
  around.offset = {x.x - static_cast<float>(cx), x.y - static_cast<float>(cy)};
  around.left = inside(-left);
  around.top = inside(-top);
  around.right = inside(image.width - left);
  around.bottom = inside(image.height - top);
  copy_square(image, left, top, side, side, pixels);
}

}  // namespace pliant::patch
