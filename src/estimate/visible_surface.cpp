#include "estimate/visible_surface.hpp"

#include "base/integers.hpp"

namespace pliant {

namespace {
constexpr const VisibleSurfaceTuning& kTuning = kVisibleSurfaceTuning;
constexpr std::size_t kAllVertices = ~std::size_t{0};
constexpr Vec2 kNowhere{-1, -1};  // outside the chart

/// Whether all three lie farther than `reach` to one side of x.
bool are_beside(float x, float reach, float a, float b, float c) {
  const float low = x - reach, high = x + reach;
  return a > high ? b > high && c > high : a < low && b < low && c < low;
}

}  // namespace

void VisibleSurface::lay_out(Arena& arena, std::size_t parameters, const VisibleSurfaceLimits& limits) {
  MeshLimits mesh;
  mesh.vertices = limits.vertices;
  mesh.faces = static_cast<std::uint16_t>(smaller(2 * limits.vertices, MeshLimits::kMostFaces));
  arena.count_as(Purpose::mesh);
  mesh_.lay_out(arena, mesh);
  arena.count_as(Purpose::adaptation);
  Arena shared(limits.adaptation_memory.data, limits.adaptation_memory.count);
  adapter_.lay_out(limits.adaptation_memory.empty() ? arena : shared, mesh_.limits());
  PLIANT_ASSERT(!shared.exhausted());
  arena.count_as(Purpose::visibility);
  const int cells = limits.vertices <= kTuning.small_mesh ? kTuning.cells_small : kTuning.cells_large;
  depth_buffer_.lay_out(arena, cells, cells);
  contour_ = arena.take_span<SilhouettePoint>(kTuning.contour_points_per_point * limits.silhouette_points);
  finder_.lay_out(arena, limits.silhouette_points > 0 ? limits.vertices : 0);
  position_ = arena.take<Vec3>(limits.vertices);
  uv_ = arena.take<Vec2>(limits.samples_per_vertex > 0 ? limits.vertices : 0);
  surface_q_ = arena.take<float>(parameters);
  image_ = arena.take<Vec2>(limits.vertices);
  depth_ = arena.take<float>(limits.vertices);
  arena.count_as(Purpose::sampled_vertices);
  samples_ = arena.take<Vec3>(limits.vertices * limits.samples_per_vertex);
  samples_per_vertex_ = limits.samples_per_vertex;
  parameters_ = parameters;
}

Status VisibleSurface::start(const Model& model) {
  return mesh_.set_base(model.base_uv(), model.base_corners());
}

/// A vertex that takes one of these ids is sampled anew, also at the place of the one before.
void VisibleSurface::forget_unused_samples() {
  for (int v = 0; keeps_samples() && v < mesh_.limits().vertices; ++v)
    if (!mesh_.is_live_vertex(static_cast<VertexId>(v))) uv_[v] = kNowhere;
}

void VisibleSurface::adapt(Cascade& cascade, const ModelState& state, const MeshPolicy& policy,
                           bool keeps_vertices) {
  policy_ = policy;
  copy(state.q, parameters_, surface_q_);
  select_surface(cascade);
  const Surface surface{
      &cascade, [](void* context, Vec2 uv) { return static_cast<Cascade*>(context)->selected_point(uv); }};
  contour_criterion_ = {};
  contour_criterion_.mean_mm = policy.error_mm;
  contour_criterion_.max_mm = kTuning.most_over_mean_error * policy.error_mm;
  Criterion criterion = criterion_of(contour_criterion_);
  AdaptOptions options;
  if (policy.following != nullptr) {
    options.vertex_budget = policy.vertex_budget;
    criterion = (this->*policy.following->criterion)();
  }
  const bool adapts = policy.error_mm > 0 || policy.following != nullptr;
  if (adapts && adapter_.start(mesh_, surface, criterion) == Status::ok) adapter_.adapt(options);
  forget_unused_samples();  // a mesh that is kept has those of the person before, also of vertices that it has just lost
  if (keeps_samples()) first_outdated_ = 0;
  update(cascade, state, 0, 1, !keeps_vertices);
}

/// The surface that the mesh is adapted to. A vector that hardly moves a vertex bends a triangle by much less.
void VisibleSurface::select_surface(Cascade& cascade) const {
  cascade.select(surface_q_, kTuning.table_slack_mm);
}

void VisibleSurface::place_vertex(Cascade& cascade, const float* q, VertexId v) {
  uv_[v] = mesh_.uv(v);
  cascade.sample_point(uv_[v], q, samples_of(v), kTuning.sample_slack_mm);
  position_[v] = cascade.evaluate(samples_of(v), q);
}

void VisibleSurface::revise(const float* q, Quat turn) {
  copy(q, parameters_, surface_q_);
  has_new_surface_ = true;
  const Mat3 back = rotation_matrix(conjugate(in_model_axes(turn)));
  for (VertexId v : mesh_.vertices()) position_[v] = back * position_[v];
  if (keeps_samples()) first_outdated_ = 0;
  forget_unused_samples();
}

/// Samples `most` of the vertices again that are out of date.
void VisibleSurface::renew_vertices(Cascade& cascade, const float* q, std::size_t most) {
  if (first_outdated_ == kNone) return;
  for (VertexId v : mesh_.vertices()) {
    if (v < first_outdated_) continue;
    first_outdated_ = v;
    if (most-- == 0) return;
    place_vertex(cascade, q, v);
  }
  first_outdated_ = kNone;
}

/// Moves the vertices whose turn it is, or the others, but for those whose samples are out of date. \return how far the farthest
/// one moved, squared (mm^2).
float VisibleSurface::move_vertices(Cascade& cascade, const float* q, VertexTurn turn, bool others) {
  constexpr int kAhead = 8;  // vertices; of each number of them chosen in turn, a multiple
  float farthest = 0;
  for (VertexId v : mesh_.vertices()) {
    if (v >= first_outdated_) break;
    if (turn.is_of(v) == others) continue;
    if (keeps_samples() && v + kAhead < mesh_.vertex_count())
      prefetch_samples(samples_of(static_cast<VertexId>(v + kAhead)));
    const Vec3 p = keeps_samples() ? cascade.evaluate(samples_of(v), q) : cascade.selected_point(mesh_.uv(v)),
               step = p - position_[v];
    farthest = max(farthest, dot(step, step));
    position_[v] = p;
  }
  return farthest;
}

void VisibleSurface::update(Cascade& cascade, const ModelState& state, std::uint32_t frame,
                            std::uint32_t interval, bool is_exact) {
  constexpr float kFastMm = kTuning.fast_fraction * kVisibilityTuning.hidden_margin_mm;
  if (!keeps_samples()) cascade.select(state.q, is_exact ? 0.0f : kTuning.table_slack_mm);
  renew_vertices(cascade, state.q,
                 is_exact ? kAllVertices : renewed_vertices(static_cast<std::size_t>(mesh_.vertex_count())));
  const VertexTurn turn{frame, interval};
  const bool is_fast = move_vertices(cascade, state.q, turn, false) > kFastMm * kFastMm;
  if (is_fast) move_vertices(cascade, state.q, turn, true);
  if (is_fast || interval <= 1) depth_is_drawn_ = false;
  project(state.view);
}

void VisibleSurface::turn_to(const View& view) {
  depth_is_drawn_ = false;
  project(view);
}

void VisibleSurface::project(const View& view) {
  const Projector projector(view, true);
  for (VertexId v : mesh_.vertices()) {
    const Vec3 r = projector.rotated(position_[v]);
    const bool is_in_front = projector.project_rotated(r, &image_[v]);
    depth_[v] = is_in_front ? max(kTuning.nominal_distance_mm + r.z, kTuning.nearest_mm) : -1.0f;
    if (!is_in_front) image_[v] = view.c;  // some read it all the same
  }
  images_are_current_ = true;
}

void VisibleSurface::draw_depth(const View& view, std::uint32_t frame) {
  const Vec3 turn = log_rotation(view.q * conjugate(drawn_view_.q));
  constexpr float kTurn = kTuning.drawing_turn_rad;
  const bool is_near =
      dot(turn, turn) < kTurn * kTurn && magnitude(view.s - drawn_view_.s) < kTuning.drawing_scale * view.s;
  if (depth_is_drawn_ && is_near && frame - drawn_frame_ < kTuning.drawing_frames) {
    depth_buffer_.move(view.s * (view.tau - drawn_view_.tau));
    drawn_view_.tau = view.tau;
    return;
  }
  project(view);  // a solve may have moved the view
  depth_buffer_.draw(mesh_, image_, depth_);
  drawn_view_ = view;
  drawn_frame_ = frame;
  depth_is_drawn_ = true;
}

bool VisibleSurface::hides(Vec2 x, Vec3 rotated) const {
  PLIANT_ASSERT(depth_is_drawn_);
  return depth_buffer_.hides(x, kTuning.nominal_distance_mm + rotated.z, kVisibilityTuning.hidden_margin_mm);
}

Span<const SilhouettePoint> VisibleSurface::find_contour(const View& view, std::uint32_t frame) {
  draw_depth(view, frame);
  if (!images_are_current_) project(view);
  const Projector projector(view, true);
  const std::size_t all = finder_.find({mesh_, position_, image_, depth_}, projector, &depth_buffer_,
                                       kVisibilityTuning.hidden_margin_mm, contour_);
  std::size_t count = 0;
  for (std::size_t k = 0; k < smaller(all, contour_.count); ++k)
    if (!contour_[k].is_border)
      contour_[count++] = contour_[k];  // where the mesh ends there need not be an image edge
  return {contour_.data, count};
}

/// The nearest visible point on the flat faces; of several, the one nearest to the camera. A face is skipped if it lies
/// farther to one side than the best one so far.
float VisibleSurface::nearest_on_mesh(Vec2 x, Vec2* uv) const {
  float best = 1e30f, best_depth = 1e30f, distance = -1, reach = 1e30f;
  for (FaceId f : mesh_.faces()) {
    const VertexId a = mesh_.corner(f, 0), b = mesh_.corner(f, 1), c = mesh_.corner(f, 2);
    if (are_beside(x.x, reach, image_[a].x, image_[b].x, image_[c].x) ||
        are_beside(x.y, reach, image_[a].y, image_[b].y, image_[c].y))
      continue;
    if (depth_[a] <= 0 || depth_[b] <= 0 || depth_[c] <= 0 || !faces_camera(mesh_, image_, f)) continue;
    float w[3];
    const float d2 = nearest_on_triangle(image_[a], image_[b], image_[c], x, w);
    const float depth = w[0] * depth_[a] + w[1] * depth_[b] + w[2] * depth_[c];
    if (d2 > best || (d2 == best && depth >= best_depth)) continue;
    best = d2;
    best_depth = depth;
    *uv = w[0] * mesh_.uv(a) + (w[1] * mesh_.uv(b) + w[2] * mesh_.uv(c));
    distance = reach = square_root(d2);
  }
  return distance;
}

float VisibleSurface::surface_at(Cascade& cascade, const ModelState& state, Vec2 x, Vec2* uv) {
  if (!images_are_current_) project(state.view);
  const float distance = nearest_on_mesh(x, uv);
  if (distance != 0) return distance;
  const float off = refine_uv(cascade, state, x, uv);
  return off > kTuning.newton_far_px ? off : 0.0f;
}

float VisibleSurface::refine_uv(Cascade& cascade, const ModelState& state, Vec2 x, Vec2* uv) {
  const Projector projector(state.view, true);
  cascade.select(state.q, 0);
  Vec2 at = *uv;
  float flat = 1e30f;  // distance of the point on the flat face
  for (int k = 0;; ++k) {
    const SurfaceFrame frame = cascade.selected_frame(at);
    Vec2 image;
    Projector::Derivatives d;
    if (!projector.project(frame.p, &image, &d)) return flat;
    const Vec2 along_u = d.along(frame.pu), along_v = d.along(frame.pv), off = x - image;
    const float distance = length(off);
    if (k == 0) flat = distance;
    if (distance < kTuning.newton_near_px || k == kTuning.newton_steps) {
      *uv = at;
      return distance;
    }
    const Mat2 jacobian{along_u.x, along_v.x, along_u.y, along_v.y};
    if (magnitude(determinant(jacobian)) < kTuning.newton_least_area_px2) return flat;
    const Vec2 step = inverse(jacobian) * off;
    if (!(dot(step, step) < kTuning.newton_most_step * kTuning.newton_most_step)) return flat;
    at = {clamp(at.x + step.x, 0, 1), clamp(at.y + step.y, 0, 1)};
  }
}

}  // namespace pliant
