#include "fit/fold_over_guard.hpp"

#include "fit/fit_tuning.hpp"

namespace pliant {

void FoldOverGuard::lay_out(Arena& arena, const Model& model, bool samples) {
  test_.lay_out(arena, model);
  valid_position_ = arena.take<Vec3>(model.base_uv().count);
  position_ = arena.take<Vec3>(model.base_uv().count);
  valid_q_ = arena.take<float>(model.parameters().count);
  if (samples) samples_ = arena.take_span<Vec3>(model.base_uv().count * model.cascade().count);
}

void FoldOverGuard::start(Cascade& cascade, const float* q) {
  if (!test_.is_started()) test_.start_at_rest(cascade);
  for (std::size_t i = 0; i < cascade.parameter_count(); ++i)
    valid_q_[i] = cascade.column_of(i) == kNone ? q[i] : 0.0f;
  const bool are_all_free = cascade.column_count() == cascade.parameter_count();
  if (!samples_.empty() && !(are_all_free && are_samples_of_all_)) {
    const auto uv = cascade.model().base_uv();
    for (std::size_t v = 0; v < uv.count; ++v)
      cascade.sample_point(uv[v], q, samples_.data + v * cascade.model().cascade().count);
    are_samples_of_all_ = are_all_free;
  }
  compute_positions(cascade, valid_q_, valid_position_);
}

void FoldOverGuard::compute_positions(Cascade& cascade, const float* q, Vec3* position) {
  if (samples_.empty()) return test_.compute_positions(cascade, q, position);
  for (std::size_t v = 0; v < cascade.model().base_uv().count; ++v)
    position[v] = cascade.evaluate(samples_.data + v * cascade.model().cascade().count, q);
}

/// Of the step from valid_position_ to position_. Which faces are meant to fold over takes most of a short fit's time to find
/// out, and matters only where one does.
float FoldOverGuard::step_fraction(Cascade& cascade) {
  const float fraction = test_.step_fraction(valid_position_, position_);
  if (fraction == 1 || is_exact_) return fraction;
  test_.start(cascade);
  is_exact_ = true;
  return test_.step_fraction(valid_position_, position_);
}

bool FoldOverGuard::move_back(Cascade& cascade, float* q) {
  const std::size_t parameters = cascade.parameter_count();
  for (int k = 0; k < kFitTuning.fold_over_tries; ++k) {
    compute_positions(cascade, q, position_);
    const float fraction = step_fraction(cascade);
    if (fraction == 1) {
      for (std::size_t i = 0; i < parameters; ++i) valid_q_[i] = q[i];
      Vec3* const before = valid_position_;
      valid_position_ = position_;
      position_ = before;
      return k > 0;
    }
    for (std::size_t i = 0; i < parameters; ++i) q[i] = valid_q_[i] + fraction * (q[i] - valid_q_[i]);
  }
  for (std::size_t i = 0; i < parameters; ++i) q[i] = valid_q_[i];
  return true;
}

}  // namespace pliant
