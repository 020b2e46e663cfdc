#include "fit/fold_over_guard.hpp"

#include "base/arrays.hpp"
#include "fit/fit_tuning.hpp"

namespace pliant {

void FoldOverGuard::lay_out(Arena& arena, const Model& model, bool samples) {
  cascade_ = create_part<Cascade>(arena, model);
  test_.lay_out(arena, model);
  valid_position_ = arena.take<Vec3>(model.base_uv().count);
  position_ = arena.take<Vec3>(model.base_uv().count);
  valid_q_ = arena.take<float>(model.parameters().count);
  if (samples) samples_ = arena.take_span<Vec3>(model.base_uv().count * model.cascade().count);
}

void FoldOverGuard::start(const Cascade& cascade, const float* q) {
  if (!test_.is_started()) test_.start_at_rest(*cascade_);
  for (std::size_t i = 0; i < cascade_->parameter_count(); ++i)
    valid_q_[i] = cascade.column_of(i) == kNone ? q[i] : 0.0f;
  compute_positions(valid_q_, valid_position_);
  seen_ = valid_position_;
}

void FoldOverGuard::expect_shapes() {
  if (has_samples_ || samples_.empty()) return;
  const auto uv = cascade_->model().base_uv();
  for (std::size_t v = 0; v < uv.count; ++v)
    cascade_->sample_point(uv[v], valid_q_, samples_.data + v * cascade_->model().cascade().count);
  has_samples_ = true;
}

void FoldOverGuard::compute_positions(const float* q, Vec3* position) {
  if (!has_samples_) return test_.compute_positions(*cascade_, q, position);
  for (std::size_t v = 0; v < cascade_->model().base_uv().count; ++v)
    position[v] = cascade_->evaluate(samples_.data + v * cascade_->model().cascade().count, q);
}

void FoldOverGuard::see(const float* q) {
  compute_positions(q, position_);
  seen_ = position_;
}

bool FoldOverGuard::has_folded(const float* q) {
  test_.compute_positions(*cascade_, q, position_, kFitTuning.fold_over_slack_mm);
  return step_fraction() < 1;
}

/// Of the step from valid_position_ to position_. Which faces are meant to fold over takes most of a short fit's time to find
/// out, and matters only where one does.
float FoldOverGuard::step_fraction() {
  const float fraction = test_.step_fraction(valid_position_, position_);
  if (fraction == 1 || is_exact_) return fraction;
  test_.start(*cascade_);
  is_exact_ = true;
  return test_.step_fraction(valid_position_, position_);
}

bool FoldOverGuard::move_back(float* q) {
  const std::size_t parameters = cascade_->parameter_count();
  for (int k = 0; k < kFitTuning.fold_over_tries; ++k) {
    see(q);
    const float fraction = step_fraction();
    if (fraction == 1) {
      copy(q, parameters, valid_q_);
      Vec3* const before = valid_position_;
      valid_position_ = position_;
      position_ = before;
      return k > 0;
    }
    for (std::size_t i = 0; i < parameters; ++i) q[i] = valid_q_[i] + fraction * (q[i] - valid_q_[i]);
  }
  copy(valid_q_, parameters, q);
  seen_ = valid_position_;
  return true;
}

}  // namespace pliant
