#pragma once
/// \file image_forces.hpp
/// Rejection of outlying image forces in parameter space (the paper, Appendix A; docs/algorithms.md, section 6.5).
#include "pliant/geometry.hpp"
#include "pliant/outliers.hpp"

namespace pliant {

/// Largest number of columns: seven for the pose with the focal length, and one spare.
inline constexpr std::size_t kForceMaxColumns = 8;

/// Options of ForceRejector::reject.
struct ForceOptions {
  /// Quantile of the chi-square distribution beyond which a force is rejected, in (0,1). Three times the
  /// quantile of 0.999 rejects fewer true forces, but misses an occluder at rest (docs/algorithms.md, section
  /// 6.5).
  float cutoff = 0.999f;
  /// Forces up to this length are never rejected, px: at rest all forces are noise.
  float noise_px = 0.1f;
  /// Initial subsets of the MCD estimate. One is as good as six here, and eight times cheaper.
  McdStarts starts = McdStarts::median_ball;
};

/// Finds which of n image forces agree about the motion. Each force f_i (2, px) contributes the generalised
/// force B_i^T f_i (Eq. 9), a row of p values. The rows of one motion form one cluster, wherever the points
/// lie on the model. A coherent occluder forms another cluster, which weights on residuals alone do not
/// separate.
///
/// The caller must observe three rules:
/// - B_i holds only the 5 or 6 columns of the rigid block. A local parameter moves few points, and a column that is
///   zero in most rows has no spread.
/// - Forces are formed at the predicted state, where the true forces are the tight cluster near zero. At the
///   old state an occluder at rest is that cluster.
/// - The quantile is nominal, since the rows are a mixture of planes: about one true force in six is
///   rejected. After the first solve, use rejected forces with a small residual again
///   (Rejection::forces_readmitted does).
class ForceRejector {
 public:
  /// `limits.columns` is the size of the block, at most kForceMaxColumns. Bytes: those of `Mcd` and 4 a value.
  void lay_out(Arena& arena, const McdLimits& limits);

  /// Decides about all forces.
  /// \param jacobian  rows x 2 x columns: for each point the row of x, then that of y (px per unit of the parameter).
  /// \param force     observed minus predicted position, px. A force is rejected if it or its jacobian is not finite.
  /// \param keep      out: 1 for a force that is kept, 0 for one that is rejected.
  /// \return too_few_points for fewer than 5 finite forces a column; then all of them are kept. capacity, or
  ///         bad_argument for null, no column or an option out of range; then `keep` is unchanged.
  /// Cost: that of `Mcd::deterministic`, and rows x columns^2 multiply-adds.
  Status reject(const float* jacobian, const Vec2* force, std::size_t rows, std::size_t columns,
                const ForceOptions& options, std::uint8_t* keep);

  /// Decides about one more force by the centre and covariance of the last `reject`. Of very many forces, a sample is
  /// enough for the estimate.
  /// \param jacobian  2 x columns, as before.
  /// Cost: columns^2 multiply-adds.
  bool agrees(const float* jacobian, Vec2 force) const;

  /// The estimate of the last `reject`, in whitened parameters.
  const Mcd& mcd() const { return mcd_; }

 private:
  void whiten(const float* jacobian, std::size_t rows, std::size_t columns, const std::uint8_t* finite);

  void project(const float* jacobian, Vec2 force, double* row) const;
  void factorise();

  Mcd mcd_;
  double whiten_[kForceMaxColumns * (kForceMaxColumns + 1) / 2] = {};  // L by rows, its pivots inverted
  // Of the estimated covariance, likewise.
  double factor_[kForceMaxColumns * (kForceMaxColumns + 1) / 2] = {};
  double unit_ = 1;
  float least_ = 0;  // squared length of a force that is never rejected
  std::size_t columns_ = 0;
  float* row_ = nullptr;
  std::size_t row_capacity_ = 0, column_capacity_ = 0;
};

}  // namespace pliant
