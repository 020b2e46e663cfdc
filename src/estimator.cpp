// One tracked model over time (the paper, section 8 and Appendix A). Each observation is an image force f_i on a surface
// point; instead of the Euler steps of Eq. 13 the generalised force of Eq. 9 meets the Gauss-Newton matrix of the same
// sum, with the parameters' prior, a temporal prior around the prediction, and a robust weight for outliers.
#include "pliant/estimator.hpp"

namespace pliant {

namespace {
constexpr int kDepthCells = 48;
constexpr std::size_t kOutlineCandidates = 8;  // for each outline point: the contour of a fine mesh has many
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
  kind_ = arena.take<PointKind>(limits.points);
  uv_ = arena.take<Vec2>(limits.points);
  along_ = arena.take<Vec2>(limits.points);
  outline_count_ = kOutlineCandidates * limits.outline_points;
  outline_ = arena.take<OutlinePoint>(outline_count_);
  finder_.lay_out(arena, limits.outline_points > 0 ? limits.vertices : 0);
  tangent_u_ = arena.take<Vec3>(limits.points);
  tangent_v_ = arena.take<Vec3>(limits.points);
  baked_points_ = arena.take<Vec3>(limits.points * baked_capacity_);
  predictions_ = arena.take<Prediction>(limits.points);
  rows_ = arena.take<Row>(limits.points);
  information_ = arena.take<Sym2>(limits.points);
  residuals_ = arena.take<Vec2>(limits.points);
  lengths_ = arena.take<float>(limits.points);
  sorted_ = arena.take<float>(limits.points);
  was_let_go_ = arena.take<std::uint8_t>(limits.points);
  sample_capacity_ = limits.rejection_sample < limits.points ? limits.rejection_sample : limits.points;
  sample_ = arena.take<float>(2 * kPoseUnknowns * sample_capacity_);
  sample_force_ = arena.take<Vec2>(sample_capacity_);
  sample_keep_ = arena.take<std::uint8_t>(sample_capacity_);
  if (sample_capacity_ > 0) rejector_.lay_out(arena, {sample_capacity_, kPoseUnknowns});
  baked_vertices_ = arena.take<Vec3>(limits.bakes_vertices ? limits.vertices * baked_capacity_ : 0);
  vertex_ = arena.take<Vec3>(limits.vertices);
  vertex_image_ = arena.take<Vec2>(limits.vertices);
  vertex_depth_ = arena.take<float>(limits.vertices);
  float** const per_parameter[] = {&q_, &expected_q_, &trial_q_, &rival_q_, &sd_, &trusted_q_};
  for (float** vector : per_parameter) *vector = arena.take<float>(parameters);
  step_ = arena.take<float>(unknowns);
  variance_ = arena.take<float>(unknowns);
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
  Lens lens;
  Status status = Lens::make(camera, width, height, &lens);
  if (status != Status::ok) return status;
  started_ = false;
  status = choose_free(is_free);
  if (status == Status::ok) status = mesh_.set_base(model().base_uv(), model().base_corners());
  if (status != Status::ok) return status;

  camera_ = camera;
  lens_ = lens;
  width_ = width;
  height_ = height;
  options_ = options;
  view_ = view_of(pose, camera);
  view_.q = normalised(pose.q);
  trusted_view_ = expected_view_ = view_;
  for (float& scale : cue_scale_) scale = 1;
  for (std::size_t i = 0; i < parameters; ++i) {
    const Parameter& p = model().parameters()[i];
    q_[i] = expected_q_[i] = trusted_q_[i] = clamp(q[i], p.minimum, p.maximum);
  }
  for (std::size_t k = 0; k < equations_.capacity(); ++k) variance_[k] = 0;
  for (std::size_t i = 0; i < limits_.points; ++i) kind_[i] = PointKind::none;
  time_ns_ = 0;
  seconds_ = 0;
  frame_ = 0;
  bad_frames_ = 0;
  row_count_ = looked_for_ = patches_looked_for_ = patch_inliers_ = 0;
  solves_ = 0;
  rejected_forces_ = false;
  expect_motion();
  adapt_mesh();
  started_ = true;
  update_vertices(1);
  result_ = {};
  result_.state = TrackState::tracking;
  result_.pose = pose_of(view_);
  result_.vertices = static_cast<std::uint16_t>(mesh_.vertex_count());
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
  expected_view_ = view_;
  expect_motion();
  row_count_ = looked_for_ = patches_looked_for_ = patch_inliers_ = 0;
  solves_ = 0;
  rejected_forces_ = false;
  result_.tracked = result_.inliers = result_.iterations = 0;
  result_.rms_px = result_.score = 0;
  result_.pose_is_observed = false;
  ++frame_;
  const std::uint32_t share = options_.tangent_share > 0 ? options_.tangent_share : 1;
  for (std::uint16_t i = 0; i < limits_.points; ++i)
    if (kind_[i] != PointKind::none && (i + frame_) % share == 0) update_tangents(i);
  place_outline();
}

/// How far the view may have moved since the last trusted frame: turn, scale and shift, independent.
void Estimator::expect_motion() {
  const float sd[kPoseUnknowns] = {0.03f, 0.03f, 0.03f, 0.02f, 4, 4};
  const auto frames = static_cast<float>(1 + bad_frames_);
  for (int k = 0; k < kPoseUnknowns; ++k) pose_variance_[k] = frames * sd[k] * frames * sd[k];
}

void Estimator::shift(Vec2 px) {
  if (!is_finite(px)) return;
  view_.tau = view_.tau + (1.0f / view_.s) * px;
  expected_view_.tau = view_.tau;
  vertices_are_current_ = false;
}

void Estimator::propose(const View& view) {
  view_ = expected_view_ = view;
  for (std::size_t i = 0; i < cascade_.parameter_count(); ++i) q_[i] = trusted_q_[i];
  update_vertices(1);
  place_outline();
}

void Estimator::save(State* state) const {
  state->pose = pose_of(view_);
  for (int k = 0; k < kPoseUnknowns; ++k) state->pose_sd[k] = square_root(variance_[k]);
  for (std::size_t i = 0; i < cascade_.parameter_count(); ++i) {
    if (state->q != nullptr) state->q[i] = q_[i];
    const std::uint16_t column = cascade_.column_of(i);
    if (state->sd != nullptr)
      state->sd[i] = column == kNone ? 0.0f : square_root(variance_[kPoseUnknowns + column]);
  }
}

Status Estimator::restore(const State& state) {
  if (!started_) return Status::not_started;
  const std::size_t parameters = cascade_.parameter_count();
  bool good = state.q != nullptr && is_finite(state.pose) && state.pose.t.z > 0;
  for (std::size_t i = 0; good && i < parameters; ++i) good = is_finite(state.q[i]);
  if (!good) return Status::bad_argument;
  view_ = view_of(state.pose, camera_);
  view_.q = normalised(state.pose.q);
  expected_view_ = view_;
  for (std::size_t k = 0; k < cascade_.column_count(); ++k) {
    const std::uint16_t i = cascade_.parameter_of(k);
    const Parameter& p = model().parameters()[i];
    q_[i] = expected_q_[i] = clamp(state.q[i], p.minimum, p.maximum);
  }
  update_vertices(1);
  place_outline();
  return Status::ok;
}

/// What the last solve found: enough of what was looked for, near enough, alike enough, and seeing the whole pose.
bool Estimator::is_good() const {
  const float per_width = static_cast<float>(width_) / 320;
  const auto reaches = [](float share, std::size_t part, std::size_t all) {
    return static_cast<float>(part) >= share * static_cast<float>(all);
  };
  const float scale = view_.s / trusted_view_.s;
  return result_.inliers >= options_.lost_points && result_.rms_px <= options_.lost_rms_px * per_width &&
         reaches(options_.lost_share, result_.inliers, looked_for_) &&
         reaches(options_.lost_share, patch_inliers_, patches_looked_for_) &&
         (result_.score == 0 || result_.score >= options_.lost_score) && result_.pose_is_observed &&
         scale <= 1 + options_.lost_scale_change && scale * (1 + options_.lost_scale_change) >= 1;
}

FrameResult Estimator::end() {
  if (!started_) return {};
  const bool good = is_good();
  if (good) {
    equations_.variances(variance_);
    update_cue_scales();
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

}  // namespace pliant
