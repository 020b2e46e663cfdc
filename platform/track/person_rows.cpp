#include "track/person_rows.hpp"

namespace pliant {

namespace {

constexpr const PersonRowsTuning& kTuning = kPersonRowsTuning;
constexpr std::size_t kPose = static_cast<std::size_t>(kPoseUnknowns);

/// Derivative of an image position along a rotation of the model about axis j of Pose::q, before the view's own rotation.
Vec2 along_turn(const Projector::Derivatives& d, const Mat3& rotation, int j) {
  const Vec3 axis = rotation * Vec3{j == 0 ? 1.0f : 0.0f, j == 1 ? 1.0f : 0.0f, j == 2 ? 1.0f : 0.0f};
  return axis.x * d.pose[0] + axis.y * d.pose[1] + axis.z * d.pose[2];
}

/// Unit vector along which information of rank one is.
Vec2 direction_of(Sym2 w) {
  const Vec2 v = w.xx > w.yy ? Vec2{w.xx, w.xy} : Vec2{w.xy, w.yy};
  return (1.0f / length(v)) * v;
}

}  // namespace

void PersonRows::lay_out(Arena& arena, const Model& model) {
  parameters_ = arena.take<std::uint16_t>(model.parameters().count);
  unknown_of_ = arena.take<std::uint16_t>(model.parameters().count);
}

void PersonRows::start(const Model& model, const std::uint8_t* is_free) {
  const Span<const Parameter> all = model.parameters();
  std::size_t n = 0;
  for (std::uint16_t k = 0; k < all.count; ++k)
    if (all[k].group == Group::expression && is_free[k] != 0) parameters_[n++] = k;
  expressions_ = n;
  for (std::uint16_t k = 0; k < all.count; ++k)
    if (all[k].group == Group::identity) parameters_[n++] = k;
  identities_ = n - expressions_;
  for (std::size_t k = 0; k < all.count; ++k) unknown_of_[k] = kNone;
  for (std::size_t k = 0; k < n; ++k)
    unknown_of_[parameters_[k]] = static_cast<std::uint16_t>(kPose + k + (k < expressions_ ? 0 : 3));
}

std::size_t PersonRows::scratch_bytes(const Model& model) {
  Arena trial;
  PersonRows rows;
  rows.begin(trial, model, {}, nullptr);
  return trial.used_bytes();
}

void PersonRows::begin(Arena& scratch, const Model& model, const View& view, const float* q) {
  const std::size_t most = kPose + 3 + model.parameters().count;
  cascade_ = create_part<Cascade>(scratch, model);
  samples_ = scratch.take<Vec3>(model.cascade().count);
  columns_ = scratch.take<Vec2>(most);
  row_ = scratch.take<float>(most);
  view_ = view;
  q_ = q;
}

/// Where a point goes in this frame that has to stay where it is in its key frame, when the model moves it there by `in_key`.
Vec2 PersonRows::slid(const Projector::Derivatives& d, Vec2 in_key) const {
  const Vec2 uv = from_key_ * in_key;
  return uv.x * d.along(surface_.pu) + uv.y * d.along(surface_.pv);
}

void PersonRows::set_columns(Vec2 uv, const View* key, const Projector::Derivatives& d) {
  for (std::size_t k = 0; k < count(); ++k) columns_[k] = {};
  for (std::size_t k = 0; k < kPose; ++k) columns_[k] = d.pose[k];
  const Mat3 here = rotation_matrix(view_.q), there = rotation_matrix(key == nullptr ? view_.q : key->q);
  const std::size_t turn = kPose + expressions_;
  for (int j = 0; j < 3; ++j) {
    Vec2& column = columns_[turn + static_cast<std::size_t>(j)];
    column = along_turn(d, here, j);
    if (key != nullptr) column = column - slid(d, along_turn(in_key_, there, j));
  }
  cascade_->sample_point(uv, q_, samples_);
  Jacobian jacobian;  // all parameters are free: a column is a parameter
  cascade_->evaluate(samples_, q_, &jacobian);
  for (std::size_t n = 0; n < jacobian.count; ++n) {
    const std::uint16_t parameter = jacobian.list[n], unknown = unknown_of_[parameter];
    if (unknown == kNone) continue;
    const Vec3 moved = jacobian.column[parameter];
    columns_[unknown] = d.along(moved);
    if (unknown >= turn && key != nullptr)
      columns_[unknown] = columns_[unknown] - slid(d, in_key_.along(moved));
  }
}

void PersonRows::add_along(Vec2 direction, Vec2 residual, float variance, PersonEquations& equations) {
  const float r = dot(direction, residual);
  for (std::size_t k = 0; k < count(); ++k) row_[k] = dot(direction, columns_[k]);
  equations.add(row_, r,
                1.0f / (variance * (1 + dot(residual, residual) / (kTuning.half_weight_square * variance))));
}

/// Whether the surface is turned to the camera so far that a template's window shows little else.
bool PersonRows::faces_camera(const Projector& projector) const {
  const Vec3 inwards = projector.rotated(cross(surface_.pu, surface_.pv)),
             away = projector.to_camera(surface_.p);
  return dot(inwards, away) > kTuning.least_facing * length(inwards) * length(away);
}

void PersonRows::add(const Observation& o, Vec2 uv, const SurfaceFrame& surface, const View* key,
                     PersonEquations& equations) {
  surface_ = surface;
  Vec2 x, x_key;
  Projector::Derivatives d;
  const Projector projector(view_, true);
  if (!projector.project(surface_.p, &x, &d)) return;
  if (key != nullptr) {
    if (!faces_camera(projector)) return;
    if (!Projector(*key, true).project(surface_.p, &x_key, &in_key_)) return;
    const Vec2 a = in_key_.along(surface_.pu), b = in_key_.along(surface_.pv);
    const float area = a.x * b.y - b.x * a.y;
    if (magnitude(area) < kTuning.least_area * (dot(a, a) + dot(b, b))) return;
    const float per = 1.0f / area;
    from_key_ = {per * b.y, -per * b.x, -per * a.y, per * a.x};
  }
  set_columns(uv, key, d);
  const float trace = o.information.xx + o.information.yy;
  if (!(trace > 0)) return;
  const bool is_line = o.cue == Cue::edge;
  const float model_px = (is_line ? kTuning.edge_error_mm : kTuning.patch_error_mm) * view_.s;
  const float variance = model_px * model_px + (is_line ? 1.0f : 2.0f) / trace;
  const Vec2 residual = o.x - x;
  if (is_line) {
    const Vec2 across = direction_of(o.information);
    return add_along(across, dot(across, residual) * across, variance, equations);
  }
  add_along({1, 0}, residual, variance, equations);
  add_along({0, 1}, residual, variance, equations);
}

void PersonRows::add_priors(PersonEquations& equations) const {
  const Span<const Parameter> all = cascade_->model().parameters();
  for (std::size_t k = 0; k < 3; ++k) equations.add_prior(k, 0, 1.0f / (kTuning.turn_sd * kTuning.turn_sd));
  for (std::size_t k = 0; k < expressions_; ++k) {
    const float sd = all[parameters_[k]].sd;
    equations.add_prior(kPose + k, 0, 1.0f / (sd * sd));
  }
}

}  // namespace pliant
