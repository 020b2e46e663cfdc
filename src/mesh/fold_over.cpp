// Fold-over of faces (docs/algorithms.md, section 3.5). Along q + a d the corners of a face are p_i + a e_i when the cascade
// is linear. The dot product of the face's cross product (not normalised) with its unit normal at rest is then exactly
// g(a) = c0 + c1 a + c2 a^2. The face folds over at the first root.
#include "pliant/fold_over.hpp"

#include "mesh/mesh_tuning.hpp"

namespace pliant {

namespace {

struct Edges {
  Vec3 a, b;
};

Edges edges_of(Span<const std::uint16_t> corners, std::size_t face, const Vec3* position) {
  const Vec3 p = position[corners[3 * face]];
  return {position[corners[3 * face + 1]] - p, position[corners[3 * face + 2]] - p};
}

/// The smallest a in (0, 1] with c0 + c1 a + c2 a^2 <= 0, for c0 > 0; 2 where there is none.
float first_root(float c0, float c1, float c2) {
  const float discriminant = c1 * c1 - 4 * c2 * c0;
  if (discriminant < 0) return 2;
  // Of the two roots 2 c0 / (-c1 +- sqrt(.)) the smallest positive one has the largest positive denominator.
  const float denominator = -c1 + square_root(discriminant);
  if (!(denominator > 0)) return 2;
  const float root = 2 * c0 / denominator;
  return root <= 1 ? root : 2.0f;
}

}  // namespace

float orientation(const SurfaceFrame& now, const SurfaceFrame& rest) {
  return dot(normalised(cross(now.pu, now.pv)), normalised(cross(rest.pu, rest.pv)));
}

void FoldOverTest::lay_out(Arena& arena, const Model& model) {
  model_ = model;
  rest_normal_ = arena.take<Vec3>(model.base_corners().count / 3);
  position_ = arena.take<Vec3>(model.base_uv().count);
  q_ = arena.take<float>(model.parameters().count);
  vertex_count_ = watched_count_ = 0;
}

void FoldOverTest::compute_positions(Cascade& cascade, const float* q, Vec3* position, float slack_mm) const {
  cascade.select(q, slack_mm);
  for (std::size_t v = 0; v < model_.base_uv().count; ++v)
    position[v] = cascade.selected_point(model_.base_uv()[v]);
}

void FoldOverTest::start_at_rest(Cascade& cascade) {
  const auto corners = model_.base_corners();
  for (std::size_t k = 0; k < model_.parameters().count; ++k) q_[k] = 0;
  compute_positions(cascade, q_, position_);
  watched_count_ = 0;
  for (std::size_t f = 0; f < corners.count / 3; ++f) {
    const Edges e = edges_of(corners, f, position_);
    rest_normal_[f] = normalised(cross(e.a, e.b));
    watched_count_ += dot(rest_normal_[f], rest_normal_[f]) > 0;
  }
  vertex_count_ = model_.base_uv().count;
}

void FoldOverTest::start(Cascade& cascade) {
  start_at_rest(cascade);
  const auto corners = model_.base_corners();
  const auto parameters = model_.parameters();
  const std::size_t faces = corners.count / 3;
  for (std::size_t k = 0; k < parameters.count; ++k)
    for (int side = 0; side < 2; ++side) {
      const float limit = side == 0 ? parameters[k].minimum : parameters[k].maximum;
      if (limit == 0) continue;
      q_[k] = limit;
      compute_positions(cascade, q_, position_);
      q_[k] = 0;
      for (std::size_t f = 0; f < faces; ++f) {
        const Edges e = edges_of(corners, f, position_);
        if (!(dot(cross(e.a, e.b), rest_normal_[f]) > 0)) rest_normal_[f] = {};
      }
    }
  watched_count_ = 0;
  for (std::size_t f = 0; f < faces; ++f) watched_count_ += dot(rest_normal_[f], rest_normal_[f]) > 0;
}

std::size_t FoldOverTest::count_folded(const Vec3* position) const {
  PLIANT_ASSERT(is_started());
  const auto corners = model_.base_corners();
  std::size_t folded = 0;
  for (std::size_t f = 0; f < corners.count / 3; ++f) {
    const Vec3 n = rest_normal_[f];
    const Edges e = edges_of(corners, f, position);
    folded += dot(n, n) > 0 && !(dot(cross(e.a, e.b), n) > 0);
  }
  return folded;
}

float FoldOverTest::step_fraction(const Vec3* from, const Vec3* to) const {
  PLIANT_ASSERT(is_started());
  const auto corners = model_.base_corners();
  float first = 2;
  for (std::size_t f = 0; f < corners.count / 3; ++f) {
    const Vec3 n = rest_normal_[f];
    const Edges e = edges_of(corners, f, from), end = edges_of(corners, f, to);
    const float c0 = dot(cross(e.a, e.b), n);
    if (!(c0 > 0)) continue;  // not watched, or folded before
    const Vec3 da = end.a - e.a, db = end.b - e.b;
    const float c1 = dot(cross(e.a, db) + cross(da, e.b), n), c2 = dot(cross(da, db), n);
    first = min(first, first_root(c0, c1, c2));
    if (!(dot(cross(end.a, end.b), n) > 0)) first = min(first, 1);  // though rounding has the root beyond it
  }
  return first > 1 ? 1.0f : kFoldOverTuning.safe_fraction * first;
}

}  // namespace pliant
