#pragma once
// An Mcd with its own memory, and small helpers around it.
#include <cmath>
#include <cstddef>
#include <vector>

#include "aligned_block.hpp"
#include "pliant/outliers.hpp"

struct Table {
  std::size_t rows = 0, columns = 0;
  std::vector<float> data;  // by rows
  float at(std::size_t i, std::size_t j) const { return data[i * columns + j]; }
  Table first_columns(std::size_t count) const {
    Table t{rows, count, {}};
    for (std::size_t i = 0; i < rows; ++i)
      for (std::size_t j = 0; j < count; ++j) t.data.push_back(at(i, j));
    return t;
  }
};

struct McdRunner {
  explicit McdRunner(pliant::McdLimits limits)
      : block(pliant::measured_bytes<pliant::Mcd>(limits)),
        arena(block.data(), block.size()),
        status(pliant::create_in(arena, mcd, limits)) {}
  explicit McdRunner(const Table& t) : McdRunner(pliant::McdLimits{t.rows, t.columns}) {}

  pliant::Status fast(const Table& t, const pliant::McdOptions& options = {}) {
    return status = mcd.fast(t.data.data(), t.rows, t.columns, options);
  }
  pliant::Status deterministic(const Table& t, pliant::McdStarts starts = pliant::McdStarts::median_ball,
                               const pliant::McdOptions& options = {}) {
    return status = mcd.deterministic(t.data.data(), t.rows, t.columns, starts, options);
  }
  double log_determinant() const {
    return std::log(mcd.determinant().mantissa) + mcd.determinant().exponent * std::log(2.0);
  }
  std::vector<int> flagged() const {  // from 1, as tables count
    std::vector<int> rows;
    for (std::size_t i = 0; i < mcd.rows(); ++i)
      if (mcd.is_flagged(i)) rows.push_back(static_cast<int>(i) + 1);
    return rows;
  }

  AlignedBlock block;
  pliant::Arena arena;
  pliant::Mcd mcd;
  pliant::Status status;
};

/// Log-determinant of the covariance of the rows listed, straight from the definition.
inline double subset_log_determinant(const Table& t, const std::vector<std::size_t>& rows) {
  const std::size_t p = t.columns;
  std::vector<double> mean(p), s(p * p);
  for (std::size_t i : rows)
    for (std::size_t j = 0; j < p; ++j)
      mean[j] += static_cast<double>(t.at(i, j)) / static_cast<double>(rows.size());
  for (std::size_t i : rows)
    for (std::size_t j = 0; j < p; ++j)
      for (std::size_t k = 0; k < p; ++k)
        s[j * p + k] += (static_cast<double>(t.at(i, j)) - mean[j]) *
                        (static_cast<double>(t.at(i, k)) - mean[k]) / static_cast<double>(rows.size() - 1);
  double sum = 0;
  for (std::size_t k = 0; k < p; ++k) {  // elimination: the matrix is positive definite
    if (!(s[k * p + k] > 0)) return -1e300;
    sum += std::log(s[k * p + k]);
    for (std::size_t i = k + 1; i < p; ++i)
      for (std::size_t j = p; j-- > k;) s[i * p + j] -= s[i * p + k] * s[k * p + j] / s[k * p + k];
  }
  return sum;
}
