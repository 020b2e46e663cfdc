// The estimator's mesh: what it is adapted to, where its vertices are, and which surface lies under a pixel.
#include "estimate/estimator_depth.hpp"
#include "pliant/criteria.hpp"
#include "pliant/estimator.hpp"

namespace pliant {

void Estimator::adapt_mesh() {
  for (std::size_t i = 0; i < cascade_.parameter_count(); ++i) mesh_q_[i] = q_[i];
  cascade_.select(mesh_q_);
  const Surface surface{
      &cascade_, [](void* context, Vec2 uv) { return static_cast<Cascade*>(context)->selected_point(uv); }};
  contour_ = {};
  contour_.mean_mm = options_.mesh_error_mm;
  contour_.max_mm = 4 * options_.mesh_error_mm;
  Criterion criterion = criterion_of(contour_);
  AdaptOptions options;
  if (options_.mesh_operations > 0) {
    options.vertex_budget = options_.vertex_budget;
    view_criterion_.pose = pose_of(view_);
    view_criterion_.focal_px = camera_.f;
    view_criterion_.cx = camera_.cx;
    view_criterion_.cy = camera_.cy;
    view_criterion_.width_px = static_cast<float>(width_);
    view_criterion_.height_px = static_cast<float>(height_);
    view_criterion_.tolerance_px = options_.mesh_error_px;
    criterion = criterion_of(view_criterion_);
    if (options_.texture.score != nullptr) {
      view_and_texture_ = {criterion, criterion_of(options_.texture)};
      criterion = criterion_of(view_and_texture_);
    }
  }
  if (adapter_.start(mesh_, surface, criterion) == Status::ok) adapter_.adapt(options);
  if (!limits_.samples_vertices) return;
  for (VertexId v : mesh_.vertices()) place_vertex(v);
}

/// Ranks a share of the mesh for the view as it is now, and moves some vertices to where they are worth more. The surface
/// is that of the start: its errors turn with the pose, and no expression makes ranks of different times contradict.
void Estimator::follow_view() {
  if (options_.mesh_operations == 0) return;
  cascade_.select(mesh_q_);
  view_criterion_.pose = pose_of(view_);
  const int share = options_.rank_interval_frames > 0 ? options_.rank_interval_frames : 1;
  adapter_.rerank(static_cast<int>(frame_ % static_cast<std::uint32_t>(share)), share);
  AdaptOptions options;
  options.vertex_budget = options_.vertex_budget;
  options.max_operations = options_.mesh_operations;
  const AdaptReport report = adapter_.adapt(options);
  if (report.splits + report.welds == 0) return;
  if (!limits_.samples_vertices) return update_vertices(1);
  for (VertexId v : mesh_.vertices()) {
    const Vec2 uv = mesh_.uv(v);
    if (uv.x != vertex_uv_[v].x || uv.y != vertex_uv_[v].y) place_vertex(v);
  }
}

/// Bakes a vertex that is new, or whose id is.
void Estimator::place_vertex(VertexId v) {
  vertex_uv_[v] = mesh_.uv(v);
  cascade_.sample_point(vertex_uv_[v], q_, samples_of_vertex(v), kSampleSlackMm);
  vertex_[v] = cascade_.evaluate(samples_of_vertex(v), q_);
}

/// Moves one vertex in `share`. \return how far the farthest went, squared (mm^2).
float Estimator::move_vertices(std::uint32_t share) {
  if (!limits_.samples_vertices) cascade_.select(q_, share > 1 ? kVertexSlackMm : 0.0f);
  float farthest = 0;
  for (VertexId v : mesh_.vertices()) {
    if (share > 1 && (v + frame_) % share != 0) continue;
    const Vec3 p = limits_.samples_vertices ? cascade_.evaluate(samples_of_vertex(v), q_)
                                          : cascade_.selected_point(mesh_.uv(v)),
               way = p - vertex_[v];
    farthest = max(farthest, dot(way, way));
    vertex_[v] = p;
  }
  return farthest;
}

/// Moves one vertex in `share`; all, with what hides what drawn anew, where a jaw drops so fast that it would be hidden by
/// where it was.
void Estimator::update_vertices(std::uint32_t share) {
  constexpr float kMostMm = 0.75f * kHiddenMarginMm;  // the rest is for the frames that a drawing serves
  const bool is_fast = move_vertices(share) > kMostMm * kMostMm;
  if (is_fast && share > 1) move_vertices(1);
  if (is_fast || share <= 1) depth_is_drawn_ = false;
  project_vertices();
}

void Estimator::refresh_vertices() {
  if (started_) update_vertices(1);
}

/// Image and depth of the vertices where they are, and what they hide.
void Estimator::project_vertices() {
  const Projector projector(view_, true);
  for (VertexId v : mesh_.vertices())
    vertex_depth_[v] = projector.project(vertex_[v], &vertex_image_[v])
                           ? kNominalDepthMm + projector.rotated(vertex_[v]).z
                           : -1.0f;
  vertices_are_current_ = true;
}

/// What hides what is drawn when somebody asks; while the view is nearly the one that it was drawn for, it moves along.
void Estimator::draw_depth() {
  constexpr std::uint32_t kMostFrames = 3;
  constexpr float kTurn = 0.03f, kGrowth = 0.03f;  // rad; of the scale: less than a cell at the outline
  const Vec3 turn = log_rotation(view_.q * conjugate(depth_view_.q));
  const bool is_near =
      dot(turn, turn) < kTurn * kTurn && magnitude(view_.s - depth_view_.s) < kGrowth * view_.s;
  if (depth_is_drawn_ && is_near && frame_ - depth_frame_ < kMostFrames) {
    depth_.move(view_.s * (view_.tau - depth_view_.tau));
    depth_view_.tau = view_.tau;
    return;
  }
  project_vertices();  // a solve may have moved the view
  depth_.draw(mesh_, vertex_image_, vertex_depth_);
  depth_view_ = view_;
  depth_frame_ = frame_;
  depth_is_drawn_ = true;
}

bool Estimator::project(Vec2 uv, Vec2* x) {
  Vec2 ideal;
  if (!Projector(view_, true).project(cascade_.surface_point(uv, q_), &ideal)) return false;
  *x = lens_.distort(ideal);
  return true;
}

float Estimator::surface_at(Vec2 seen, Vec2* uv) {
  if (!vertices_are_current_) project_vertices();
  const Vec2 x = lens_.undistort(seen);
  float best = 1e30f, best_depth = 1e30f, distance = -1;
  for (FaceId f : mesh_.faces()) {
    const VertexId a = mesh_.corner(f, 0), b = mesh_.corner(f, 1), c = mesh_.corner(f, 2);
    if (vertex_depth_[a] <= 0 || vertex_depth_[b] <= 0 || vertex_depth_[c] <= 0 ||
        !faces_camera(mesh_, vertex_image_, f))
      continue;
    float w[3];
    const float d2 = nearest_on_triangle(vertex_image_[a], vertex_image_[b], vertex_image_[c], x, w);
    const float depth = w[0] * vertex_depth_[a] + w[1] * vertex_depth_[b] + w[2] * vertex_depth_[c];
    if (d2 > best || (d2 == best && depth >= best_depth)) continue;
    best = d2;
    best_depth = depth;
    *uv = w[0] * mesh_.uv(a) + (w[1] * mesh_.uv(b) + w[2] * mesh_.uv(c));
    distance = square_root(d2);
  }
  if (distance != 0) return distance;
  // Newton on the surface itself: the mesh is flat between its vertices.
  const Projector projector(view_, true);
  Vec2 at = *uv;
  for (int k = 0; k < 4; ++k) {
    const SurfaceFrame frame = cascade_.surface_frame(at, q_);
    Vec2 image;
    Projector::Derivatives d;
    if (!projector.project(frame.p, &image, &d)) return distance;
    const Vec2 along_u = d.along(frame.pu), along_v = d.along(frame.pv), off = x - image;
    if (dot(off, off) < 1e-6f) break;
    const Mat2 jacobian{along_u.x, along_v.x, along_u.y, along_v.y};
    if (magnitude(determinant(jacobian)) < 1e-3f) return distance;
    const Vec2 step = inverse(jacobian) * off;
    if (!(dot(step, step) < 1e-2f)) return distance;
    at = {clamp(at.x + step.x, 0, 1), clamp(at.y + step.y, 0, 1)};
  }
  *uv = at;
  return distance;
}

}  // namespace pliant
