// One tracked model over time (the paper, section 8 and Appendix A). Each observation is an image force f_i on a surface
// point; instead of the Euler steps of Eq. 13 the generalised force of Eq. 9 meets the Gauss-Newton matrix of the same
// sum, with the parameters' prior, a temporal prior around the prediction, and a robust weight for outliers.
#include "pliant/estimator.hpp"

namespace pliant {

namespace {
int depth_cells(const EstimatorLimits& limits) {  // a side; about two faces of a full mesh a cell
  return limits.vertices <= 512 ? 40 : 48;
}
constexpr std::size_t kSilhouetteCandidates = 8;  // for each outline point: the contour of a fine mesh has many
}  // namespace

void Estimator::lay_out(Arena& arena, const Model& model, const EstimatorLimits& limits) {
  limits_ = limits;
  arena.count_as(Purpose::fields);
  cascade_.lay_out(arena, model, limits.personal_field);
  MeshLimits mesh;
  mesh.vertices = limits.vertices;
  const unsigned faces = 2u * limits.vertices;
  mesh.faces = static_cast<std::uint16_t>(faces < 21845u ? faces : 21845u);
  arena.count_as(Purpose::mesh);
  mesh_.lay_out(arena, mesh);
  arena.count_as(Purpose::adaptation);
  adapter_.lay_out(arena, mesh);
  arena.count_as(Purpose::visibility);
  depth_.lay_out(arena, depth_cells(limits), depth_cells(limits));
  const std::size_t parameters = model.parameters().count, records = model.cascade().count;
  const auto at_most = [](std::size_t limit, std::size_t all) {
    return limit > 0 && limit < all ? limit : all;
  };
  arena.count_as(Purpose::state);
  motion_.lay_out(arena, parameters);
  smoother_.lay_out(arena, parameters);
  range_ = arena.take<float>(parameters);
  const std::size_t unknowns = at_most(limits.free_parameters, parameters) + kPoseUnknowns;
  arena.count_as(Purpose::solver);
  equations_.lay_out(arena, unknowns);
  sample_capacity_points_ = at_most(limits.samples_per_point, records);
  arena.count_as(Purpose::points);
  kind_ = arena.take<PointKind>(limits.points);
  uv_ = arena.take<Vec2>(limits.points);
  along_ = arena.take<Vec2>(limits.points);
  silhouette_count_ = kSilhouetteCandidates * limits.silhouette_points;
  arena.count_as(Purpose::visibility);
  silhouette_ = arena.take<SilhouettePoint>(silhouette_count_);
  finder_.lay_out(arena, limits.silhouette_points > 0 ? limits.vertices : 0);
  arena.count_as(Purpose::points);
  tangent_u_ = arena.take<Vec3>(limits.points);
  tangent_v_ = arena.take<Vec3>(limits.points);
  arena.count_as(Purpose::sampled_points);
  point_samples_ = arena.take<Vec3>(limits.points * sample_capacity_points_);
  arena.count_as(Purpose::points);
  predictions_ = arena.take<Prediction>(limits.points);
  rows_ = arena.take<Row>(limits.points);
  information_ = arena.take<Sym2>(limits.points);
  residuals_ = arena.take<Vec2>(limits.points);
  lengths_ = arena.take<float>(limits.points);
  sorted_ = arena.take<float>(limits.points);
  was_rejected_ = arena.take<std::uint8_t>(limits.points);
  sample_capacity_ = limits.rejection_sample < limits.points ? limits.rejection_sample : limits.points;
  if (limits.rejection == nullptr) sample_capacity_ = 0;
  arena.count_as(Purpose::rejection);
  sample_ = arena.take<float>(2 * kPoseUnknowns * sample_capacity_);
  sample_force_ = arena.take<Vec2>(sample_capacity_);
  sample_keep_ = arena.take<std::uint8_t>(sample_capacity_);
  if (sample_capacity_ > 0) limits.rejection->lay_out(arena, rejector_, sample_capacity_);
  arena.count_as(Purpose::sampled_vertices);
  vertex_samples_ = arena.take<Vec3>(limits.samples_vertices ? limits.vertices * sample_capacity_points_ : 0);
  arena.count_as(Purpose::visibility);
  vertex_ = arena.take<Vec3>(limits.vertices);
  vertex_uv_ = arena.take<Vec2>(limits.samples_vertices ? limits.vertices : 0);
  mesh_q_ = arena.take<float>(parameters);
  vertex_image_ = arena.take<Vec2>(limits.vertices);
  vertex_depth_ = arena.take<float>(limits.vertices);
  arena.count_as(Purpose::state);
  float** const per_parameter[] = {&q_, &expected_q_, &trial_q_, &alternative_q_, &sd_, &trusted_q_, &predicted_q_};
  for (float** vector : per_parameter) *vector = arena.take<float>(parameters);
  arena.count_as(Purpose::solver);
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
  had_first_pass_ = needs_another_round_ = rejected_forces_ = false;
  for (std::size_t i = 0; i < parameters; ++i) {
    const Parameter& p = model().parameters()[i];
    range_[i] = cascade_.column_of(i) == kNone ? 0.0f : p.maximum - p.minimum;
  }
  status = motion_.start(view_, q_, range_, parameters, options.motion);
  if (status != Status::ok) return status;
  if (limits_.personal_field.width > 0) {
    status = cascade_.personalise(q_);
    if (status != Status::ok) return status;
    sample_stride_ = cascade_.samples_per_point();
  }
  smoother_.restart();
  expect_motion(1.0f / 30);
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
  sample_stride_ = cascade_.samples_per_point();
  const bool fits =
      sample_stride_ <= sample_capacity_points_ && cascade_.column_count() + kPoseUnknowns <= equations_.capacity();
  return fits ? Status::ok : Status::capacity;
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
  place_silhouette();
  return Status::ok;
}

}  // namespace pliant
