// A template's centre is always a whole pixel of its source, so that an unwarped one needs no interpolation. The caller
// accounts for the rest of the position.
#include "vision/patch_template.hpp"

#include <cstring>

#include "base/integers.hpp"
#include "vision/bilinear.hpp"
#include "vision/patch_sampling.hpp"
#include "vision/patch_sums.hpp"

namespace pliant::patch {
namespace {

int rounded(float x) {
  return static_cast<int>(x + 16384.5f) - 16384;
}

// Copies `columns` pixels of a row from column `left` on, its ends repeated beyond them.
void copy_row(const std::uint8_t* row, int width, int left, int columns, std::uint8_t* out) {
  const int before = within(-left, 0, columns), end = within(width - left, before, columns);
  std::memset(out, row[0], static_cast<std::size_t>(before));
  std::memcpy(out + before, row + left + before, static_cast<std::size_t>(end - before));
  std::memset(out + end, row[width - 1], static_cast<std::size_t>(columns - end));
}

void copy_square(const ImageView& image, int left, int top, int rows, int columns, std::uint8_t* out) {
  const bool is_whole = left >= 0 && left + columns <= image.width;
  for (int y = 0; y < rows; ++y, out += columns) {
    const std::uint8_t* row =
        image.data + std::ptrdiff_t{within(top + y, 0, image.height - 1)} * image.stride;
    if (is_whole)
      std::memcpy(out, row + left, static_cast<std::size_t>(columns));
    else
      copy_row(row, image.width, left, columns, out);
  }
}

// The mask of [left, right) x [top, bottom) of the window.
const i16* mask_of(int left, int top, int right, int bottom, Workspace& work) {
  const int w = work.window;
  if (left <= 0 && top <= 0 && right >= w && bottom >= w) return work.all;
  i16 row[kMaxWindow] = {};
  for (int x = larger(left, 0); x < smaller(right, w); ++x) row[x] = 1;
  for (int y = 0; y < w; ++y) {
    i16* out = work.part + y * w;
    for (int x = 0; x < w; ++x) out[x] = y >= top && y < bottom ? row[x] : i16{0};
  }
  return work.part;
}

// --- the stored square, resampled under a warp ---

constexpr int kBits = kLatticeBits;

struct FixedPosition {
  int x, y;
};

FixedPosition at(const Lattice& l, int i, int j) {
  return {l.x + l.across_x * i + l.down_x * j, l.y + l.across_y * i + l.down_y * j};
}

i16 sample(const std::uint8_t* pixels, int side, FixedPosition p) {
  const int fx = (p.x >> (kBits - 8)) & 255, fy = (p.y >> (kBits - 8)) & 255;
  return narrow(bilinear_sixteenths(pixels + (p.y >> kBits) * side + (p.x >> kBits), side, fx, fy) -
                kGreyOffset);
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
    return {within(p.x, low.x, high.x), within(p.y, low.y, high.y)};
  }
};

// Masks out what leaves the stored square and fills it with the nearest stored value.
const i16* load_partly_outside(const Lattice& lattice, const Bounds& bounds, const std::uint8_t* pixels,
                               int side, Workspace& work) {
  const int w = work.window, stride = block_stride(w);
  for (int y = 0; y < w + 2; ++y) {
    FixedPosition exact = at(lattice, 0, y);
    i16 *row = work.block + y * stride, *mask = work.part + (y - 1) * w;
    const unsigned masked = y > 0 && y <= w ? static_cast<unsigned>(w) : 0;  // the block's border has no mask
    for (int x = 0; x < w + 2; ++x) {
      const FixedPosition inside = bounds.clamped(exact);
      row[x] = sample(pixels, side, inside);
      if (static_cast<unsigned>(x - 1) < masked)
        mask[x - 1] = ((inside.x ^ exact.x) | (inside.y ^ exact.y)) == 0 ? 1 : 0;
      exact = {exact.x + lattice.across_x, exact.y + lattice.across_y};
    }
  }
  return work.part;
}

// \return the mask.
const i16* load_warped(const StoredTemplate& stored, const std::uint8_t* pixels, int side,
                       const Mat2& to_template, Workspace& work) {
  const int w = work.window, last = w + 1;
  const Lattice l = lattice_of(to_template, side, w / 2 + 1);
  const Bounds bounds{{stored.left << kBits, stored.top << kBits},
                      {((stored.right - 1) << kBits) - 1, ((stored.bottom - 1) << kBits) - 1}};
  if (!bounds.contains(at(l, 0, 0)) || !bounds.contains(at(l, last, 0)) || !bounds.contains(at(l, 0, last)) ||
      !bounds.contains(at(l, last, last)))
    return load_partly_outside(l, bounds, pixels, side, work);
  sample_lattice(pixels, side, l, w, work.scratch, work.block);
  return work.all;
}

}  // namespace

void load_block(const ImageView& image, int left, int top, Workspace& work) {
  const int rows = block_rows(work.window), columns = block_stride(work.window);
  const bool is_whole = left >= 0 && top >= 0 && left + columns <= image.width && top + rows <= image.height;
  if (is_whole)
    return load_block(image.data + std::ptrdiff_t{top} * image.stride + left, image.stride, work.window,
                      work.block);
  copy_square(image, left, top, rows, columns, work.bytes);
  load_block(work.bytes, columns, work.window, work.block);
}

void load_template(const ImageView& image, int left, int top, Workspace& work) {
  const i16* mask = mask_of(-left, -top, image.width - left, image.height - top, work);
  load_block(image, left - 1, top - 1, work);
  make_template(work.block, mask, work.window, work.scratch, work.active);
}

void load_template(const StoredTemplate& stored, const std::uint8_t* pixels, int side,
                   const Mat2* to_template, Workspace& work) {
  const int w = work.window, first = side / 2 - w / 2;
  const i16* mask;
  if (to_template != nullptr) {
    mask = load_warped(stored, pixels, side, *to_template, work);
  } else {
    mask =
        mask_of(stored.left - first, stored.top - first, stored.right - first, stored.bottom - first, work);
    load_block(pixels + (first - 1) * side + first - 1, side, w, work.block);
  }
  make_template(work.block, mask, w, work.scratch, work.active);
}

void store_template(const ImageView& image, Vec2 x, int side, StoredTemplate& stored, std::uint8_t* pixels) {
  const int cx = rounded(x.x), cy = rounded(x.y), left = cx - side / 2, top = cy - side / 2;
  const auto inside = [side](int v) { return static_cast<std::int16_t>(within(v, 0, side)); };
  stored.offset = {x.x - static_cast<float>(cx), x.y - static_cast<float>(cy)};
  stored.left = inside(-left);
  stored.top = inside(-top);
  stored.right = inside(image.width - left);
  stored.bottom = inside(image.height - top);
  copy_square(image, left, top, side, side, pixels);
}

}  // namespace pliant::patch
