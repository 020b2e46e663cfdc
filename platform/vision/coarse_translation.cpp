#include "pliant/coarse_translation.hpp"

#include <cstdint>

#include "vision/coarse_translation_tuning.hpp"

namespace pliant {

namespace {

constexpr CoarseTranslationTuning kTuning = kCoarseTranslationTuning;

struct Sums {
  std::int64_t n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
};

float correlation(const Sums& s) {
  const std::int64_t ab = s.n * s.ab - s.a * s.b, aa = s.n * s.aa - s.a * s.a, bb = s.n * s.bb - s.b * s.b;
  if (aa <= 0 || bb <= 0) return 0;
  return static_cast<float>(ab) / (square_root(static_cast<float>(aa)) * square_root(static_cast<float>(bb)));
}

// The shifts of a box, and the best of those tried.
class Search {
 public:
  Search(const ImageView& reference, const ImageView& current, const PixelBox& box, int range_px)
      : reference_(reference), current_(current), box_(box), range_px_(range_px) {
    const int width = box.x1 - box.x0, height = box.y1 - box.y0;
    while ((width / spacing_) * (height / spacing_) > kTuning.max_pixels) ++spacing_;
    const std::int64_t all =
        std::int64_t{(width + spacing_ - 1) / spacing_} * ((height + spacing_ - 1) / spacing_);
    min_pixels_ = all / kTuning.min_overlap_divisor;
    best_ = correlation_at(0, 0);
  }

  // Tries the shifts up to `range` px around (x, y).
  void try_around(int x, int y, int range, int step) {
    for (int dy = y - range; dy <= y + range; dy += step)
      for (int dx = x - range; dx <= x + range; dx += step) {
        if (dx > range_px_ || -dx > range_px_ || dy > range_px_ || -dy > range_px_) continue;
        const float value = correlation_at(dx, dy);
        const bool is_smaller = dx * dx + dy * dy < best_x_ * best_x_ + best_y_ * best_y_;
        if (value > best_ || (value == best_ && is_smaller)) {
          best_ = value;
          best_x_ = dx;
          best_y_ = dy;
        }
      }
  }

  int best_x() const { return best_x_; }
  int best_y() const { return best_y_; }
  CoarseTranslation result() const {
    CoarseTranslation r;
    r.correlation = best_;
    r.by = {static_cast<float>(best_x_) +
                peak_offset(correlation_at(best_x_ - 1, best_y_), correlation_at(best_x_ + 1, best_y_)),
            static_cast<float>(best_y_) +
                peak_offset(correlation_at(best_x_, best_y_ - 1), correlation_at(best_x_, best_y_ + 1))};
    return r;
  }

 private:
  // Where a parabola through the best correlation and its two neighbours has its peak, px.
  float peak_offset(float before, float after) const {
    const float bend = before - 2 * best_ + after;
    return bend < 0 ? clamp(0.5f * (before - after) / bend, -0.5f, 0.5f) : 0.0f;
  }

  float correlation_at(int dx, int dy) const {
    Sums total;
    for (int y = box_.y0; y < box_.y1; y += spacing_) {
      const int yc = y + dy;
      if (yc >= 0 && yc < current_.height) add_row(y, dx, yc, total);
    }
    return total.n < min_pixels_ ? 0.0f : correlation(total);
  }

  // One row of the reference, shifted by dx, with the row yc of the current image.
  void add_row(int y, int dx, int yc, Sums& total) const {
    const std::uint8_t* r = reference_.data + y * reference_.stride;
    const std::uint8_t* c = current_.data + yc * current_.stride + dx;
    int x0 = box_.x0, x1 = box_.x1;
    while (x0 < x1 && x0 + dx < 0) x0 += spacing_;
    if (x1 + dx > current_.width) x1 = current_.width - dx;
    std::int32_t n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
    for (int x = x0; x < x1; x += spacing_) {
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

  const ImageView& reference_;
  const ImageView& current_;
  PixelBox box_;
  int range_px_, spacing_ = 1;
  std::int64_t min_pixels_ = 0;
  int best_x_ = 0, best_y_ = 0;
  float best_ = 0;
};

PixelBox clipped(PixelBox box, const ImageView& image) {
  if (box.x0 < 0) box.x0 = 0;
  if (box.y0 < 0) box.y0 = 0;
  if (box.x1 > image.width) box.x1 = image.width;
  if (box.y1 > image.height) box.y1 = image.height;
  return box;
}

}  // namespace

CoarseTranslation find_coarse_translation(const ImageView& reference, const PixelBox& box,
                                          const ImageView& current, int range_px) {
  if (check(reference) != Status::ok || check(current) != Status::ok || range_px < 0) return {};
  if (reference.width != current.width || reference.height != current.height) return {};
  const PixelBox inside = clipped(box, reference);
  if (inside.x1 - inside.x0 < kTuning.min_side_px || inside.y1 - inside.y0 < kTuning.min_side_px) return {};
  Search search(reference, current, inside, range_px);
  constexpr int kStep = kTuning.first_step_px;
  search.try_around(0, 0, range_px / kStep * kStep, kStep);
  search.try_around(search.best_x(), search.best_y(), kStep - 1, 1);
  return search.result();
}

}  // namespace pliant
