#include "estimate/state_parts.hpp"

#include "model/parameters.hpp"

namespace pliant {

void StateParts::lay_out(Arena& arena, std::size_t parameters, const EstimatorLimits& limits,
                         std::size_t samples) {
  state.lay_out(arena, parameters);
  trusted.lay_out(arena, parameters);
  motion.lay_out(arena, parameters);
  points.lay_out(arena, limits.points, limits.silhouette_points, samples);
}

void StateParts::revise(Cascade& cascade, const float* q, Quat turn) {
  for (std::size_t i = 0; i < cascade.parameter_count(); ++i) {
    if (cascade.column_of(i) != kNone) continue;
    state.q[i] = trusted.q[i] = within_range(cascade.model().parameters()[i], q[i]);
  }
  state.view.q = normalised(state.view.q * turn);
  trusted.view.q = normalised(trusted.view.q * turn);
  motion.turn(state, turn);
  for (std::uint16_t i = 0; i < points.capacity(); ++i)
    if (points.has(i)) points.sample_again(i, turn, cascade, state.q);
}

}  // namespace pliant
