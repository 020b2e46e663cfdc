#pragma once
/// \file normal_equations.hpp
/// Packed normal equations with priors and step limits (docs/algorithms.md, sections 5.3 to 5.5).
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/geometry.hpp"

namespace pliant {

/// The linear system H x = g of a Gauss-Newton step, accumulated from observations.
///
/// H = sum B_i^T W_i B_i and g = sum B_i^T W_i f_i, the generalised force f_g of Eq. 9. H is stored as its
/// packed upper triangle. Observations with most of the columns are collected eight at a time as rows of L^T
/// B (W = L L^T) and added as one product. Sparse observations are added one by one. The bits of the result
/// depend on the order of the calls only. Bytes for n unknowns: 8 n (n + 1) / 2, 18 rows of n + 8 floats, and
/// 7 floats and 3 bytes an unknown.
class NormalEquations {
 public:
  /// Takes its memory from the arena; called by create_in and measured_bytes (arena.hpp).
  void lay_out(Arena& arena, std::size_t unknowns);
  std::size_t capacity() const { return capacity_; }  ///< Most that there is room for.
  std::size_t count() const { return count_; }        ///< Number in use.

  /// Starts over with `count` unknowns and no limits. `count` is at most capacity().
  void reset(std::size_t count);

  /// If true, observations added from now on update only g and the diagonal of H. A step along the
  /// generalised force needs no more. The cost of an observation with k columns falls from O(k^2) to O(k).
  void keep_gradient_only(bool only) { gradient_only_ = only; }

  /// Adds one image observation.
  /// \param unknown      unknown numbers of the non-zero columns, ascending.
  /// \param column       those columns of the 2 x n derivative of the projection.
  /// \param residual     observed minus projected position, px.
  /// \param information  1/px^2, may have rank one.
  /// Cost: k (k + 1) multiply-adds for k columns, or n (n + 1) when k is most of n.
  void add(const std::uint16_t* unknown, const Vec2* column, std::size_t columns, Vec2 residual,
           Sym2 information);
  /// Adds one image observation with all columns. The derivative is given as its two rows of count() floats.
  void add_dense(const float* along_x, const float* along_y, Vec2 residual, Sym2 information);

  /// Adds the scalar observation step[unknown] = `residual` with the given weight, 1 / standard deviation squared.
  void add_prior(std::size_t unknown, float residual, float weight);

  /// Restricts the step of one unknown to [lower, upper]. Precondition: lower <= 0 <= upper.
  void set_limits(std::size_t unknown, float lower, float upper);
  /// The step, clamped to the limits of the unknown.
  float clamped(std::size_t unknown, float step) const {
    return clamp(step, lower_[unknown], upper_[unknown]);
  }

  /// Solves (H + damping diag(H)) x = g within the limits, by Cholesky factorisation of the scaled matrix.
  ///
  /// An unknown that would leave its limits is set to the limit, and the others are solved again. An unknown
  /// at its limit is freed when the others then pull it back inside. There are at most 12 such rounds.
  /// An unknown whose scaled pivot is below 1e-6 is not determined by the observations. Its step is 0 and it
  /// is counted.
  /// Cost: n^3 / 6 a round.
  void solve(float damping, float* step);
  /// Unknowns that the last `solve` found undetermined.
  std::size_t undetermined_count() const { return undetermined_; }
  /// The decrease of the cost that the equations predict for a step from `solve`: g^T step / 2. Exact when
  /// the problem is linear, damping is 0 and no limit is active.
  float predicted_decrease(const float* step);

  /// Factorisations since `lay_out`, count; wraps.
  std::uint32_t factorisation_count() const { return factorisations_; }

  /// Diagonal of H^-1: the variances of the unknowns. Undetermined unknowns get 0. Limits are ignored. Cost: n^3 / 6.
  void variances(float* variance);

  /// An element of H. Only the diagonal is valid after keep_gradient_only(true).
  float h(std::size_t row, std::size_t column) {
    if (gathered_ > 0) flush();
    return row <= column ? h_[index(row, column)] : h_[index(column, row)];
  }
  /// An element of g = f_g.
  float g(std::size_t unknown) {
    if (gathered_ > 0) flush();
    return g_[unknown];
  }

 private:
  std::size_t index(std::size_t row, std::size_t column) const {
    return row * count_ - row * (row + 1) / 2 + column;  // row <= column
  }
  template <class F>
  void for_row(std::size_t k, F f) const;
  float* gathered_row(float residual);
  void add_sparse(const std::uint16_t* unknown, const Vec2* column, std::size_t columns, Vec2 residual,
                  Sym2 w);
  void flush();
  void add_tile(std::size_t row, std::size_t column);
  void start_scaled();
  void copy_scaled(float damping);
  void factorise(float damping);
  float* factor_row(std::size_t i);
  void pin_undetermined(std::size_t k);
  void pin_pushed_out();
  bool pin_to_limits(float* step);
  bool release_from_limits(float damping, const float* step);
  void back_substitute(const float* right, float* x);

  float *h_ = nullptr, *factor_ = nullptr, *rows_ = nullptr, *row_residual_ = nullptr;
  float *spread_x_ = nullptr, *spread_y_ = nullptr;  // rows of a sparse observation, for vectors; zero between calls
  float *g_ = nullptr, *scale_ = nullptr, *lower_ = nullptr, *upper_ = nullptr, *right_ = nullptr,
        *solution_ = nullptr, *compact_ = nullptr;
  enum class Pin : std::uint8_t { none, at_limit, undetermined };
  Pin* pinned_ = nullptr;
  std::uint16_t* free_ = nullptr;  // unknowns that were not pinned, ascending: of these is the factor
  std::size_t capacity_ = 0, count_ = 0, free_count_ = 0, undetermined_ = 0;
  std::size_t stride_ = 0, gathered_ = 0;  // of rows_
  std::uint32_t factorisations_ = 0;
  bool gradient_only_ = false;
};

}  // namespace pliant
