// Image forces in parameter space (the paper, Appendix A; docs/algorithms.md, section 6.5). It departs from the paper in three
// ways: only the rigid block is used, rows are whitened by the mean of B^T B, and rejected forces may be taken back.
// Whitening changes no distance in exact arithmetic. It brings rotations (hundreds of pixels a radian) and translations (about
// one pixel a millimetre) to the same magnitude, which float arithmetic needs.
#include "pliant/image_forces.hpp"

#include <limits>

#include "base/elementary.hpp"
#include "base/packed_triangle.hpp"

namespace pliant {

namespace {
constexpr std::size_t kRowsPerColumn =
    5;  // fewest forces a column; the rule of docs/algorithms.md, section 6.5
constexpr float kNotFinite = std::numeric_limits<float>::infinity();
/// Relative pivot below which the points do not separate a parameter from those before it. Round value, not tuned.
constexpr double kSmallestPivot = 1e-6;
/// Inverse pivot of the estimated covariance in a direction in which its forces do not differ, 1/px: a force that is off by
/// some 1e-5 px does not agree. Above the rounding of whitened rows, which are floats. Round value, not tuned.
constexpr double kFlat = 1e5;

/// Factorises A = L L^T in place. The diagonal gets 1 / pivot. For a pivot that is too small it gets `flat`; 0 leaves the
/// direction out.
void factorise_lower(double* l, std::size_t p, double flat) {
  for (std::size_t j = 0; j < p; ++j) {
    double pivot = l[packed(j, j)];
    const double least = flat > 0 ? 1 / (flat * flat) : kSmallestPivot * pivot;
    for (std::size_t k = 0; k < j; ++k) {
      for (std::size_t m = 0; m < k; ++m) l[packed(j, k)] -= l[packed(j, m)] * l[packed(k, m)];
      l[packed(j, k)] *= l[packed(k, k)];
      pivot -= l[packed(j, k)] * l[packed(j, k)];
    }
    l[packed(j, j)] = pivot > least ? 1 / square_root(pivot) : flat;
  }
}

/// y = L^-1 y.
void solve_lower(const double* l, std::size_t p, double* y) {
  for (std::size_t j = 0; j < p; ++j) {
    for (std::size_t k = 0; k < j; ++k) y[j] -= l[packed(j, k)] * y[k];
    y[j] *= l[packed(j, j)];
  }
}

bool is_finite_row(const float* jacobian, Vec2 force, std::size_t p) {
  bool finite = is_finite(force);
  for (std::size_t j = 0; j < 2 * p; ++j) finite = finite && is_finite(jacobian[j]);
  return finite;
}
}  // namespace

void ForceRejector::lay_out(Arena& arena, const McdLimits& limits) {
  McdLimits within = limits;
  within.rows = limits.rows < kMcdMaxRows ? limits.rows : kMcdMaxRows;
  within.columns = limits.columns < kForceMaxColumns ? limits.columns : kForceMaxColumns;
  row_capacity_ = within.rows;
  column_capacity_ = within.columns;
  row_ = arena.take<float>(row_capacity_ * column_capacity_);
  mcd_.lay_out(arena, within);
  columns_ = 0;
}

/// Computes L of sum B^T B / rows = L L^T. An unobserved parameter gets an inverse pivot of zero, so that its column is zero.
void ForceRejector::whiten(const float* jacobian, std::size_t rows, std::size_t p,
                           const std::uint8_t* finite) {
  for (double& value : whiten_) value = 0;
  for (std::size_t i = 0; i < rows; ++i) {
    if (finite[i] == 0) continue;
    const float *bx = jacobian + i * 2 * p, *by = bx + p;
    for (std::size_t j = 0; j < p; ++j)
      for (std::size_t k = 0; k <= j; ++k)
        whiten_[packed(j, k)] += static_cast<double>(bx[j]) * static_cast<double>(bx[k]) +
                                 static_cast<double>(by[j]) * static_cast<double>(by[k]);
  }
  unit_ = square_root(static_cast<double>(rows));
  factorise_lower(whiten_, p, 0);
}

/// row = L^-1 B^T f.
void ForceRejector::project(const float* jacobian, Vec2 force, double* row) const {
  const float *bx = jacobian, *by = bx + columns_;
  for (std::size_t j = 0; j < columns_; ++j)
    row[j] = unit_ * (static_cast<double>(bx[j]) * static_cast<double>(force.x) +
                      static_cast<double>(by[j]) * static_cast<double>(force.y));
  solve_lower(whiten_, columns_, row);
}

/// Factorises the estimated covariance for `agrees`.
void ForceRejector::factorise() {
  for (std::size_t j = 0; j < columns_; ++j)
    for (std::size_t k = 0; k <= j; ++k)
      factor_[packed(j, k)] = mcd_.reweighted().covariance[j * columns_ + k];
  factorise_lower(factor_, columns_, kFlat);
}

bool ForceRejector::agrees(const float* jacobian, Vec2 force) const {
  if (columns_ == 0 || !is_finite_row(jacobian, force, columns_)) return false;
  if (dot(force, force) <= least_) return true;
  double row[kForceMaxColumns];
  project(jacobian, force, row);
  for (std::size_t j = 0; j < columns_; ++j) row[j] -= mcd_.reweighted().center[j];
  solve_lower(factor_, columns_, row);
  double square = 0;
  for (std::size_t j = 0; j < columns_; ++j) square += row[j] * row[j];
  return square <= mcd_.cutoff();
}

Status ForceRejector::reject(const float* jacobian, const Vec2* force, std::size_t rows, std::size_t columns,
                             const ForceOptions& options, std::uint8_t* keep) {
  if (jacobian == nullptr || force == nullptr || keep == nullptr || columns == 0 ||
      !(options.noise_px >= 0.0f) || !(options.cutoff > 0.0f && options.cutoff < 1.0f))
    return Status::bad_argument;
  if (rows > row_capacity_ || columns > column_capacity_) return Status::capacity;
  columns_ = 0;
  std::size_t finite = 0;
  for (std::size_t i = 0; i < rows; ++i) {
    keep[i] = is_finite_row(jacobian + i * 2 * columns, force[i], columns) ? 1 : 0;
    finite += keep[i];
  }
  if (finite < kRowsPerColumn * columns) return Status::too_few_points;
  whiten(jacobian, rows, columns, keep);
  columns_ = columns;
  for (std::size_t i = 0; i < rows; ++i) {
    double row[kForceMaxColumns];
    project(jacobian + i * 2 * columns, force[i], row);
    for (std::size_t j = 0; j < columns; ++j)
      row_[i * columns + j] = keep[i] != 0 ? static_cast<float>(row[j]) : kNotFinite;
  }
  McdOptions mcd;
  mcd.cutoff = options.cutoff;
  const Status status = mcd_.deterministic(row_, rows, columns, options.starts, mcd);
  if (status != Status::ok && status != Status::degenerate_data) {
    columns_ = 0;
    return status;
  }
  factorise();
  least_ = options.noise_px * options.noise_px;
  for (std::size_t i = 0; i < rows; ++i)
    if (mcd_.is_flagged(i) && dot(force[i], force[i]) > least_) keep[i] = 0;
  return Status::ok;
}

}  // namespace pliant
