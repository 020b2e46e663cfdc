#include "pliant/coarse_translation.hpp"

#include <cstdint>

namespace pliant {

namespace {

struct Sums {
  std::int64_t n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
};

float correlation(const Sums& s) {
  const std::int64_t ab = s.n * s.ab - s.a * s.b, aa = s.n * s.aa - s.a * s.a, bb = s.n * s.bb - s.b * s.b;
  if (aa <= 0 || bb <= 0) return 0;
  return static_cast<float>(ab) / (square_root(static_cast<float>(aa)) * square_root(static_cast<float>(bb)));
}

struct Search {
  const ImageView& reference;
  const ImageView& current;
  PixelBox box;
  int spacing;
  std::int64_t enough;  // pixels that must take part

  float at(int dx, int dy) const {
    Sums total;
    for (int y = box.y0; y < box.y1; y += spacing) {
      const int yc = y + dy;
      if (yc < 0 || yc >= current.height) continue;
      const std::uint8_t* r = reference.data + y * reference.stride;
      const std::uint8_t* c = current.data + yc * current.stride + dx;
      int x0 = box.x0, x1 = box.x1;
      while (x0 < x1 && x0 + dx < 0) x0 += spacing;
      if (x1 + dx > current.width) x1 = current.width - dx;
      std::int32_t n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
      for (int x = x0; x < x1; x += spacing) {
        const std::int32_t p = r[x], q = c[x];
        ++n;
        a += p;
        b += q;
        aa += p * p;
        bb += q * q;
        ab += p * q;
      }
      total.n += n;
      total.a += a;
      total.b += b;
      total.aa += aa;
      total.bb += bb;
      total.ab += ab;
    }
    return total.n < enough ? 0.0f : correlation(total);
  }
};

/// Offset of a parabola's top through three values, the middle one the highest.
float parabola_top(float before, float middle, float after) {
  const float bend = before - 2 * middle + after;
  return bend < 0 ? clamp(0.5f * (before - after) / bend, -0.5f, 0.5f) : 0.0f;
}

}  // namespace

CoarseTranslation find_coarse_translation(const ImageView& reference, const PixelBox& asked, const ImageView& current, int range_px) {
  CoarseTranslation none;
  if (check(reference) != Status::ok || check(current) != Status::ok || range_px < 0) return none;
  if (reference.width != current.width || reference.height != current.height) return none;
  PixelBox box = asked;
  if (box.x0 < 0) box.x0 = 0;
  if (box.y0 < 0) box.y0 = 0;
  if (box.x1 > reference.width) box.x1 = reference.width;
  if (box.y1 > reference.height) box.y1 = reference.height;
  const int width = box.x1 - box.x0, height = box.y1 - box.y0;
  if (width < 4 || height < 4) return none;
  int spacing = 1;
  while ((width / spacing) * (height / spacing) > 600) ++spacing;
  const std::int64_t all = std::int64_t{(width + spacing - 1) / spacing} * ((height + spacing - 1) / spacing);
  const Search search{reference, current, box, spacing, all / 2};

  // Every other offset, then those between around the best: no picture this small has peaks as narrow as a pixel.
  int best_x = 0, best_y = 0;
  float best = search.at(0, 0);
  const auto try_around = [&](int x, int y, int range, int step) {
    for (int dy = y - range; dy <= y + range; dy += step)
      for (int dx = x - range; dx <= x + range; dx += step) {
        if (dx > range_px || -dx > range_px || dy > range_px || -dy > range_px) continue;
        const float value = search.at(dx, dy);
        const bool smaller = dx * dx + dy * dy < best_x * best_x + best_y * best_y;
        if (value > best || (value == best && smaller)) {
          best = value;
          best_x = dx;
          best_y = dy;
        }
      }
  };
  try_around(0, 0, range_px / 2 * 2, 2);
  try_around(best_x, best_y, 1, 1);
  CoarseTranslation shift;
  shift.correlation = best;
  shift.by = {static_cast<float>(best_x) +
                  parabola_top(search.at(best_x - 1, best_y), best, search.at(best_x + 1, best_y)),
              static_cast<float>(best_y) +
                  parabola_top(search.at(best_x, best_y - 1), best, search.at(best_x, best_y + 1))};
  return shift;
}

}  // namespace pliant
