#include "fit/fold_over_guard.hpp"

#include "fit/fit_tuning.hpp"

namespace pliant {

void FoldOverGuard::lay_out(Arena& arena, const Model& model) {
  test_.lay_out(arena, model);
  valid_position_ = arena.take<Vec3>(model.base_uv().count);
  position_ = arena.take<Vec3>(model.base_uv().count);
  valid_q_ = arena.take<float>(model.parameters().count);
}

void FoldOverGuard::start(Cascade& cascade, const float* q) {
  if (!test_.is_started()) test_.start(cascade);
  for (std::size_t i = 0; i < cascade.parameter_count(); ++i)
    valid_q_[i] = cascade.column_of(i) == kNone ? q[i] : 0.0f;
  test_.compute_positions(cascade, valid_q_, valid_position_);
}

bool FoldOverGuard::move_back(Cascade& cascade, float* q) {
  const std::size_t parameters = cascade.parameter_count();
  for (int k = 0; k < kFitTuning.fold_over_tries; ++k) {
    test_.compute_positions(cascade, q, position_);
    const float fraction = test_.step_fraction(valid_position_, position_);
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
