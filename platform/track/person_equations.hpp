#pragma once
/// \file person_equations.hpp
/// Normal equations of which a frame's own unknowns are eliminated (docs/algorithms.md, section 7.20).
#include <cstddef>

#include "pliant/arena.hpp"

namespace pliant {

/// H x = g, symmetric and dense. Bytes: 2 n (n + 1) + 4 n for n unknowns.
class PersonEquations {
 public:
  void lay_out(Arena& arena, std::size_t unknowns);
  /// Starts over with all unknowns, at zero.
  void reset();
  std::size_t count() const { return count_; }

  /// Adds the scalar equation row x = residual. \param row  count() values.
  void add(const float* row, float residual, float weight);
  /// Adds x[unknown] = residual.
  void add_prior(std::size_t unknown, float residual, float weight);
  /// Eliminates the first unknowns: H and g of the others become those of the best value of the first (Schur
  /// complement). An unknown that nothing determines is left out.
  void eliminate(std::size_t first);
  /// Counts the unknowns from `first` on from zero, which were counted from `now`. \param now  count() - first values.
  void count_from_zero(std::size_t first, const float* now);
  /// Solves for the unknowns from `first` on, by Cholesky factorisation in place. \param x  count() - first values.
  /// \return false, and x is not complete, where they are not determined.
  bool solve(std::size_t first, float* x);

  /// \pre row <= column.
  float& h(std::size_t row, std::size_t column) { return of_row(row)[column]; }
  float& g(std::size_t unknown) { return g_[unknown]; }

 private:
  /// Elements of a row by column, from the diagonal on.
  float* of_row(std::size_t row) { return h_ + (row * count_ - row * (row + 1) / 2); }

  float *h_ = nullptr, *g_ = nullptr;
  std::size_t count_ = 0;
};

}  // namespace pliant
