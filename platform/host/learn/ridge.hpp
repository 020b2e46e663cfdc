#pragma once
/// \file ridge.hpp
/// Ridge regression with folds: normal equations for each fold, so that solutions without one fold cost a factorisation only.
#include <cstddef>
#include <vector>

namespace pliant::host::learn {

/// Sums of one fold: rows x_i of D numbers and a constant 1, several outputs y_i, weights w_i.
struct RidgeSums {
  std::size_t inputs = 0, outputs = 0;  ///< inputs: D + 1
  std::vector<double> xx;               ///< inputs x inputs, lower triangle
  std::vector<double> xy;               ///< inputs x outputs, column by column
  std::vector<double> yy;               ///< outputs: sum of w y^2
  double weight = 0;                    ///< sum of w

  void resize(std::size_t in, std::size_t out);
  void add(const RidgeSums& other, double sign);
};

/// The sums of all folds.
RidgeSums sum_of(const std::vector<RidgeSums>& folds);

/// Collects rows and adds them to sums in blocks.
class RidgeRows {
 public:
  explicit RidgeRows(RidgeSums& sums) : sums_(sums) {}
  ~RidgeRows() { flush(); }
  RidgeRows(const RidgeRows&) = delete;
  RidgeRows& operator=(const RidgeRows&) = delete;
  /// \param x  inputs - 1 numbers. \param y  outputs.
  template <class Number>
  void add(const Number* x, const double* y, double weight);

 private:
  void flush();
  RidgeSums& sums_;
  std::vector<float> x_, y_;  // rows times the root of their weight
  std::size_t rows_ = 0;
};

/// Minimises sum w |y - W x|^2 + strength * weight * (mean variance of the inputs) |W|^2 over W; the constant's column is free.
/// \return outputs x inputs, by rows; the constant last. Throws std::runtime_error if a sum is not finite.
std::vector<double> solve_ridge(const RidgeSums& sums, double strength);

/// sum of w |y - W x|^2 over the rows of `sums`, an output.
std::vector<double> squared_errors(const RidgeSums& sums, const std::vector<double>& solution);

}  // namespace pliant::host::learn
