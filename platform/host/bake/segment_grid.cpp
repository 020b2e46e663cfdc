#include "host/bake/segment_grid.hpp"

#include <algorithm>
#include <cmath>

#include "host/bake/at.hpp"
#include "host/io/bounding_box.hpp"

namespace pliant::host::bake {

namespace {

/// Cells on a side, count, at most: bounds the memory. Round value.
constexpr int kMostCells = 256;

bool is_in_box(Vec2 p, const Segment& s) {
  return p.x >= std::min(s.a.x, s.b.x) && p.x <= std::max(s.a.x, s.b.x) && p.y >= std::min(s.a.y, s.b.y) &&
         p.y <= std::max(s.a.y, s.b.y);
}

int sign(double x) {
  return (x > 0) - (x < 0);
}

bool share_end(const Segment& s, const Segment& t) {
  return s.first == t.first || s.first == t.last || s.last == t.first || s.last == t.last;
}

}  // namespace

double side_of(Vec2 a, Vec2 b, Vec2 p) {
  return (static_cast<double>(b.x) - static_cast<double>(a.x)) *
             (static_cast<double>(p.y) - static_cast<double>(a.y)) -
         (static_cast<double>(b.y) - static_cast<double>(a.y)) *
             (static_cast<double>(p.x) - static_cast<double>(a.x));
}

bool touch(const Segment& s, const Segment& t) {
  const int a = sign(side_of(s.a, s.b, t.a)), b = sign(side_of(s.a, s.b, t.b)),
            c = sign(side_of(t.a, t.b, s.a)), d = sign(side_of(t.a, t.b, s.b));
  if (a * b < 0 && c * d < 0) return true;
  return (a == 0 && is_in_box(t.a, s)) || (b == 0 && is_in_box(t.b, s)) || (c == 0 && is_in_box(s.a, t)) ||
         (d == 0 && is_in_box(s.b, t));
}

bool covers_neighbour(const Segment& s, const Segment& t) {
  const bool at_start = s.first == t.first || s.first == t.last;
  const Vec2 apex = at_start ? s.a : s.b, p = at_start ? s.b : s.a,
             q = t.first == (at_start ? s.first : s.last) ? t.b : t.a;
  return side_of(apex, p, q) == 0 && dot(p - apex, q - apex) > 0;
}

SegmentGrid::SegmentGrid(const std::vector<Segment>& segments) : segments_(segments) {
  if (segments.empty()) return;
  BoundingBox<Vec2> box;
  for (const Segment& s : segments)
    for (const Vec2 p : {s.a, s.b}) box.add(p);
  const Vec2 low = box.low, size = box.size();
  const int n = std::clamp(static_cast<int>(std::sqrt(static_cast<double>(segments.size()))), 1, kMostCells);
  cells_.resize(at(n * n));
  const float w = static_cast<float>(n) / std::max(size.x, 1e-20f),
              h = static_cast<float>(n) / std::max(size.y, 1e-20f);
  const auto cell = [n](float x) { return std::clamp(static_cast<int>(x), 0, n - 1); };
  for (std::size_t i = 0; i < segments.size(); ++i) {
    Vec2 a{(segments[i].a.x - low.x) * w, (segments[i].a.y - low.y) * h},
        b{(segments[i].b.x - low.x) * w, (segments[i].b.y - low.y) * h};
    if (a.y > b.y) std::swap(a, b);
    constexpr float kSlack = 1e-3f;  // of a cell; above the rounding error
    for (int row = cell(a.y - kSlack); row <= cell(b.y + kSlack); ++row) {
      // The part of the segment within the row.
      const float rise = std::max(b.y - a.y, 1e-20f);
      const float from = std::clamp((static_cast<float>(row) - kSlack - a.y) / rise, 0.0f, 1.0f),
                  to = std::clamp((static_cast<float>(row + 1) + kSlack - a.y) / rise, 0.0f, 1.0f);
      const float x = a.x + from * (b.x - a.x), y = a.x + to * (b.x - a.x);
      const bool is_flat = b.y - a.y < kSlack;
      const float left = is_flat ? std::min(a.x, b.x) : std::min(x, y),
                  right = is_flat ? std::max(a.x, b.x) : std::max(x, y);
      for (int column = cell(left - kSlack); column <= cell(right + kSlack); ++column)
        cells_[at(row * n + column)].push_back(i);
    }
  }
}

template <class Visit>
void SegmentGrid::each_pair(Visit visit) const {
  for (const std::vector<std::size_t>& cell : cells_)
    for (std::size_t i = 0; i < cell.size(); ++i)
      for (std::size_t k = i + 1; k < cell.size(); ++k) {
        const Segment &s = segments_[cell[i]], &t = segments_[cell[k]];
        if ((share_end(s, t) ? covers_neighbour(s, t) : touch(s, t)) && !visit(cell[i], cell[k])) return;
      }
}

std::optional<std::pair<std::size_t, std::size_t>> SegmentGrid::find_crossing() const {
  std::optional<std::pair<std::size_t, std::size_t>> found;
  each_pair([&](std::size_t i, std::size_t k) {
    found = {i, k};
    return false;
  });
  return found;
}

std::vector<char> SegmentGrid::crossing_segments() const {
  std::vector<char> result(segments_.size(), 0);
  each_pair([&](std::size_t i, std::size_t k) {
    result[i] = result[k] = 1;
    return true;
  });
  return result;
}

}  // namespace pliant::host::bake
