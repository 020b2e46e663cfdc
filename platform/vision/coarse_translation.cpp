#include "pliant/coarse_translation.hpp"

#include <cstdint>

#include "base/integers.hpp"
#include "base/wide_vectors.hpp"
#include "vision/coarse_translation_tuning.hpp"
#include "vision/largest_side.hpp"
#include "vision/parabola.hpp"

namespace pliant {

namespace {

constexpr CoarseTranslationTuning kTuning = kCoarseTranslationTuning;

/// Of grey levels a of the reference and b of the image. Of kLargestSidePx and kTuning.max_pixels the sums of squares fit 32
/// bits.
struct Sums {
  std::int32_t n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
};

/// Pixels of the reference: rows from p on, a stride apart.
struct Pixels {
  const std::uint8_t* p = nullptr;
  int stride = 0, width = 0, rows = 0;
};

PLIANT_WIDE_VECTORS
void add_reference(const Pixels& of, Sums& s) {
  const std::uint8_t* __restrict p = of.p;
  std::int32_t a = 0, aa = 0;
  for (int y = 0; y < of.rows; ++y, p += of.stride)
    for (int x = 0; x < of.width; ++x) {
      const auto v = static_cast<std::int16_t>(p[x]);
      a += v;
      aa += v * v;
    }
  s.a = a;
  s.aa = aa;
}

PLIANT_WIDE_VECTORS
void add_image(const Pixels& of, const std::uint8_t* __restrict q, int q_stride, Sums& s) {
  const std::uint8_t* __restrict p = of.p;
  std::int32_t b = 0, bb = 0, ab = 0;
  for (int y = 0; y < of.rows; ++y, p += of.stride, q += q_stride)
    for (int x = 0; x < of.width; ++x) {
      const auto u = static_cast<std::int16_t>(p[x]), v = static_cast<std::int16_t>(q[x]);
      b += v;
      bb += v * v;
      ab += u * v;
    }
  s.b = b;
  s.bb = bb;
  s.ab = ab;
}

float correlation(const Sums& s) {
  const std::int64_t n = s.n, a = s.a, b = s.b;
  const std::int64_t ab = n * s.ab - a * b, aa = n * s.aa - a * a, bb = n * s.bb - b * b;
  if (aa <= 0 || bb <= 0) return 0;
  return static_cast<float>(ab) / (square_root(static_cast<float>(aa)) * square_root(static_cast<float>(bb)));
}

/// A shift whose neighbours are no better.
struct Peak {
  Vec2 at;                // px
  float correlation = 0;  // of the whole shift next to it
  float height = 0;       // correlation, of the parabolas through that shift and its neighbours
};

// The shifts of a box, and the best of those tried.
class Search {
 public:
  Search(const ImageView& reference, const ImageView& current, const PixelBox& box, int range_px)
      : reference_(reference), current_(current), box_(box), range_px_(range_px) {
    const int width = box.x1 - box.x0, height = box.y1 - box.y0;
    while (width * (height / spacing_) > kTuning.max_pixels) ++spacing_;
    min_pixels_ = width * ((height + spacing_ - 1) / spacing_) / kTuning.min_overlap_divisor;
    begin_at(0, 0);
  }

  // Forgets the shifts that were tried, but for this one.
  void begin_at(int x, int y) {
    best_x_ = x;
    best_y_ = y;
    best_ = correlation_at(x, y);
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

  // Climbs to a peak. \return false if there is none near (x, y).
  bool climb_from(int x, int y) {
    begin_at(x, y);
    for (int k = 0; k < kTuning.most_climbs; ++k) {
      x = best_x_, y = best_y_;
      try_around(x, y, 1, 1);
      if (best_x_ == x && best_y_ == y) return true;
    }
    return false;
  }

  int best_x() const { return best_x_; }
  int best_y() const { return best_y_; }
  std::uint32_t compared() const { return compared_; }
  Peak peak() {
    const float left = correlation_at(best_x_ - 1, best_y_), right = correlation_at(best_x_ + 1, best_y_),
                above = correlation_at(best_x_, best_y_ - 1), below = correlation_at(best_x_, best_y_ + 1);
    const Vec2 off{parabola_peak(left, best_, right), parabola_peak(above, best_, below)};
    const float rise = 0.25f * (off.x * (right - left) + off.y * (below - above));
    return {{static_cast<float>(best_x_) + off.x, static_cast<float>(best_y_) + off.y}, best_, best_ + rise};
  }

 private:
  float correlation_at(int dx, int dy) {
    const int x0 = box_.x0 + dx < 0 ? -dx : box_.x0;
    const int x1 = box_.x1 + dx > current_.width ? current_.width - dx : box_.x1;
    int y0 = box_.y0;
    while (y0 + dy < 0) y0 += spacing_;
    const int y1 = box_.y1 + dy > current_.height ? current_.height - dy : box_.y1;
    if (x0 >= x1 || y0 >= y1) return 0;
    const Pixels of{reference_.data + y0 * reference_.stride + x0, spacing_ * reference_.stride, x1 - x0,
                    (y1 - y0 + spacing_ - 1) / spacing_};
    if (of.p != of_.p || of.width != of_.width || of.rows != of_.rows) add_reference(of, sums_);
    of_ = of;
    sums_.n = of.width * of.rows;
    add_image(of, current_.data + (y0 + dy) * current_.stride + x0 + dx, spacing_ * current_.stride, sums_);
    compared_ += static_cast<std::uint32_t>(sums_.n);
    return sums_.n < min_pixels_ ? 0.0f : correlation(sums_);
  }

  const ImageView& reference_;
  const ImageView& current_;
  PixelBox box_;
  int range_px_, spacing_ = 1;  // of the rows that are compared
  int min_pixels_ = 0;
  int best_x_ = 0, best_y_ = 0;
  float best_ = 0;
  std::uint32_t compared_ = 0;
  Pixels of_;  // of the last comparison: most shifts compare the same pixels of the reference
  Sums sums_;
};

PixelBox clipped(const PixelBox& box, const ImageView& image) {
  return {within(box.x0, 0, image.width), within(box.y0, 0, image.height), within(box.x1, 0, image.width),
          within(box.y1, 0, image.height)};
}

/// The nearest whole shift within the range.
int nearest(float x, int range) {
  const float most = static_cast<float>(range), within_range = clamp(x, -most, most);
  return static_cast<int>(within_range < 0 ? within_range - 0.5f : within_range + 0.5f);
}

bool is_next_to(int dx, int dy) {
  return dx >= -1 && dx <= 1 && dy >= -1 && dy <= 1;
}

/// Where another peak near the expected shift is nearly as high, that is taken.
Peak peak_near(Search& search, int x, int y) {
  const Peak highest = search.peak();
  const int best_x = search.best_x(), best_y = search.best_y();
  if (is_next_to(best_x - x, best_y - y) || !search.climb_from(x, y) ||
      is_next_to(best_x - search.best_x(), best_y - search.best_y()))
    return highest;
  const Peak near = search.peak();
  return near.height >= highest.height - kTuning.most_below_best ? near : highest;
}

}  // namespace

CoarseTranslation find_coarse_translation(const ImageView& reference, const PixelBox& box,
                                          const ImageView& current, int range_px, const Vec2* expected) {
  if (check(reference) != Status::ok || check(current) != Status::ok || range_px < 0) return {};
  if (reference.width != current.width || reference.height != current.height) return {};
  if (reference.width > kLargestSidePx || reference.height > kLargestSidePx) return {};
  const PixelBox inside = clipped(box, reference);
  if (inside.x1 - inside.x0 < kTuning.min_side_px || inside.y1 - inside.y0 < kTuning.min_side_px) return {};
  range_px = smaller(range_px, larger(reference.width, reference.height));  // beyond, nothing overlaps
  Search search(reference, current, inside, range_px);
  constexpr int kStep = kTuning.first_step_px;
  search.try_around(0, 0, range_px / kStep * kStep, kStep);
  search.try_around(search.best_x(), search.best_y(), kStep - 1, 1);
  const Peak best = expected == nullptr
                        ? search.peak()
                        : peak_near(search, nearest(expected->x, range_px), nearest(expected->y, range_px));
  return {best.at, best.correlation, search.compared()};
}

}  // namespace pliant
