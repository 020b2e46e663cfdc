#pragma once
// One image point's row of the normal equations, and what every model parameter adds to them.
#include "pliant/arena.hpp"
#include "pliant/camera.hpp"
#include "pliant/cascade.hpp"
#include "pliant/normal_equations.hpp"

namespace pliant {

/// The columns of one point side by side, as NormalEquations::add takes them.
struct PointRow {
  std::uint16_t* unknown = nullptr;
  Vec2* column = nullptr;

  void lay_out(Arena& arena, std::size_t unknowns);
  /// Adds an observation: the leading columns, the pose's or what else comes first, then those of the parameters.
  void add_to(NormalEquations& equations, Span<const Vec2> leading, const Projector::Derivatives& d,
              const Jacobian& jacobian, Vec2 residual, Sym2 information) const;
};

/// The prior of parameter p, which is q, by this weight, and the limits that its step keeps to.
void add_prior(const Parameter& p, float q, float weight, std::size_t unknown, NormalEquations& equations);

/// q after a step, in p's range.
float stepped(const Parameter& p, float q, float step);

}  // namespace pliant
