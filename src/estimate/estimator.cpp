// The estimator (the paper, section 8 and Appendix A): a composition of surface points, visible surface, frame solver, motion
// model and track monitor.
#include "estimate/estimator_impl.hpp"
#include "model/parameters.hpp"

namespace pliant {

namespace {

std::size_t at_most(std::size_t limit, std::size_t all) {
  return limit > 0 && limit < all ? limit : all;
}

std::size_t most_unknowns(const Model& model, const EstimatorLimits& limits) {
  return at_most(limits.free_parameters, model.parameters().count) + kPoseUnknowns;
}

std::uint32_t interval(std::uint8_t frames) {
  return frames > 0 ? frames : 1;
}

}  // namespace

std::size_t solve_bytes(const Model& model, const EstimatorLimits& limits) {
  Arena trial;
  SolveScratch().lay_out(trial, model.parameters().count, most_unknowns(model, limits));
  return trial.used_bytes();
}

Status check(const EstimatorOptions& o) {
  const bool good = o.iterations >= 0 && o.iterations <= 1000 && o.rejection <= Rejection::on_doubt &&
                    o.cue_scale_rate >= 0 && o.cue_scale_rate <= 1 && o.model_error_mm >= 0 &&
                    o.model_error_mm <= 1000 && is_finite(o.mesh_error_mm);
  return good ? Status::ok : Status::bad_argument;
}

void Estimator::lay_out(Arena& arena, const Model& model, const EstimatorLimits& limits) {
  const std::size_t parameters = model.parameters().count;
  const std::size_t samples = at_most(limits.samples_per_point, model.cascade().count);
  arena.count_as(Purpose::state);
  impl_ = arena.make<Impl>();
  const auto part = [this](auto Impl::*member) { return impl_ == nullptr ? nullptr : &(impl_->*member); };
  lay_out_part(arena, static_cast<StateParts*>(impl_), parameters, limits, samples);
  lay_out_part(arena, part(&Impl::surface), parameters,
               VisibleSurfaceLimits{limits.vertices, limits.samples_vertices ? samples : 0,
                                    limits.silhouette_points, limits.adaptation_memory});
  FrameSolverLimits solver;
  solver.points = limits.points;
  solver.parameters = parameters;
  solver.unknowns = most_unknowns(model, limits);
  solver.solve_memory = limits.solve_memory;
  solver.rejection_sample = limits.rejection_sample;
  solver.rejection = limits.rejection;
  lay_out_part(arena, part(&Impl::solver), solver);
  StretchRows* const springs =
      limits.stretch == nullptr ? nullptr : limits.stretch->lay_out(arena, model, samples);
  arena.count_as(Purpose::fields);
  lay_out_part(arena, part(&Impl::cascade), model, limits.personal_field);
  if (impl_ == nullptr) return;
  impl_->stretch = limits.stretch;
  impl_->springs = springs;
  impl_->personalise = limits.personal_field.width > 0 ? limits.personalise : nullptr;
  impl_->sample_capacity = samples;
  impl_->mesh_following = limits.adaptation_memory.empty() ? limits.mesh_following : nullptr;
}

Status Estimator::start(const Camera& camera, int width, int height, const Pose& pose, const float* q,
                        const std::uint8_t* is_free, const EstimatorOptions& options) {
  PLIANT_ASSERT(impl_ != nullptr);
  Impl& s = *impl_;
  const bool has_values = q != nullptr || s.parameter_count() == 0;
  if (!has_values || width <= 0 || height <= 0 || !is_possible(pose, camera) || check(options) != Status::ok)
    return Status::bad_argument;
  if (!are_finite(q, s.parameter_count())) return Status::bad_argument;
  Lens lens;
  Status status = Lens::make(camera, width, height, &lens);
  if (status != Status::ok) return status;
  s.started = false;
  if (options.mesh_operations > 0 && s.mesh_following == nullptr) return Status::capacity;
  status = s.choose_free(is_free);
  const bool keeps_mesh = options.mesh_error_mm < 0 && s.surface.mesh().vertex_count() > 0;
  if (status == Status::ok && !keeps_mesh) status = s.surface.start(model());
  if (status != Status::ok) return status;
  s.camera = camera;
  s.lens = lens;
  s.width = width;
  s.height = height;
  s.set_state(pose, q);
  return s.start_parts(options, keeps_mesh);
}

Status Estimator::Impl::choose_free(const std::uint8_t* is_free) {
  if (is_free != nullptr)
    cascade.set_free(is_free);
  else
    cascade.set_free(Group::expression);
  const bool fits = cascade.samples_per_point() <= sample_capacity &&
                    cascade.column_count() + kPoseUnknowns <= solver.unknown_capacity();
  return fits ? Status::ok : Status::capacity;
}

void Estimator::Impl::set_view(const Pose& pose) {
  state.view = view_of(pose, camera);
  state.view.q = normalised(pose.q);
}

void Estimator::Impl::set_state(const Pose& pose, const float* q) {
  set_view(pose);
  for (std::size_t i = 0; i < parameter_count(); ++i)
    state.q[i] = within_range(cascade.model().parameters()[i], q[i]);
  copy(state, parameter_count(), &trusted);
}

Status Estimator::Impl::start_parts(const EstimatorOptions& options, bool keeps_mesh) {
  tangent_interval = interval(options.tangent_interval_frames);
  vertex_interval = interval(options.vertex_interval_frames);
  frame = 0;
  predictions = {};
  monitor.start(width);
  solver.start({options.iterations,
                options.rejection,
                {options.cues, options.model_error_mm, options.cue_scale_rate}});
  Status status = motion.start(cascade, state, options);
  if (status == Status::ok && personalise != nullptr) status = (cascade.*personalise)(state.q);
  if (status == Status::ok && springs != nullptr) status = stretch->start(*springs, cascade, state.q);
  if (status != Status::ok) return status;
  points.clear(cascade.samples_per_point());
  surface.adapt(cascade, state, mesh_policy(options), keeps_mesh);
  surface_is_trusted = false;
  started = true;
  return Status::ok;
}

MeshPolicy Estimator::Impl::mesh_policy(const EstimatorOptions& options) const {
  MeshPolicy policy;
  policy.error_mm = options.mesh_error_mm;
  policy.operations = options.mesh_operations;
  policy.following = options.mesh_operations > 0 ? mesh_following : nullptr;
  policy.vertex_budget = options.vertex_budget;
  policy.texture = options.texture;
  policy.view.pose = pose_of(state.view);
  policy.view.focal_px = camera.f;
  policy.view.cx = camera.cx;
  policy.view.cy = camera.cy;
  policy.view.width_px = static_cast<float>(width);
  policy.view.height_px = static_cast<float>(height);
  policy.view.tolerance_px = options.mesh_error_px;
  return policy;
}

bool Estimator::is_started() const {
  return impl_ != nullptr && impl_->started;
}

// --- Surface points ---

Status Estimator::Impl::add(PointKind kind, Vec2 uv, Vec2 along, std::uint16_t* id) {
  const Status status = points.add(kind, uv, along, cascade, state.q, id);
  if (status == Status::ok) note_new_point(*id);
  return status;
}

void Estimator::Impl::note_new_point(std::uint16_t id) {
  predictions = {};
  solver.forget(id);
}

Status Estimator::add_point(Vec2 uv, std::uint16_t* id) {
  return is_started() ? impl_->add(PointKind::surface, uv, {}, id) : Status::not_started;
}

Status Estimator::add_edge_point(Vec2 uv, Vec2 along, std::uint16_t* id) {
  return is_started() ? impl_->add(PointKind::curve, uv, along, id) : Status::not_started;
}

Status Estimator::add_silhouette_point(std::uint16_t* id) {
  if (!is_started()) return Status::not_started;
  impl_->place_silhouette = [](Impl& s) {
    if (s.points.silhouette_count() == 0) return;
    s.points.place_silhouette(s.surface.find_contour(s.state.view, s.frame), s.cascade, s.state.q);
    s.predictions = {};
  };
  return impl_->add(PointKind::silhouette, {0.5f, 0.5f}, {}, id);
}

Status Estimator::add_curve(std::size_t curve, float spacing_mm, Span<std::uint16_t> ids,
                            std::size_t* count) {
  if (!is_started()) return Status::not_started;
  if (count == nullptr || curve >= model().curves().count || !(spacing_mm > 0)) return Status::bad_argument;
  Impl& s = *impl_;
  const Curve& c = model().curves()[curve];
  const Status status = s.points.add_curve({&model().curve_points()[c.first_point], c.point_count},
                                           spacing_mm, s.cascade, s.state.q, ids, count);
  for (std::size_t k = 0; k < *count; ++k) s.note_new_point(ids[k]);
  return status;
}

void Estimator::remove_point(std::uint16_t id) {
  impl_->points.remove(id);
}

bool Estimator::has_point(std::uint16_t id) const {
  return impl_->points.has(id);
}

Vec2 Estimator::point_uv(std::uint16_t id) const {
  return impl_->points.uv(id);
}

SurfaceFrame Estimator::point_frame(std::uint16_t id) {
  return impl_->points.frame(id, impl_->cascade, impl_->state.q);
}

// --- The frame ---

void Estimator::begin(std::int64_t time_ns) {
  Impl& s = *impl_;
  s.predictions = {};
  s.tau_before = s.state.view.tau;
  if (s.motion.predict(time_ns, s.monitor.bad_frames(), s.cascade, &s.state)) s.surface.invalidate_images();
  s.solver.begin();
  ++s.frame;
  s.points.update_tangents(s.cascade, s.state.q, s.frame, s.tangent_interval);
  if (s.place_silhouette != nullptr) s.place_silhouette(s);
}

void Estimator::translate(Vec2 px) {
  if (!is_finite(px)) return;
  View& view = impl_->state.view;
  view.tau = impl_->tau_before + (1.0f / view.s) * px;
  impl_->motion.expect_offset(view.tau);
  impl_->note_new_view();
}

void Estimator::propose(const View& view) {
  Impl& s = *impl_;
  s.predictions = {};
  s.state.view = view;
  s.tau_before = view.tau;
  s.motion.expect(view);
  copy(s.trusted.q, s.parameter_count(), s.state.q);
  s.restore_surface();
  if (s.place_silhouette != nullptr) s.place_silhouette(s);
}

void Estimator::expect(std::size_t parameter, float value, float sd) {
  Impl& s = *impl_;
  PLIANT_ASSERT(parameter < s.parameter_count() && is_finite(value) && sd > 0);
  if (s.cascade.column_of(parameter) == kNone) return;
  s.predictions = {};
  s.state.q[parameter] = within_range(model().parameters()[parameter], value);
  s.motion.expect(parameter, s.state.q[parameter], sd);
}

Span<const Prediction> Estimator::predict() {
  Impl& s = *impl_;
  s.surface.draw_depth(s.state.view, s.frame);
  const Projector projector(s.state.view, true);
  Prediction* const out = s.points.predictions();
  std::size_t n = 0;
  for (std::uint16_t i = 0; i < s.points.capacity(); ++i)
    if (s.points.has(i)) {
      constexpr std::size_t kAhead = 4;  // points; a hint of when memory is fetched, round value, not tuned
      s.points.announce(i + kAhead);
      out[n++] = s.predict(i, projector);
    }
  s.predictions = {out, n};
  return s.predictions;
}

Prediction Estimator::predict(std::uint16_t id) {
  impl_->surface.draw_depth(impl_->state.view, impl_->frame);
  return impl_->predict(id, Projector(impl_->state.view, true));
}

Prediction Estimator::Impl::predict(std::uint16_t id, const Projector& projector) {
  Prediction p;
  Vec3 position;
  if (!points.predict(id, {cascade, motion.expected(), state, projector}, &p, &position)) return p;
  p.visible = is_visible(p, projector.rotated(position));
  if (!lens.is_none()) distort(lens, &p);
  return p;
}

/// Precondition: depth is drawn. The silhouette finder has left out hidden points already.
bool Estimator::Impl::is_visible(const Prediction& p, Vec3 rotated) const {
  const Vec2 seen = lens.distort(p.x);
  const bool is_inside = seen.x >= 0 && seen.y >= 0 && seen.x <= static_cast<float>(width - 1) &&
                         seen.y <= static_cast<float>(height - 1);
  if (!is_inside || !points.is_turned_to_camera(p)) return false;
  return points.kind(p.id) == PointKind::silhouette || !surface.hides(p.x, rotated);
}

bool Estimator::solve_first_pass(Span<Observation> observations) {
  if (!is_started()) return false;
  Impl& s = *impl_;
  if (!s.lens.is_none()) undistort(s.lens, observations);
  const bool moved = s.solver.solve_first_pass(s.solve_input(), observations, &s.state);
  s.note_new_view();
  if (!s.lens.is_none()) distort(s.lens, observations);
  return moved;
}

bool Estimator::needs_another_round() const {
  return impl_->solver.needs_another_round();
}

SolverReport Estimator::solve(Span<Observation> observations) {
  if (!is_started()) return {};
  Impl& s = *impl_;
  if (!s.lens.is_none()) undistort(s.lens, observations);
  // Through a lens the predictions are not in the pinhole image.
  const Span<const Prediction> predictions = s.lens.is_none() ? s.predictions : Span<const Prediction>{};
  const SolverReport report = s.solver.solve(s.solve_input(), observations, predictions, &s.state);
  s.note_new_view();
  if (!s.lens.is_none()) distort(s.lens, observations);
  return report;
}

FrameResult Estimator::end() {
  if (!is_started()) return {};
  Impl& s = *impl_;
  const SolveResult& found = s.solver.result();
  s.predictions = {};
  const bool good = s.monitor.is_good(found, s.state.view.s / s.motion.expected().mean.view.s);
  FrameResult result;
  result.state = s.monitor.add(good);
  if (good) {
    s.solver.conclude_frame();
    s.motion.correct(s.cascade, s.state, s.solver.variance(), s.trusted);
    s.surface.follow_view(s.cascade, s.state, s.frame);
    copy(s.state, s.parameter_count(), &s.trusted);
  } else {
    copy(s.trusted, s.parameter_count(), &s.state);
    if (result.state == TrackState::lost) s.motion.rest(s.state);
  }
  good ? s.update_surface(s.vertex_interval) : s.restore_surface();
  result.pose = pose_of(s.state.view);
  result.tracked = found.rows;
  result.inliers = found.inliers;
  result.rms_px = found.rms_px;
  result.iterations = found.iterations;
  result.vertices = static_cast<std::uint16_t>(s.surface.mesh().vertex_count());
  result.score = found.score;
  result.smoothed_pose = s.motion.smoothed_pose();
  result.pose_is_observed = found.pose_is_observed;
  return result;
}

// --- The state ---

const Model& Estimator::model() const {
  return impl_->cascade.model();
}

const Camera& Estimator::camera() const {
  return impl_->camera;
}

const Lens& Estimator::lens() const {
  return impl_->lens;
}

const View& Estimator::view() const {
  return impl_->state.view;
}

Span<const float> Estimator::parameters() const {
  return {impl_->state.q, impl_->parameter_count()};
}

Span<const float> Estimator::smoothed_parameters() const {
  return {impl_->motion.smoothed_parameters(), impl_->parameter_count()};
}

const MotionFilter& Estimator::motion() const {
  return impl_->motion.filter();
}

float Estimator::cue_scale(Cue cue) const {
  return impl_->solver.cue_scale(cue);
}

// --- The surface ---

Vec3 Estimator::surface_point(Vec2 uv) {
  Vec3 position;
  surface_points({&uv, 1}, &position);
  return position;
}

void Estimator::surface_points(Span<const Vec2> uv, Vec3* positions) {
  impl_->cascade.select(impl_->state.q);
  for (std::size_t k = 0; k < uv.count; ++k) positions[k] = impl_->cascade.selected_point(uv[k]);
}

bool Estimator::project(Vec2 uv, Vec2* x) {
  Vec2 pinhole;
  if (!Projector(impl_->state.view, true).project(surface_point(uv), &pinhole)) return false;
  *x = impl_->lens.distort(pinhole);
  return true;
}

float Estimator::surface_at(Vec2 x, Vec2* uv) {
  return impl_->surface.surface_at(impl_->cascade, impl_->state, impl_->lens.undistort(x), uv);
}

void Estimator::refine_uv(Vec2 x, Vec2* uv) {
  VisibleSurface::refine_uv(impl_->cascade, impl_->state, impl_->lens.undistort(x), uv);
}

void Estimator::limit_work(const WorkCosts& costs, float most) {
  impl_->solver.limit_work(costs, most);
}

WorkCosts Estimator::work_costs(int window) const {
  return WorkCosts::of(static_cast<float>(window),
                       static_cast<float>(kPoseUnknowns + impl_->cascade.column_count()),
                       static_cast<float>(impl_->cascade.samples_per_point()));
}

FrameWork Estimator::work() const {
  return impl_->solver.work();
}

const Mesh& Estimator::mesh() const {
  return impl_->surface.mesh();
}

const Vec3* Estimator::vertex_positions() const {
  return impl_->surface.positions();
}

const Vec2* Estimator::vertex_images() const {
  return impl_->surface.images();
}

Vec2 Estimator::vertex_seen(VertexId v) const {
  return impl_->lens.distort(vertex_images()[v]);
}

void Estimator::refresh_vertices() {
  if (is_started()) impl_->update_surface(1);
}

void Estimator::Impl::forget_person() {
  const std::size_t samples = cascade.samples_per_point();
  cascade.forget_person();
  PLIANT_ASSERT(cascade.samples_per_point() == samples);
}

void Estimator::forget_person() {
  impl_->forget_person();
}

Status Estimator::revise(const float* q, Quat turn) {
  return is_started() ? impl_->revise(q, turn) : Status::not_started;
}

Status Estimator::Impl::revise(const float* q, Quat turn) {
  const float norm = turn.w * turn.w + turn.x * turn.x + turn.y * turn.y + turn.z * turn.z;
  const bool is_turn = norm > 0.5f && norm < 2;  // as is_possible
  if (q == nullptr || !is_turn || !are_finite(q, parameter_count())) return Status::bad_argument;
  forget_person();
  StateParts::revise(cascade, q, turn);
  predictions = {};
  surface.revise(state.q, turn);
  update_surface(vertex_interval);
  if (springs != nullptr) return stretch->start(*springs, cascade, state.q);
  return Status::ok;
}

void Estimator::slide_point(std::uint16_t id, Vec2 uv) {
  impl_->points.slide_to(id, uv);
}

SurfaceFrame Estimator::surface_frame(Vec2 uv, const float* q) {
  return impl_->cascade.surface_frame(uv, q);
}

}  // namespace pliant
