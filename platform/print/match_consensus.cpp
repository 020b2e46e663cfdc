#include "print/match_consensus.hpp"

#include "base/heap_sort.hpp"
#include "print/distinct_best.hpp"

namespace pliant {

namespace {

/// Tuning of the consensus. Chosen on the poster of `fixtures/sheet` with `pliant bench print`, and judged
/// on two other prints (docs/evaluation.md, Start by print). What other values give was not recorded, except where it is told.
struct ConsensusTuning {
  /// Ratio of the scales that two matches suggest, at most.
  float most_scale_ratio = 1.6f;
  /// Cosine of half the angle between the rotations that two matches suggest, at least: 50 degrees apart, since views of the
  /// table are 43 degrees apart.
  float least_half_cosine = 0.9f;
  /// Of views that lead to one fit, and of which only the best is kept: rotations less than 20 degrees apart, and ratio of scales.
  /// 179 frames (docs/experiments.md, Start by print) were found, with 10 or 36 degrees 177, with all views 172.
  float same_half_cosine = 0.985f, same_scale_ratio = 1.3f;
};
constexpr ConsensusTuning kTuning;

bool has_like_scale(const SurfaceMatch& a, const SurfaceMatch& b) {
  return a.s <= kTuning.most_scale_ratio * b.s && b.s <= kTuning.most_scale_ratio * a.s;
}

/// The view that a match suggests: the place of the match is where it is seen.
View view_from(const SurfaceMatch& m, const Camera& camera) {
  View v;
  v.q = m.q;
  v.s = m.s;
  v.rho = clamp(m.s / camera.f, kMinRho, kMaxRho);
  v.c = {camera.cx, camera.cy};
  const Vec3 p = Projector(v, true).rotated(m.p);
  const float w = 1 + v.rho * p.z;
  v.tau = (w / v.s) * (m.x - v.c) - Vec2{p.x, p.y};
  return v;
}

/// Votes for a view, and matches that were compared.
struct Count {
  int votes = 0;
  std::uint32_t compared = 0;
};

Count count_votes(const ScaledMatches& matches, std::size_t place, const View& view, float tolerance_px) {
  const Projector projector(view, true);
  const SurfaceMatch& of = matches[place];
  Count count;
  // Beyond the first whose scale is too different there is none that agrees.
  const auto goes_on = [&](const SurfaceMatch& m) {
    if (!has_like_scale(m, of)) return false;
    ++count.compared;
    Vec2 x;
    if (is_similar(m, of) && projector.project(m.p, &x) && length(x - m.x) <= tolerance_px) ++count.votes;
    return true;
  };
  for (std::size_t k = place; k < matches.order.count && goes_on(matches[k]);) ++k;
  for (std::size_t k = place; k > 0 && goes_on(matches[k - 1]);) --k;
  return count;
}

/// Whether a view is nearly that which the match suggests.
bool is_same(const ViewVotes& view, const SurfaceMatch& of, const SurfaceMatch& m, float tolerance_mm) {
  Vec2 x;
  return half_cosine(of.q, m.q) >= kTuning.same_half_cosine && of.s <= kTuning.same_scale_ratio * m.s &&
         m.s <= kTuning.same_scale_ratio * of.s && Projector(view.view, true).project(m.p, &x) &&
         length(x - m.x) <= tolerance_mm * view.view.s;
}

}  // namespace

float half_cosine(const Quat& a, const Quat& b) {
  return magnitude(a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z);
}

bool is_similar(const SurfaceMatch& a, const SurfaceMatch& b) {
  return has_like_scale(a, b) && half_cosine(a.q, b.q) >= kTuning.least_half_cosine;
}

void ScaledMatches::sort() {
  for (std::size_t k = 0; k < order.count; ++k) order[k] = static_cast<std::uint16_t>(k);
  const SurfaceMatch* const m = all.data;
  heap_sort(order.data, order.count, [m](std::uint16_t a, std::uint16_t b) { return m[a].s < m[b].s; });
}

std::uint32_t vote_for_view(const ScaledMatches& matches, std::size_t place, const Camera& camera,
                            float tolerance_mm, Span<ViewVotes> views, std::size_t* count) {
  const View view = view_from(matches[place], camera);
  const Count counted = count_votes(matches, place, view, tolerance_mm * view.s);
  insert_distinct(
      views, count, {view, counted.votes, matches.order[place]},
      [](const ViewVotes& a, const ViewVotes& b) {
        return a.votes > b.votes || (a.votes == b.votes && a.match < b.match);
      },
      [&](const ViewVotes& a, const ViewVotes& b) {
        return is_same(a, matches.all[a.match], matches.all[b.match], tolerance_mm);
      });
  return counted.compared;
}

View mirrored_tilt(const View& view, Quat front) {
  const Quat turn = view.q * conjugate(front);
  // turn = tilt * roll, where roll is about the optical axis; w and z of the product are those of the roll, scaled.
  const Quat roll = normalised(Quat{turn.w, 0, 0, turn.z});
  const Quat tilt = turn * conjugate(roll);
  View mirrored = view;
  mirrored.q = normalised(conjugate(tilt) * (roll * front));
  return mirrored;
}

}  // namespace pliant
