#include "optim/point_row.hpp"

#include "model/parameters.hpp"

namespace pliant {

void PointRow::lay_out(Arena& arena, std::size_t unknowns) {
  unknown = arena.take<std::uint16_t>(unknowns);
  column = arena.take<Vec2>(unknowns);
}

void PointRow::add_to(NormalEquations& equations, Span<const Vec2> leading, const Projector::Derivatives& d,
                      const Jacobian& jacobian, Vec2 residual, Sym2 information) const {
  std::size_t n = 0;
  for (; n < leading.count; ++n) {
    unknown[n] = static_cast<std::uint16_t>(n);
    column[n] = leading[n];
  }
  for (std::size_t k = 0; k < jacobian.count; ++k, ++n) {
    unknown[n] = static_cast<std::uint16_t>(leading.count + jacobian.list[k]);
    column[n] = d.along(jacobian.column[jacobian.list[k]]);
  }
  equations.add(unknown, column, n, residual, information);
}

void add_prior(const Parameter& p, float q, float weight, std::size_t unknown, NormalEquations& equations) {
  equations.add_prior(unknown, -q, weight / (p.sd * p.sd));
  equations.set_limits(unknown, min(p.minimum - q, 0), max(p.maximum - q, 0));
}

float stepped(const Parameter& p, float q, float step) {
  return within_range(p, q + step);
}

}  // namespace pliant
