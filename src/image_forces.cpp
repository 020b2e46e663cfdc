// Image forces in parameter space (the paper's Appendix A; ALGORITHMS 6.5). Departs from it in three ways: the rigid
// block only, rows whitened by the mean of B^T B, and re-admission. Whitening changes no distance, in exact arithmetic;
// it keeps rotations (hundreds of pixels a radian) and translations (one) apart by nothing that floats would feel.
#include "pliant/image_forces.hpp"

#include <limits>

#include "elementary.hpp"
#include "pliant/robust.hpp"

namespace pliant {

namespace {
constexpr std::size_t kRowsPerColumn = 5;
constexpr float kNotFinite = std::numeric_limits<float>::infinity();
constexpr double kSmallestPivot =
    1e-6;  // relative: below, no point sees the parameter apart from those before it
bool is_finite_row(const float* jacobian, Vec2 force, std::size_t p) {
  bool finite = is_finite(force);
  for (std::size_t j = 0; j < 2 * p; ++j) finite = finite && is_finite(jacobian[j]);
  return finite;
}
}  // namespace

void ForceRejector::lay_out(Arena& arena, const McdLimits& limits) {
  row_capacity_ = limits.rows < kMcdMaxRows ? limits.rows : kMcdMaxRows;
  column_capacity_ = limits.columns < kMcdMaxColumns ? limits.columns : kMcdMaxColumns;
  row_ = arena.take<float>(row_capacity_ * column_capacity_);
  mcd_.lay_out(arena, limits);
}

/// row_i = L^-1 B_i^T f_i, where L L^T = sum of B^T B / rows. An unseen parameter gives a column of zeros.
void ForceRejector::whiten(const float* jacobian, const Vec2* force, std::size_t rows, std::size_t p,
                           const std::uint8_t* finite) {
  double l[kMcdMaxColumns][kMcdMaxColumns] = {};
  for (std::size_t i = 0; i < rows; ++i) {
    if (finite[i] == 0) continue;
    const float *bx = jacobian + i * 2 * p, *by = bx + p;
    for (std::size_t j = 0; j < p; ++j)
      for (std::size_t k = 0; k <= j; ++k)
        l[j][k] += static_cast<double>(bx[j]) * static_cast<double>(bx[k]) +
                   static_cast<double>(by[j]) * static_cast<double>(by[k]);
  }
  double inverse[kMcdMaxColumns];
  for (std::size_t j = 0; j < p; ++j) {
    double pivot = l[j][j];
    for (std::size_t k = 0; k < j; ++k) {
      for (std::size_t m = 0; m < k; ++m) l[j][k] -= l[j][m] * l[k][m];
      l[j][k] *= inverse[k];
      pivot -= l[j][k] * l[j][k];
    }
    inverse[j] = pivot > kSmallestPivot * l[j][j] ? 1 / square_root(pivot) : 0.0;
  }
  const double unit = square_root(static_cast<double>(rows));
  for (std::size_t i = 0; i < rows; ++i) {
    const float *bx = jacobian + i * 2 * p, *by = bx + p;
    double y[kMcdMaxColumns];
    for (std::size_t j = 0; j < p; ++j) {
      y[j] = static_cast<double>(bx[j]) * static_cast<double>(force[i].x) +
             static_cast<double>(by[j]) * static_cast<double>(force[i].y);
      for (std::size_t k = 0; k < j; ++k) y[j] -= l[j][k] * y[k];
      y[j] *= inverse[j];
      row_[i * p + j] = finite[i] != 0 ? static_cast<float>(unit * y[j]) : kNotFinite;
    }
  }
}

Status ForceRejector::reject(const float* jacobian, const Vec2* force, std::size_t rows, std::size_t columns,
                             const ForceOptions& options, std::uint8_t* keep) {
  if (jacobian == nullptr || force == nullptr || keep == nullptr || columns == 0 ||
      !(options.noise_px >= 0.0f) || !(options.cutoff > 0.0f && options.cutoff < 1.0f))
    return Status::bad_argument;
  if (rows > row_capacity_ || columns > column_capacity_) return Status::capacity;
  std::size_t finite = 0;
  for (std::size_t i = 0; i < rows; ++i) {
    keep[i] = is_finite_row(jacobian + i * 2 * columns, force[i], columns) ? 1 : 0;
    finite += keep[i];
  }
  if (finite < kRowsPerColumn * columns) return Status::too_few_points;
  whiten(jacobian, force, rows, columns, keep);
  McdOptions mcd;
  mcd.cutoff = options.cutoff;
  const Status status = mcd_.deterministic(row_, rows, columns, options.starts, mcd);
  if (status != Status::ok && status != Status::degenerate_data) return status;
  const float least = options.noise_px * options.noise_px;
  for (std::size_t i = 0; i < rows; ++i)
    if (keep[i] != 0 && mcd_.is_flagged(i) && dot(force[i], force[i]) > least) keep[i] = 0;
  return Status::ok;
}

std::size_t readmit(const Vec2* residual, std::size_t rows, float factor, float noise_px, float* scratch,
                    std::uint8_t* keep) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < rows; ++i)
    if (keep[i] != 0 && is_finite(residual[i])) scratch[kept++] = length(residual[i]);
  const float limit = factor * max(robust_scale(scratch, kept), noise_px);
  kept = 0;
  for (std::size_t i = 0; i < rows; ++i) {
    keep[i] = is_finite(residual[i]) && length(residual[i]) <= limit ? 1 : 0;
    kept += keep[i];
  }
  return kept;
}

}  // namespace pliant
