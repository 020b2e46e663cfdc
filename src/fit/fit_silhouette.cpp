// Landmarks of the outline (jaw and cheeks), as two-dimensional annotations have them: on the edge of the face in the
// picture, whatever part of the surface makes it there. Each takes the nearest point of the model's apparent contour at the
// present pose and is held to it across the contour only. While its own place still faces the camera it stays there.
#include "fit/fit_problem.hpp"

namespace pliant {

namespace {

constexpr int kDepthCells = 48;
constexpr float kHiddenMarginMm = 6;
/// Cosine between normal and viewing ray below which a place counts as turned away.
constexpr float kTurnedAway = 0.1f;
/// How far a point of the contour may lie from a landmark's own place: along v, and along u as a share of the way to
/// the middle of the face, beyond which it is the nose's contour.
constexpr float kReachV = 0.12f, kReachU = 0.15f, kShareU = 0.6f;

bool is_within_reach(Vec2 own, Vec2 uv) {
  return magnitude(uv.y - own.y) <= kReachV &&
         magnitude(uv.x - own.x) <= max(kReachU, kShareU * magnitude(own.x - 0.5f));
}

}  // namespace

void Fitter::lay_out_silhouette(Arena& arena, const Model& model) {
  MeshLimits limits;
  limits.vertices = static_cast<std::uint16_t>(model.base_uv().count);
  limits.faces = static_cast<std::uint16_t>(model.base_corners().count / 3);
  mesh_.lay_out(arena, limits);
  depth_.lay_out(arena, kDepthCells, kDepthCells);
  finder_.lay_out(arena, limits.vertices);
  vertex_ = arena.take<Vec3>(limits.vertices);
  vertex_image_ = arena.take<Vec2>(limits.vertices);
  vertex_depth_ = arena.take<float>(limits.vertices);
  contour_ = arena.take_span<SilhouettePoint>(limits.vertices);
  silhouette_normal_ = arena.take<Vec2>(limits_.points);
}

Status Fitter::start_silhouette() {
  for (std::size_t i = 0; i < limits_.points; ++i) silhouette_normal_[i] = {};
  return mesh_.set_base(cascade_.model().base_uv(), cascade_.model().base_corners());
}

std::size_t Fitter::find_contour(const float* q, const Projector& projector) {
  cascade_.select(q);
  for (VertexId v : mesh_.vertices()) {
    vertex_[v] = cascade_.selected_point(mesh_.uv(v));
    vertex_depth_[v] =
        projector.project(vertex_[v], &vertex_image_[v]) ? projector.to_camera(vertex_[v]).z : -1.0f;
  }
  depth_.draw(mesh_, vertex_image_, vertex_depth_);
  const std::size_t found = finder_.find({mesh_, vertex_, vertex_image_, vertex_depth_}, projector, &depth_,
                                         kHiddenMarginMm, contour_);
  return found < contour_.count ? found : contour_.count;
}

/// Where an outline landmark is at the present pose, and the normal of the contour there; none while it faces the camera.
void Fitter::match(const FitProblem& problem, std::size_t point, const Projector& projector,
                   std::size_t found) {
  const Correspondence& c = problem.points[point];
  const SurfaceFrame own = cascade_.surface_frame(c.uv, problem.q);
  const Vec3 normal = projector.rotated(normalised(cross(own.pv, own.pu)));
  const bool turned_away = -dot(normal, normalised(projector.to_camera(own.p))) < kTurnedAway;
  Vec2 uv = c.uv, across;
  float nearest = 1e30f;
  for (std::size_t k = 0; turned_away && k < found; ++k) {
    const SilhouettePoint& o = contour_[k];
    const Vec2 off = o.x - c.x;
    if (o.is_border || !is_within_reach(c.uv, o.uv) || dot(off, off) >= nearest) continue;
    nearest = dot(off, off);
    uv = o.uv;
    across = o.normal;
  }
  silhouette_normal_[point] = across;
  cascade_.sample_point(uv, problem.q, samples_at(point));
}

void Fitter::match_silhouette(const FitProblem& problem) {
  const Projector projector(problem.view, true);
  const std::size_t found = find_contour(problem.q, projector);
  for (std::size_t i = 0; i < problem.points.count; ++i)
    if (problem.points[i].is_silhouette) match(problem, i, projector, found);
}

}  // namespace pliant
