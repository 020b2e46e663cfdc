// Corner selection: the best local maximum of each cell, then best first with a minimum distance (docs/algorithms.md,
// section 7.1).
#include "pliant/corners.hpp"

#include <cstring>

#include "base/integers.hpp"
#include "vision/corner_grid.hpp"
#include "vision/corner_scores.hpp"
#include "vision/largest_side.hpp"

namespace pliant {
namespace {

using corners::Cell;
using corners::Grid;

// Whether a comes before b: a higher score; if equal, the lower y; if equal, the lower x.
bool is_before(const Cell& a, const Cell& b) {
  if (a.score != b.score) return a.score > b.score;
  return a.y != b.y ? a.y < b.y : a.x < b.x;
}

bool is_valid(const CornerOptions& o) {
  return o.cell_px >= 2 && o.cell_px <= 128 && o.quality >= 0 && o.quality <= 1 && o.min_score >= 0 &&
         o.min_ratio >= 0 && o.min_ratio <= 1 && o.min_distance_px >= 0 && o.min_distance_px <= 256;
}

bool is_size(int width, int height) {
  return width > 0 && height > 0 && width <= kLargestSidePx && height <= kLargestSidePx;
}

struct Box {
  int left, top, right, bottom;  // pixels; right and bottom excluded
};

void lay_out(Arena& arena, int width, int height, int cell_px, Grid& g, corners::RowScorer& scorer) {
  g.cell_px = cell_px;
  g.width = corner_cells(width, cell_px);
  g.height = corner_cells(height, cell_px);
  const auto n = static_cast<std::size_t>(g.count());
  g.cells = arena.take<Cell>(n);
  g.order = arena.take<std::int32_t>(n);
  g.is_taken = arena.take<std::uint8_t>(n);
  const int scored = larger(width - 2 * kCornerMargin, 0);
  for (auto& row : g.rows) row = arena.take<float>(static_cast<std::size_t>(scored) + 2);
  g.peaks = arena.take<float>(static_cast<std::size_t>(scored));
  scorer.lay_out(arena, scored);
}

// The pixels to score: the box around the allowed cells, less the margin.
Box box_of(const ImageView& image, const Grid& g, Span<const std::uint8_t> allowed) {
  Box b{image.width, image.height, 0, 0};
  for (int cy = 0; cy < g.height; ++cy)
    for (int cx = 0; cx < g.width; ++cx) {
      if (!allowed.empty() && allowed[static_cast<std::size_t>(cy * g.width + cx)] == 0) continue;
      const int x = cx * g.cell_px, y = cy * g.cell_px;
      b = {smaller(b.left, x), smaller(b.top, y), larger(b.right, x + g.cell_px),
           larger(b.bottom, y + g.cell_px)};
    }
  return {larger(b.left, kCornerMargin), larger(b.top, kCornerMargin),
          smaller(b.right, image.width - kCornerMargin), smaller(b.bottom, image.height - kCornerMargin)};
}

// peak[x] = here[x] where that is a maximum over 3 x 3 pixels and at least `least`, otherwise 0. A maximum is more
// than the neighbours before it in reading order and no less than those after it, so that the first of equals is
// taken. Reads one pixel beyond the ends. Without __restrict for the reason given in corner_scores.cpp.
void find_peaks(const float* above, const float* here, const float* below, int n, float least, float* peak) {
  for (int x = 0; x < n; ++x) {
    const float before = max(max(above[x - 1], above[x]), max(above[x + 1], here[x - 1]));
    const float after = max(max(below[x - 1], below[x]), max(below[x + 1], here[x + 1]));
    const float s = here[x];
    const bool is_peak = (s > before) & (s >= max(after, least));
    peak[x] = is_peak ? s : 0.0f;
  }
}

void keep_best(const Grid& g, const Box& box, int y) {
  const float* peaks = g.peaks;
  for (int x = box.left; x < box.right; ++x) {
    const float score = peaks[x - box.left];
    if (score <= 0) continue;
    Cell& cell = g.at(x, y);
    if (score > cell.score) cell = {score, static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y)};
  }
}

// Fills the cells. Scores beyond the box count as zero.
void scan(const ImageView& image, const CornerOptions& o, const Box& box, corners::RowScorer& scorer,
          Grid& g) {
  const int width = box.right - box.left;
  const auto bytes = static_cast<std::size_t>(width + 2) * sizeof(float);
  for (float* row : g.rows) std::memset(row, 0, bytes);
  float *above = g.rows[0] + 1, *here = g.rows[1] + 1, *below = g.rows[2] + 1;
  scorer.start(image, box.left, box.right, box.top);
  scorer.next(o.min_ratio, here);
  for (int y = box.top; y < box.bottom; ++y) {
    if (y + 1 < box.bottom) {
      scorer.next(o.min_ratio, below);
    } else {
      std::memset(below - 1, 0, bytes);
    }
    find_peaks(above, here, below, width, o.min_score, g.peaks);
    keep_best(g, box, y);
    float* const oldest = above;
    above = here;
    here = below;
    below = oldest;
  }
}

// Lists the cells that are good enough. \return their number.
int list_candidates(const Grid& g, float quality) {
  float best = 0;
  int n = 0;
  for (int i = 0; i < g.count(); ++i) best = max(best, g.cells[i].score);
  for (int i = 0; i < g.count(); ++i)
    if (g.cells[i].score > 0 && g.cells[i].score >= quality * best) g.order[n++] = i;
  return n;
}

// Moves order[i] down to its place in a heap with the best at its root.
void sift_down(const Grid& g, int i, int n) {
  for (int child = 2 * i + 1; child < n; child = 2 * i + 1) {
    if (child + 1 < n && is_before(g.cells[g.order[child + 1]], g.cells[g.order[child]])) ++child;
    if (!is_before(g.cells[g.order[child]], g.cells[g.order[i]])) return;
    const std::int32_t t = g.order[i];
    g.order[i] = g.order[child];
    g.order[child] = t;
    i = child;
  }
}

// Removes the best from a heap of n candidates.
std::int32_t pop(const Grid& g, int n) {
  const std::int32_t best = g.order[0];
  g.order[0] = g.order[n - 1];
  sift_down(g, 0, n - 1);
  return best;
}

bool has_room_around(const Grid& g, const Cell& c, float distance) {
  const int reach = static_cast<int>(distance) / g.cell_px + 1;
  const int cx = c.x / g.cell_px, cy = c.y / g.cell_px;
  for (int y = cy < reach ? 0 : cy - reach; y <= cy + reach && y < g.height; ++y)
    for (int x = cx < reach ? 0 : cx - reach; x <= cx + reach && x < g.width; ++x) {
      const int i = y * g.width + x;
      if (g.is_taken[i] == 0) continue;
      const auto dx = static_cast<float>(g.cells[i].x - c.x), dy = static_cast<float>(g.cells[i].y - c.y);
      if (dx * dx + dy * dy < distance * distance) return false;
    }
  return true;
}

}  // namespace

float corner_score(const ImageView& image, Vec2 x) {
  if (check(image) != Status::ok || !is_finite(x)) return 0;
  const float m = kCornerMargin - 0.5f;
  if (x.x < m || x.y < m || x.x >= static_cast<float>(image.width) - 1 - m ||
      x.y >= static_cast<float>(image.height) - 1 - m)
    return 0;
  const int cx = static_cast<int>(x.x + 0.5f), cy = static_cast<int>(x.y + 0.5f);
  corners::Tensor t{};
  const std::ptrdiff_t s = image.stride;
  for (int dy = -corners::kRadius; dy <= corners::kRadius; ++dy)
    for (int dx = -corners::kRadius; dx <= corners::kRadius; ++dx) {
      const std::uint8_t* p = image.data + (cy + dy) * s + cx + dx;
      const int gx = 3 * (p[1 - s] - p[-1 - s] + p[1 + s] - p[-1 + s]) + 10 * (p[1] - p[-1]);
      const int gy = 3 * (p[s - 1] - p[-s - 1] + p[s + 1] - p[-s + 1]) + 10 * (p[s] - p[-s]);
      t.xx += gx * gx;
      t.xy += gx * gy;
      t.yy += gy * gy;
    }
  return corners::score_of(t);
}

std::size_t corner_scratch_bytes(int width, int height, const CornerOptions& options) {
  if (!is_size(width, height) || !is_valid(options)) return 0;
  Arena measuring;
  Grid grid;
  corners::RowScorer scorer;
  lay_out(measuring, width, height, options.cell_px, grid, scorer);
  return measuring.used_bytes();
}

Status corners::scan_cells(const ImageView& image, const CornerOptions& options,
                           Span<const std::uint8_t> allowed, Arena& scratch, Grid* grid) {
  if (check(image) != Status::ok || !is_size(image.width, image.height) || !is_valid(options))
    return Status::bad_argument;
  const std::size_t cells = static_cast<std::size_t>(corner_cells(image.width, options.cell_px)) *
                            static_cast<std::size_t>(corner_cells(image.height, options.cell_px));
  if (!allowed.empty() && allowed.count != cells) return Status::bad_argument;
  RowScorer scorer;
  lay_out(scratch, image.width, image.height, options.cell_px, *grid, scorer);
  if (scratch.is_measuring() || scratch.exhausted()) return Status::out_of_memory;
  for (std::size_t i = 0; i < cells; ++i) grid->cells[i] = {0, 0, 0};
  const Box box = box_of(image, *grid, allowed);
  if (box.left >= box.right || box.top >= box.bottom) return Status::ok;
  scan(image, options, box, scorer, *grid);
  for (std::size_t i = 0; i < cells; ++i)
    if (!allowed.empty() && allowed[i] == 0) grid->cells[i].score = 0;
  return Status::ok;
}

int corners::choose_corners(const Grid& g, float quality, float min_distance_px, Span<Corner> out) {
  std::memset(g.is_taken, 0, static_cast<std::size_t>(g.count()));
  const int candidates = list_candidates(g, quality);
  for (int i = candidates / 2 - 1; i >= 0; --i) sift_down(g, i, candidates);
  int count = 0;
  for (int n = candidates; n > 0 && static_cast<std::size_t>(count) < out.count; --n) {
    const std::int32_t i = pop(g, n);
    const Cell& c = g.cells[i];
    if (!has_room_around(g, c, min_distance_px)) continue;
    g.is_taken[i] = 1;
    out[static_cast<std::size_t>(count++)] = {{static_cast<float>(c.x), static_cast<float>(c.y)}, c.score};
  }
  return count;
}

Status find_corners(const ImageView& image, const CornerOptions& options, Span<const std::uint8_t> allowed,
                    Arena& scratch, Span<Corner> out, int& count) {
  const Arena::Scope scope(scratch);
  Grid grid;
  const Status status = corners::scan_cells(image, options, allowed, scratch, &grid);
  if (status == Status::ok)
    count = corners::choose_corners(grid, options.quality, options.min_distance_px, out);
  return status;
}

}  // namespace pliant
