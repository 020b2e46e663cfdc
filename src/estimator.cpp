// One tracked model over time (the paper, section 8 and Appendix A). Each observation is an image force f_i on a surface
// point; instead of the Euler steps of Eq. 13 the generalised force of Eq. 9 meets the Gauss-Newton matrix of the same
// sum, with the parameters' prior, a temporal prior around the prediction, and a robust weight for outliers.
#include "pliant/estimator.hpp"

#include "estimator_problem.hpp"
#include "pliant/criteria.hpp"

namespace pliant {

namespace {

constexpr int kDepthCells = 48;
constexpr float kHiddenMarginMm = 6;
// Depths are compared at a nominal distance: what hides what depends on the model's shape and turn, and hardly on how
// far away the next solve finds it.
constexpr float kNominalDepthMm = 1000;

/// W (I + s^2 W)^-1: the information that is left when an error of deviation s is added. Keeps rank one.
Sym2 with_added_error(Sym2 w, float s) {
  const float s2 = s * s;
  const float a = 1 + s2 * w.xx, b = s2 * w.xy, d = 1 + s2 * w.yy;
  const float inverse = 1.0f / (a * d - b * b);
  return {inverse * (w.xx * d - w.xy * b), inverse * (w.xy * a - w.xx * b), inverse * (w.yy * a - w.xy * b)};
}

}  // namespace

void Estimator::lay_out(Arena& arena, const Model& model, const EstimatorLimits& limits) {
  limits_ = limits;
  cascade_.lay_out(arena, model);
  MeshLimits mesh;
  mesh.vertices = limits.vertices;
  const unsigned faces = 2u * limits.vertices;
  mesh.faces = static_cast<std::uint16_t>(faces < 21845u ? faces : 21845u);
  mesh_.lay_out(arena, mesh);
  adapter_.lay_out(arena, mesh);
  depth_.lay_out(arena, kDepthCells, kDepthCells);
  const std::size_t parameters = model.parameters().count, records = model.cascade().count;
  const auto at_most = [](std::size_t limit, std::size_t all) {
    return limit > 0 && limit < all ? limit : all;
  };
  const std::size_t unknowns = at_most(limits.free_parameters, parameters) + kPoseUnknowns;
  equations_.lay_out(arena, unknowns);
  baked_capacity_ = at_most(limits.baked_samples, records);
  in_use_ = arena.take<std::uint8_t>(limits.points);
  uv_ = arena.take<Vec2>(limits.points);
  tangent_u_ = arena.take<Vec3>(limits.points);
  tangent_v_ = arena.take<Vec3>(limits.points);
  baked_points_ = arena.take<Vec3>(limits.points * baked_capacity_);
  predictions_ = arena.take<Prediction>(limits.points);
  lengths_ = arena.take<float>(limits.points);
  usable_ = arena.take<std::uint16_t>(limits.points);
  information_ = arena.take<Sym2>(limits.points);
  baked_vertices_ = arena.take<Vec3>(limits.bakes_vertices ? limits.vertices * baked_capacity_ : 0);
  vertex_ = arena.take<Vec3>(limits.vertices);
  vertex_image_ = arena.take<Vec2>(limits.vertices);
  vertex_depth_ = arena.take<float>(limits.vertices);
  float** const per_parameter[] = {&q_, &expected_q_, &trial_q_, &sd_, &trusted_q_};
  for (float** vector : per_parameter) *vector = arena.take<float>(parameters);
  step_ = arena.take<float>(unknowns);
  unknown_ = arena.take<std::uint16_t>(unknowns);
  column_ = arena.take<Vec2>(unknowns);
  started_ = false;
}

Status Estimator::start(const Camera& camera, int width, int height, const Pose& pose, const float* q,
                        const std::uint8_t* is_free, const EstimatorOptions& options) {
  if (q == nullptr || width <= 0 || height <= 0 || !is_finite(pose) || !(pose.t.z > 0) || !(camera.f > 0) ||
      !is_finite(camera.f) || !is_finite(Vec2{camera.cx, camera.cy}))
    return Status::bad_argument;
  const std::size_t parameters = cascade_.parameter_count();
  for (std::size_t i = 0; i < parameters; ++i)
    if (!is_finite(q[i])) return Status::bad_argument;
  started_ = false;
  Status status = choose_free(is_free);
  if (status == Status::ok) status = mesh_.set_base(model().base_uv(), model().base_corners());
  if (status != Status::ok) return status;

  camera_ = camera;
  width_ = width;
  height_ = height;
  options_ = options;
  view_ = view_of(pose, camera);
  view_.q = normalised(pose.q);
  trusted_view_ = view_;
  for (std::size_t i = 0; i < parameters; ++i) {
    const Parameter& p = model().parameters()[i];
    q_[i] = expected_q_[i] = trusted_q_[i] = clamp(q[i], p.minimum, p.maximum);
  }
  for (std::size_t i = 0; i < limits_.points; ++i) in_use_[i] = 0;
  time_ns_ = 0;
  seconds_ = 0;
  frame_ = 0;
  bad_frames_ = 0;
  looked_for_ = 0;
  adapt_mesh();
  started_ = true;
  update_vertices(1);
  result_ = {
      TrackState::tracking, pose_of(view_), 0, 0, 0, 0, static_cast<std::uint16_t>(mesh_.vertex_count())};
  return Status::ok;
}

Status Estimator::choose_free(const std::uint8_t* is_free) {
  if (is_free != nullptr)
    cascade_.set_free(is_free);
  else
    cascade_.set_free(Group::expression);
  baked_stride_ = cascade_.baked_count();
  const bool fits =
      baked_stride_ <= baked_capacity_ && cascade_.column_count() + kPoseUnknowns <= equations_.capacity();
  return fits ? Status::ok : Status::capacity;
}

void Estimator::adapt_mesh() {
  cascade_.select(q_);
  const Surface surface{
      &cascade_, [](void* context, Vec2 uv) { return static_cast<Cascade*>(context)->selected_point(uv); }};
  ContourOptions contour;
  contour.mean_mm = options_.mesh_error_mm;
  contour.max_mm = 4 * options_.mesh_error_mm;
  if (adapter_.start(mesh_, surface, criterion_of(contour)) == Status::ok) adapter_.adapt(AdaptOptions{});
  if (!limits_.bakes_vertices) return;
  for (VertexId v : mesh_.vertices()) cascade_.bake(mesh_.uv(v), q_, baked_vertex(v));
}

/// Moves one vertex in `share`.
void Estimator::update_vertices(std::uint32_t share) {
  if (!limits_.bakes_vertices) cascade_.select(q_);
  for (VertexId v : mesh_.vertices()) {
    if (share > 1 && (v + frame_) % share != 0) continue;
    vertex_[v] = limits_.bakes_vertices ? cascade_.evaluate(baked_vertex(v), q_)
                                        : cascade_.selected_point(mesh_.uv(v));
  }
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
  depth_.draw(mesh_, vertex_image_, vertex_depth_);
  vertices_are_current_ = true;
}

Status Estimator::add_point(Vec2 uv, std::uint16_t* id) {
  if (!started_) return Status::not_started;
  if (id == nullptr || !(uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1)) return Status::bad_argument;
  std::uint16_t i = 0;
  while (i < limits_.points && in_use_[i]) ++i;
  if (i == limits_.points) return Status::capacity;
  in_use_[i] = 1;
  uv_[i] = uv;
  cascade_.bake(uv, q_, baked_point(i));
  update_tangents(i);
  *id = i;
  return Status::ok;
}

void Estimator::remove_point(std::uint16_t id) {
  if (id < limits_.points) in_use_[id] = 0;
}

void Estimator::begin(std::int64_t time_ns) {
  constexpr float kNominal = 1.0f / 30;
  const std::int64_t elapsed = time_ns - time_ns_;
  seconds_ = elapsed > 0 && elapsed < 2'000'000'000 ? static_cast<float>(elapsed) * 1e-9f : kNominal;
  time_ns_ = time_ns;
  for (std::size_t i = 0; i < cascade_.parameter_count(); ++i) {
    const Parameter& p = model().parameters()[i];
    expected_q_[i] = q_[i];
    sd_[i] = options_.expression_rate * (p.maximum - p.minimum) * min(seconds_, 0.5f);
  }
  looked_for_ = 0;
  result_.tracked = result_.inliers = result_.iterations = 0;
  result_.rms_px = 0;
  ++frame_;
  const std::uint32_t share = options_.tangent_share > 0 ? options_.tangent_share : 1;
  for (std::uint16_t i = 0; i < limits_.points; ++i)
    if (in_use_[i] && (i + frame_) % share == 0) update_tangents(i);
}

void Estimator::shift(Vec2 px) {
  if (!is_finite(px)) return;
  view_.tau = view_.tau + (1.0f / view_.s) * px;
  vertices_are_current_ = false;
}

void Estimator::propose(const View& view) {
  view_ = view;
  for (std::size_t i = 0; i < cascade_.parameter_count(); ++i) q_[i] = trusted_q_[i];
  update_vertices(1);
}

void Estimator::update_tangents(std::uint16_t id) {
  const SurfaceFrame frame = cascade_.surface_frame(uv_[id], q_);
  tangent_u_[id] = frame.pu;
  tangent_v_[id] = frame.pv;
}

Prediction Estimator::prediction(std::uint16_t id, const Projector& projector) {
  Prediction out;
  out.id = id;
  const Vec3 p = cascade_.evaluate(baked_point(id), q_);
  Projector::Derivatives d;
  if (!projector.project(p, &out.x, &d)) return out;
  const Vec2 along_u = d.along(tangent_u_[id]), along_v = d.along(tangent_v_[id]);
  out.jacobian = {along_u.x, along_v.x, along_u.y, along_v.y};
  const Vec3 to_point = projector.to_camera(p);
  const Vec3 normal = projector.rotated(normalised(cross(tangent_v_[id], tangent_u_[id])));
  out.facing = -dot(normal, normalised(to_point));
  // How far the state may have moved since the last frame: turn, scale and shift, independent.
  const float sd[kPoseUnknowns] = {0.03f, 0.03f, 0.03f, 0.02f, 4, 4};
  for (int k = 0; k < kPoseUnknowns; ++k) {
    const float v = sd[k] * sd[k];
    out.covariance.xx += v * d.pose[k].x * d.pose[k].x;
    out.covariance.xy += v * d.pose[k].x * d.pose[k].y;
    out.covariance.yy += v * d.pose[k].y * d.pose[k].y;
  }
  const bool inside = out.x.x >= 0 && out.x.y >= 0 && out.x.x <= static_cast<float>(width_ - 1) &&
                      out.x.y <= static_cast<float>(height_ - 1);
  out.visible = inside && out.facing >= options_.min_facing &&
                !depth_.hides(out.x, kNominalDepthMm + projector.rotated(p).z, kHiddenMarginMm);
  return out;
}

Span<const Prediction> Estimator::predict() {
  if (!vertices_are_current_) project_vertices();
  const Projector projector(view_, true);
  std::size_t n = 0;
  for (std::uint16_t i = 0; i < limits_.points; ++i) {
    if (!in_use_[i]) continue;
    predictions_[n] = prediction(i, projector);
    ++n;
  }
  return {predictions_, n};
}

Prediction Estimator::predict(std::uint16_t id) {
  return prediction(id, Projector(view_, true));
}

std::size_t Estimator::gather(Span<Observation> observations) {
  std::size_t n = 0;
  for (std::size_t k = 0; k < observations.count; ++k) {
    Observation& o = observations[k];
    if (o.reason != Reason::found && o.reason != Reason::rejected) continue;
    const Sym2 w = o.information;
    const bool good = has_point(o.id) && is_finite(o.x) && is_finite(w.xx) && is_finite(w.xy) &&
                      is_finite(w.yy) && w.xx >= 0 && w.yy >= 0;
    o.reason = good ? Reason::found : Reason::not_visible;
    if (good && n < limits_.points) usable_[n++] = static_cast<std::uint16_t>(k);
  }
  return n;
}

SolverReport Estimator::solve(Span<Observation> observations) {
  SolverReport report;
  const std::size_t usable = started_ ? gather(observations) : 0;
  result_.tracked = static_cast<std::uint16_t>(usable);
  result_.inliers = 0;
  looked_for_ = 0;
  for (const Observation& o : observations) looked_for_ += o.reason != Reason::not_visible;
  if (usable < 4) return report;
  const float added = options_.model_error_px * static_cast<float>(width_) / 320;
  for (std::size_t k = 0; k < usable; ++k)
    information_[k] = with_added_error(observations[usable_[k]].information, added);
  EstimatorProblem problem{*this, observations, usable};
  problem.view = view_;
  constexpr Loss kStages[2] = {Loss::huber, Loss::tukey};
  for (Loss loss : kStages) {
    problem.loss = loss;
    problem.update_scale();
    const SolverReport stage = problem.minimise(options_.iterations);
    report.iterations += stage.iterations;
    report.stop_reason = stage.stop_reason;
    report.final_cost = stage.final_cost;
    report.undetermined = stage.undetermined;
    if (loss == Loss::huber) report.initial_cost = stage.initial_cost;
  }
  view_ = problem.view;
  result_.iterations = static_cast<std::uint16_t>(result_.iterations + report.iterations);
  measure_inliers(observations, problem);
  return report;
}

void Estimator::measure_inliers(Span<Observation> observations, const EstimatorProblem& problem) {
  float sum = 0;
  std::uint16_t inliers = 0;
  for (std::size_t k = 0; k < problem.usable; ++k) {
    float px;
    const float u = problem.residual(k, &px) / problem.scale;
    if (evaluate(Loss::tukey, u).weight <= 0.1f) {
      observations[usable_[k]].reason = Reason::rejected;
      continue;
    }
    ++inliers;
    sum += px * px;
  }
  result_.inliers = inliers;
  result_.rms_px = inliers > 0 ? square_root(sum / static_cast<float>(inliers)) : 0.0f;
}

FrameResult Estimator::end() {
  if (!started_) return {};
  const float per_width = static_cast<float>(width_) / 320;
  const auto looked_for = static_cast<float>(looked_for_);
  const bool good = result_.inliers >= options_.lost_points &&
                    result_.rms_px <= options_.lost_rms_px * per_width &&
                    static_cast<float>(result_.inliers) >= options_.lost_share * looked_for;
  if (good) {
    bad_frames_ = 0;
    trusted_view_ = view_;
    for (std::size_t i = 0; i < cascade_.parameter_count(); ++i) trusted_q_[i] = q_[i];
    result_.state = TrackState::tracking;
  } else {
    // Nothing is believed of a bad frame: the next one starts from the last that was good.
    view_ = trusted_view_;
    for (std::size_t i = 0; i < cascade_.parameter_count(); ++i) q_[i] = trusted_q_[i];
    if (bad_frames_ < options_.lost_frames) ++bad_frames_;
    result_.state = bad_frames_ >= options_.lost_frames ? TrackState::lost : TrackState::degraded;
  }
  result_.pose = pose_of(view_);
  result_.vertices = static_cast<std::uint16_t>(mesh_.vertex_count());
  update_vertices(good ? options_.vertex_share : 1);
  return result_;
}

bool Estimator::project(Vec2 uv, Vec2* x) {
  return Projector(view_, true).project(cascade_.surface_point(uv, q_), x);
}

float Estimator::surface_at(Vec2 x, Vec2* uv) {
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
