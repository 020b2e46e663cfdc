#include "host/bake/loop_points.hpp"

#include <algorithm>
#include <cmath>

#include "host/bake/at.hpp"
#include "host/bake/segment_grid.hpp"
#include "host/io/polygon.hpp"

namespace pliant::host::bake {

namespace {

/// Tuning of the points along the boundary. Each constant: unit, reason, experiment. None was tuned by an experiment.
struct LoopPointTuning {
  /// Distance in the chart up to which a landmark lies on a boundary loop, and least distance between anchors there.
  /// Round values.
  float on_loop = 0.003f, anchor_spacing = 0.015f;
  /// Points on a loop without anchors, count, at least. Fewer do not enclose an area in basic blocks.
  int least_loop_points = 6;
  /// Cosine of the turn at which a boundary has a corner: 50 degrees, less than at the corner of a triangle or a square.
  float corner_cosine = 0.64f;
  /// Fraction of an edge of the source below which a point of the edge counts as its end.
  float close = 1e-3f;
};
constexpr LoopPointTuning kTuning{};

}  // namespace

LoopPoints::LoopPoints(const Source& source, const SurfaceBoundary& boundary)
    : source_(source), boundary_(boundary) {
  for (const BoundaryLoop& loop : boundary.loops) anchors_.push_back(fixed_anchors(loop));
}

Vec3 LoopPoints::position(const BoundaryLoop& loop, std::size_t k) const {
  return source_.neutral[at(loop.vertices[k % loop.vertices.size()])];
}

Vec2 LoopPoints::uv_of(const BoundaryLoop& loop, Place place) const {
  const std::size_t n = loop.vertices.size();
  const Vec2 a = source_.uv[at(loop.vertices[place.k % n])],
             b = source_.uv[at(loop.vertices[(place.k + 1) % n])];
  return a + place.fraction * (b - a);
}

/// Vertices of the loop that must be kept: where the kind of its edges changes, and next to landmarks.
std::vector<char> LoopPoints::fixed_anchors(const BoundaryLoop& loop) const {
  const std::size_t n = loop.vertices.size();
  std::vector<char> is_anchor(n, 0);
  for (std::size_t k = 0; k < n; ++k) is_anchor[k] = loop.sides[k] != loop.sides[(k + n - 1) % n];
  for (const SourceLandmark& l : source_.landmarks) {
    std::size_t best = 0;
    for (std::size_t k = 0; k < n; ++k)
      if (length(source_.uv[at(loop.vertices[k])] - l.uv) <
          length(source_.uv[at(loop.vertices[best])] - l.uv))
        best = k;
    const Vec2 here = source_.uv[at(loop.vertices[best])];
    bool is_near_another = false;
    for (std::size_t k = 0; k < n; ++k)
      is_near_another |=
          is_anchor[k] && length(source_.uv[at(loop.vertices[k])] - here) < kTuning.anchor_spacing;
    if (length(here - l.uv) < kTuning.on_loop && !is_near_another) is_anchor[best] = 1;
  }
  return is_anchor;
}

/// Marks the vertices where the boundary turns, the sharpest first, at least one wanted length apart.
void LoopPoints::add_corners(const BoundaryLoop& loop, const WantedLength& wanted,
                             std::vector<char>& is_anchor) const {
  const std::size_t n = loop.vertices.size();
  const auto walk = [&](std::size_t k, std::size_t step,
                        float reach) {  // vertex about `reach` away along the loop
    float sum = 0;
    std::size_t moved = 0;
    for (; moved < n / 4 && (moved == 0 || sum < reach); ++moved, k = (k + step) % n)
      sum += length(position(loop, k + step) - position(loop, k));
    return k;
  };
  struct Corner {
    float cosine;
    std::size_t k;
  };
  std::vector<Corner> corners;
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3 here = position(loop, k);
    const float reach = wanted(here);
    const Vec3 in = here - position(loop, walk(k, n - 1, reach)),
               out = position(loop, walk(k, 1, reach)) - here;
    const float cosine = dot(in, out) / std::max(1e-20f, length(in) * length(out));
    if (cosine < kTuning.corner_cosine) corners.push_back({cosine, k});
  }
  std::stable_sort(corners.begin(), corners.end(), [](Corner a, Corner b) { return a.cosine < b.cosine; });
  std::vector<std::size_t> taken;
  for (const Corner& c : corners) {
    const Vec3 p = position(loop, c.k);
    const float least = wanted(p);
    if (std::any_of(taken.begin(), taken.end(),
                    [&](std::size_t k) { return length(p - position(loop, k)) < least; }))
      continue;
    taken.push_back(c.k);
    is_anchor[c.k] = 1;
  }
}

std::vector<std::vector<Vec2>> LoopPoints::place(const WantedLength& wanted, std::size_t most) const {
  std::vector<Places> places(boundary_.loops.size());
  std::size_t count = 0;
  for (std::size_t l = 0; l < places.size(); ++l) {
    if (!place_loop(l, wanted, most - count, places[l])) return {};
    count += places[l].size();
  }
  while (refine_crossings(places)) {
    count = 0;
    for (const Places& p : places) count += p.size();
    if (count > most) return {};
  }
  std::vector<std::vector<Vec2>> result(places.size());
  for (std::size_t l = 0; l < places.size(); ++l)
    for (const Place p : places[l]) result[l].push_back(uv_of(boundary_.loops[l], p));
  return result;
}

bool LoopPoints::place_loop(std::size_t l, const WantedLength& wanted, std::size_t most,
                            Places& placed) const {
  const BoundaryLoop& loop = boundary_.loops[l];
  const std::size_t n = loop.vertices.size();
  std::vector<char> is_anchor = anchors_[l];
  if (source_.landmarks.empty()) add_corners(loop, wanted, is_anchor);
  if (std::count(is_anchor.begin(), is_anchor.end(), 1) == 0) is_anchor[0] = 1;
  const std::size_t first =
      static_cast<std::size_t>(std::find(is_anchor.begin(), is_anchor.end(), 1) - is_anchor.begin());
  for (std::size_t start = first; start < first + n;) {
    std::size_t end = start + 1;
    while (!is_anchor[end % n]) ++end;
    if (!place_run(loop, start, end, wanted, most, placed)) return false;
    start = end;
  }
  return true;
}

/// Places points from one anchor up to, but not including, the next. Each step has the length wanted there.
bool LoopPoints::place_run(const BoundaryLoop& loop, std::size_t start, std::size_t end,
                           const WantedLength& wanted, std::size_t most, Places& placed) const {
  std::vector<float> steps{0};  // along the run, in wanted lengths
  for (std::size_t k = start; k < end; ++k) {
    const Vec3 a = position(loop, k), b = position(loop, k + 1);
    steps.push_back(steps.back() + length(b - a) / wanted(0.5f * (a + b)));
  }
  if (!(steps.back() < static_cast<float>(most))) return false;
  const bool whole_loop = end - start == loop.vertices.size();
  const int pieces =
      std::max(whole_loop ? kTuning.least_loop_points : 1, static_cast<int>(std::lround(steps.back())));
  if (placed.size() + at(pieces) > most) return false;
  for (int piece = 0; piece < pieces; ++piece) {
    const float along = steps.back() * static_cast<float>(piece) / static_cast<float>(pieces);
    const std::size_t k =
        static_cast<std::size_t>(std::upper_bound(steps.begin(), steps.end() - 1, along) - steps.begin()) - 1;
    placed.push_back({start + k, (along - steps[k]) / std::max(1e-9f, steps[k + 1] - steps[k])});
  }
  return true;
}

/// True if the polygon of each loop lies inside an odd number of other polygons if it is an opening, else of an even number.
bool LoopPoints::is_nested(const std::vector<Places>& places) const {
  std::vector<std::vector<Vec2>> polygons(places.size());
  for (std::size_t l = 0; l < places.size(); ++l)
    for (const Place p : places[l]) polygons[l].push_back(uv_of(boundary_.loops[l], p));
  for (std::size_t l = 0; l < places.size(); ++l) {
    bool inside = false;
    for (std::size_t m = 0; m < places.size(); ++m)
      if (m != l && is_inside(polygons[m], polygons[l][0])) inside = !inside;
    if (inside != boundary_.loops[l].is_hole) return false;
  }
  return true;
}

/// Adds a vertex of the source in the middle of each edge that crosses another. False if none was added. Ends when all
/// vertices are in, as the loops themselves do not cross.
bool LoopPoints::refine_crossings(std::vector<Places>& places) const {
  std::vector<Segment> segments;
  for (std::size_t l = 0; l < places.size(); ++l) {
    const int first = static_cast<int>(segments.size()), n = static_cast<int>(places[l].size());
    for (int i = 0; i < n; ++i)
      segments.push_back({uv_of(boundary_.loops[l], places[l][at(i)]),
                          uv_of(boundary_.loops[l], places[l][at((i + 1) % n)]), first + i,
                          first + (i + 1) % n});
  }
  std::vector<char> is_crossing = SegmentGrid(segments).crossing_segments();
  if (!is_nested(places)) is_crossing.assign(segments.size(), 1);
  bool added = false;
  std::size_t segment = 0;
  for (std::size_t l = 0; l < places.size(); ++l) {
    const std::size_t n = boundary_.loops[l].vertices.size();
    Places refined;
    const bool is_small = places[l].size() < 3;
    for (std::size_t i = 0; i < places[l].size(); ++i, ++segment) {
      const Place here = places[l][i], next = places[l][(i + 1) % places[l].size()];
      refined.push_back(here);
      if (!is_crossing[segment] && !is_small) continue;
      const std::size_t end = next.k + (i + 1 == places[l].size() ? n : 0);
      // The vertices between `here` and `next`.
      const std::size_t low = here.k + (here.fraction < 1 - kTuning.close ? 1 : 2),
                        high = next.fraction > kTuning.close ? end : end - 1;
      if (high < low) continue;
      refined.push_back({(low + high) / 2, 0.0f});
      added = true;
    }
    places[l] = std::move(refined);
  }
  return added;
}

}  // namespace pliant::host::bake
