#include "fit/silhouette_matcher.hpp"

#include "base/integers.hpp"
#include "fit/fit_tuning.hpp"

namespace pliant {

namespace {

constexpr const SilhouetteMatchTuning& kTuning = kSilhouetteMatchTuning;

bool is_within_reach(Vec2 own, Vec2 uv) {
  const float reach_u = max(kTuning.reach_u, kTuning.reach_u_fraction * magnitude(own.x - 0.5f));
  return magnitude(uv.y - own.y) <= kTuning.reach_v && magnitude(uv.x - own.x) <= reach_u;
}

}  // namespace

bool SilhouetteMatcher::is_turned_away(Cascade& cascade, const float* q, const Projector& projector,
                                       Vec2 uv) {
  const SurfaceFrame own = cascade.surface_frame(uv, q);
  const Vec3 normal = projector.rotated(normalised(cross(own.pv, own.pu)));
  return -dot(normal, normalised(projector.to_camera(own.p))) < kTuning.turned_away_cosine;
}

void SilhouetteMatcher::lay_out(Arena& arena, const Model& model) {
  MeshLimits limits;
  limits.vertices = static_cast<std::uint16_t>(model.base_uv().count);
  limits.faces = static_cast<std::uint16_t>(model.base_corners().count / 3);
  mesh_.lay_out(arena, limits);
  depth_.lay_out(arena, kTuning.depth_cells, kTuning.depth_cells);
  finder_.lay_out(arena, limits.vertices);
  image_ = arena.take<Vec2>(limits.vertices);
  vertex_depth_ = arena.take<float>(limits.vertices);
  contour_ = arena.take_span<SilhouettePoint>(limits.vertices);
}

Status SilhouetteMatcher::start(const Model& model) {
  found_ = 0;
  return mesh_.face_count() > 0 ? Status::ok : mesh_.set_base(model.base_uv(), model.base_corners());
}

void SilhouetteMatcher::find_contour(const Vec3* position, const Projector& projector) {
  for (VertexId v : mesh_.vertices())
    vertex_depth_[v] =
        projector.project(position[v], &image_[v]) ? projector.to_camera(position[v]).z : -1.0f;
  depth_.draw(mesh_, image_, vertex_depth_);
  const std::size_t found = finder_.find({mesh_, position, image_, vertex_depth_}, projector, &depth_,
                                         kVisibilityTuning.hidden_margin_mm, contour_);
  found_ = smaller(found, contour_.count);
}

SilhouetteMatch SilhouetteMatcher::nearest(const Correspondence& landmark) const {
  SilhouetteMatch best{landmark.uv, {}};
  float nearest = 1e30f;
  for (std::size_t k = 0; k < found_; ++k) {
    const SilhouettePoint& o = contour_[k];
    const Vec2 off = o.x - landmark.x;
    if (o.is_border || !is_within_reach(landmark.uv, o.uv) || dot(off, off) >= nearest) continue;
    nearest = dot(off, off);
    best = {o.uv, o.normal};
  }
  return best;
}

}  // namespace pliant
