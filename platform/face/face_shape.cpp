#include "face/face_shape.hpp"

#include "base/arrays.hpp"
#include "model/parameters.hpp"

namespace pliant {

namespace {

constexpr std::size_t kPose = static_cast<std::size_t>(kPoseUnknowns);

}  // namespace

void FaceShape::lay_out(Arena& arena, const Model& model, std::size_t landmarks, AlignerUse use) {
  const std::size_t parameters = model.parameters().count;
  const bool is_known = use == AlignerUse::known_person;
  const std::size_t unknowns = kPose + (is_known ? count_of(Group::expression, model) : parameters);
  cascade_.lay_out(arena, model);
  q_ = arena.take<float>(parameters);
  equations_.lay_out(arena, unknowns);
  step_ = arena.take<float>(unknowns);
  row_.lay_out(arena, unknowns);
  uv_ = arena.take<Vec2>(landmarks);
  PLIANT_ASSERT(landmarks <= kMostLandmarks);
  count_ = landmarks;
  keeps_samples_ = !is_known;
  if (use != AlignerUse::spread_alignment) lay_out_samples(arena);
}

void FaceShape::lay_out_samples(Arena& arena) {
  samples_ = arena.take<Vec3>((keeps_samples_ ? count_ : 1) * cascade_.model().cascade().count);
  forget_samples();
}

void FaceShape::set_corners(const Vec2 (&corners)[4]) {
  copy(corners, 4, corners_);
}

void FaceShape::start(const View& view, const float* q, const std::uint8_t* is_free, const Lens& lens) {
  view_ = view;
  lens_ = lens;
  const Span<const Parameter> parameters = cascade_.model().parameters();
  for (std::size_t k = 0; k < parameters.count; ++k) q_[k] = within_range(parameters[k], q[k]);
  if (is_free != nullptr)
    cascade_.set_free(is_free);
  else
    cascade_.set_all_free();
  forget_samples();
}

bool FaceShape::project(Vec2 uv, Vec2* x) {
  if (!Projector(view_, true).project(cascade_.surface_point(uv, q_), x)) return false;
  *x = lens_.distort(*x);
  return true;
}

CropMap FaceShape::crop_map(float mm_per_px, int side) {
  CropMap map;
  map.side = side;
  const Projector projector(view_, true);
  select();
  for (const Vec2 uv : corners_) {
    Vec2 x = view_.c;
    if (projector.project(cascade_.selected_point(uv), &x)) x = lens_.distort(x);
    map.origin = map.origin + 0.25f * x;
  }
  const Vec2 down = down_of(projector);
  map.right = (mm_per_px * view_.s) * Vec2{down.y, -down.x};
  return map;
}

void FaceShape::begin() {
  equations_.reset(kPose + cascade_.column_count());
}

/// How much a landmark at p faces the camera.
float FaceShape::weight_of(const Projector& projector, Vec3 p) {
  const Vec3 outward = normalised(projector.rotated(p - kFaceShapeTuning.head_centre));
  const float cosine = -dot(outward, normalised(projector.to_camera(p)));
  const float range = kFaceShapeTuning.seen_cosine - kFaceShapeTuning.hidden_cosine;
  return clamp((cosine - kFaceShapeTuning.hidden_cosine) / range, kFaceShapeTuning.hidden_weight, 1);
}

FaceShape::Seen FaceShape::evaluate(std::size_t k) {
  PLIANT_ASSERT(samples_ != nullptr);
  const Projector projector(view_, true);
  Vec3* const samples = samples_of(k);
  if (!is_sampled(k)) {
    if (keeps_samples_) sampled_[k / 32] |= std::uint32_t{1} << (k % 32);
    cascade_.sample_point(uv_[k], q_, samples);
  }
  const Vec3 p = cascade_.evaluate(samples, q_, &jacobian_);
  ideal_ = view_.c;
  weight_ = projector.project(p, &ideal_, &derivatives_) ? weight_of(projector, p) : 0;
  return {lens_.distort(ideal_), weight_};
}

FaceShape::Seen FaceShape::locate(std::size_t k) {
  const Projector projector(view_, true);
  const Vec3 p = is_sampled(k) ? cascade_.evaluate(samples_of(k), q_) : cascade_.selected_point(uv_[k]);
  Vec2 x = view_.c;
  const float weight = projector.project(p, &x) ? weight_of(projector, p) : 0;
  return {lens_.distort(x), weight};
}

void FaceShape::add(Vec2 target, const Sym2& information) {
  if (!(weight_ > 0)) return;
  const Sym2& i = information;
  row_.add_to(equations_, {derivatives_.pose, kPose}, derivatives_, jacobian_,
              lens_.undistort(target) - ideal_, {weight_ * i.xx, weight_ * i.xy, weight_ * i.yy});
}

void FaceShape::add_priors(float prior) {
  const Span<const Parameter> parameters = cascade_.model().parameters();
  for (std::size_t k = 0; k < cascade_.column_count(); ++k) {
    const std::size_t i = cascade_.parameter_of(k);
    add_prior(parameters[i], q_[i], prior, kPose + k, equations_);
  }
  for (std::size_t k = 0; k < 3; ++k)
    equations_.set_limits(k, -kFaceShapeTuning.max_turn_rad, kFaceShapeTuning.max_turn_rad);
  equations_.set_limits(kLogScale, -kFaceShapeTuning.max_log_step, kFaceShapeTuning.max_log_step);
}

void FaceShape::finish(float prior) {
  add_priors(prior);
  equations_.solve(kFaceShapeTuning.damping, step_);
  view_ = moved(view_, step_, kPoseUnknowns);
  const Span<const Parameter> parameters = cascade_.model().parameters();
  for (std::size_t k = 0; k < cascade_.column_count(); ++k) {
    const std::size_t i = cascade_.parameter_of(k);
    q_[i] = stepped(parameters[i], q_[i], step_[kPose + k]);
  }
}

float FaceShape::mean_square_parameter() const {
  const Span<const Parameter> parameters = cascade_.model().parameters();
  float sum = 0;
  for (std::size_t k = 0; k < parameters.count; ++k) {
    const float z = q_[k] / parameters[k].sd;
    sum += z * z;
  }
  return sum / max(1, static_cast<float>(parameters.count));
}

bool FaceShape::is_usable() const {
  return are_finite(q_, cascade_.parameter_count()) && is_finite(view_.s) && is_finite(view_.tau) &&
         is_finite(view_.rho) && is_finite(view_.q.w) && view_.s > 1e-6f && view_.s < 1e6f;
}

}  // namespace pliant
