// DetMCD (Hubert, Rousseeuw & Verdonck 2012; docs/algorithms.md, section 6.3). A start matrix gives axes only. The scales
// along them and the centre are estimated robustly; the half of the rows that is nearest in that metric starts the C-steps.
#include "optim/mcd_starts.hpp"
#include "optim/mcd_state.hpp"

namespace pliant {

namespace mcd {

namespace {

/// One Jacobi rotation that clears m(j,k); the columns of `axes` turn with it.
void rotate(Matrix m, Matrix axes, std::size_t p, std::size_t j, std::size_t k) {
  const double off = m[j][k];
  if (off == 0) return;
  const double theta = (m[k][k] - m[j][j]) / (2 * off), size = theta < 0 ? -theta : theta;
  const double root = size > 1e150 ? size : square_root(1 + theta * theta);
  const double t = (theta < 0 ? -1 : 1) / (size + root);
  const double c = 1 / square_root(1 + t * t), s = t * c;
  for (std::size_t i = 0; i < p; ++i) {
    const double a = m[i][j], b = m[i][k];
    m[i][j] = c * a - s * b;
    m[i][k] = s * a + c * b;
  }
  for (std::size_t i = 0; i < p; ++i) {
    const double a = m[j][i], b = m[k][i];
    m[j][i] = c * a - s * b;
    m[k][i] = s * a + c * b;
  }
  for (std::size_t i = 0; i < p; ++i) {
    const double a = axes[i][j], b = axes[i][k];
    axes[i][j] = c * a - s * b;
    axes[i][k] = s * a + c * b;
  }
}

/// Columns of `axes`: eigenvectors of m, which is overwritten.
void find_axes(Matrix m, std::size_t p, Matrix axes) {
  for (std::size_t i = 0; i < p; ++i)
    for (std::size_t j = 0; j < p; ++j) axes[i][j] = i == j ? 1.0 : 0.0;
  for (int sweep = 0; sweep < kTuning.jacobi_sweeps; ++sweep) {
    double off = 0, all = 0;
    for (std::size_t j = 0; j < p; ++j)
      for (std::size_t k = 0; k < p; ++k) (j == k ? all : off) += m[j][k] * m[j][k];
    if (!(off > 1e-24 * all)) return;
    for (std::size_t j = 0; j + 1 < p; ++j)
      for (std::size_t k = j + 1; k < p; ++k) rotate(m, axes, p, j, k);
  }
}

/// sum over j of axes_j f_j axes_j^T, one entry.
double entry(Matrix axes, const double* f, std::size_t p, std::size_t row, std::size_t column) {
  double sum = 0;
  for (std::size_t j = 0; j < p; ++j) sum += axes[row][j] * f[j] * axes[column][j];
  return sum;
}

/// Scales along the axes by median absolute deviation, and the centre by medians of sphered data.
void refit(const Cloud& cloud, Matrix axes, const Scratch& scratch, float* line, const Moments& out) {
  const std::size_t p = cloud.columns;
  double scale[kMcdMaxColumns], factor[kMcdMaxColumns], direction[kMcdMaxColumns];
  for (std::size_t j = 0; j < p; ++j) {
    for (std::size_t i = 0; i < p; ++i) direction[i] = axes[i][j];
    combine(cloud, direction, line);
    const double s = median_deviation(line, cloud.rows, scratch);
    scale[j] = s > kTuning.smallest_scale ? s : kTuning.smallest_scale;
    factor[j] = 1 / scale[j];
  }
  double* const center =
      out.covariance;  // until that is filled: a fourth array would be too much for a stack
  for (std::size_t j = 0; j < p; ++j) {
    for (std::size_t i = 0; i < p; ++i) direction[i] = entry(axes, factor, p, j, i);
    combine(cloud, direction, line);
    center[j] = static_cast<double>(median(line, cloud.rows, scratch));
  }
  for (std::size_t j = 0; j < p; ++j) factor[j] = scale[j] * scale[j];
  for (std::size_t j = 0; j < p; ++j) {
    out.mean[j] = 0;
    for (std::size_t i = 0; i < p; ++i) out.mean[j] += entry(axes, scale, p, j, i) * center[i];
  }
  for (std::size_t j = 0; j < p; ++j)
    for (std::size_t k = 0; k <= j; ++k) out.covariance[packed(j, k)] = entry(axes, factor, p, j, k);
}

void converge_from(StartKind kind, const StartRoom& room, Search& search) {
  const Cloud& cloud = search.cloud;
  const std::size_t p = cloud.columns;
  const Matrix m{room.matrices, p}, axes{room.matrices + p * p, p};
  start_matrix(kind, cloud, search.scratch, room, m);
  find_axes(m, p, axes);
  const Moments sphere = search.scratch.moments(p);
  refit(cloud, axes, search.scratch, room.line, sphere);
  Shape<double> shape = search.scratch.shape(p);
  make_shape(sphere, p, search.scratch, shape);
  c_step(cloud, (cloud.rows + 1) / 2, search.scratch, shape);
  search.converge(shape);
}

}  // namespace
}  // namespace mcd

Status Mcd::deterministic(const float* data, std::size_t rows, std::size_t columns, McdStarts starts,
                          const McdOptions& options) {
  const Status status = prepare(data, rows, columns, options);
  if (status != Status::ok || state_->active_columns == 0)
    return status == Status::ok ? finish(options) : status;
  mcd::Search search = state_->begin_search(best_);
  const mcd::StartRoom room{state_->other, state_->scratch.distance, state_->order, state_->matrices};
  if (starts == McdStarts::median_ball)
    mcd::converge_from(mcd::StartKind::median_ball, room, search);
  else
    for (mcd::StartKind kind : mcd::kAllStarts) mcd::converge_from(kind, room, search);
  search.exchange(options.exchanges);
  full_steps_ = search.steps;
  return finish(options);
}

}  // namespace pliant
