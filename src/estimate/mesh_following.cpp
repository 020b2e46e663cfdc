// The mesh of a visible surface, refined where the view and the texture ask for it, frame by frame (docs/algorithms.md, section
// 2.5). A program that does not name kMeshFollowing does not link it.
#include "estimate/visible_surface.hpp"
#include "pliant/estimator_options.hpp"

namespace pliant {

namespace {
constexpr const VisibleSurfaceTuning& kTuning = kVisibleSurfaceTuning;
}  // namespace

const MeshFollowing kMeshFollowing{&VisibleSurface::view_criterion, &VisibleSurface::adapt_to_view};

Criterion VisibleSurface::view_criterion() {
  const Criterion of_view = criterion_of(policy_.view);
  if (policy_.texture.score == nullptr) return of_view;
  view_and_texture_ = {of_view, criterion_of(policy_.texture)};
  return criterion_of(view_and_texture_);
}

void VisibleSurface::adapt_to_view(Cascade& cascade, const ModelState& state, std::uint32_t frame) {
  select_surface(cascade);
  if (has_new_surface_) adapter_.resample();
  has_new_surface_ = false;
  policy_.view.pose = pose_of(state.view);
  constexpr int kParts = kTuning.rank_interval_frames;
  adapter_.rerank(static_cast<int>(frame % static_cast<std::uint32_t>(kParts)), kParts);
  AdaptOptions options;
  options.vertex_budget = policy_.vertex_budget;
  options.max_operations = policy_.operations;
  const AdaptReport report = adapter_.adapt(options);
  if (report.splits + report.welds == 0) return;
  if (!keeps_samples()) return update(cascade, state, frame, 1, true);
  // One that is welded before its turn to be renewed would keep its samples, where a split takes its id for the same place.
  if (first_outdated_ != kNone) forget_unused_samples();
  for (VertexId v : mesh_.vertices()) {
    const Vec2 uv = mesh_.uv(v);
    if (uv.x != uv_[v].x || uv.y != uv_[v].y) place_vertex(cascade, state.q, v);
  }
}

}  // namespace pliant
