#pragma once
/// \file image_forces.hpp
/// Rejection of false image forces in parameter space (the paper's Appendix A; ALGORITHMS 6.5).
#include "pliant/geometry.hpp"
#include "pliant/outliers.hpp"

namespace pliant {

/// Largest block of parameters: the rigid ones with the focal length, and one more.
inline constexpr std::size_t kForceMaxColumns = 8;

struct ForceOptions {
  float cutoff = 0.999f;  ///< in (0,1): quantile of chi-square beyond which a force is rejected
  float noise_px =
      0.1f;  ///< forces no longer than this are never rejected: at rest there is nothing to tell apart
  McdStarts starts = McdStarts::median_ball;  ///< one start is as good as six here
};

/// Tells which of n image forces agree about the motion. Each force f_i (px, 2) pulls the parameters by the generalised
/// force B_i^T f_i (Eq. 9): one row of p values a point. Forces of one motion form one cluster there, whatever their
/// place on the model; a coherent occluder forms another, which weights on residuals alone don't see.
///
/// Three things that the mathematics asks for, and the caller keeps to:
/// - B_i holds the columns of the rigid block only (5 or 6): a local parameter moves few points, and a column that is
///   zero in most rows has no spread;
/// - forces are formed at the *predicted* state: there the true ones are the tight cluster near zero. At the old state
///   a thing that stands still is, and is preferred;
/// - the quantile is nominal, for the rows are a mixture of planes: about one true force in six goes. `readmit` brings
///   these back after the first solve.
class ForceRejector {
 public:
  /// `limits.columns` is the size of the block, at most kForceMaxColumns. Bytes: those of `Mcd` and 4 a value.
  void lay_out(Arena& arena, const McdLimits& limits);

  /// \param jacobian  rows x 2 x columns: of each point the row of x, then that of y (px per unit of the parameter).
  /// \param force     observed minus predicted position, px. One that is not finite, or whose jacobian isn't, is
  ///                  rejected.
  /// \param keep      out: 1 where the force is kept, 0 where it is rejected.
  /// - ok; - too_few_points: fewer than 5 finite forces a column: all of them are kept;
  /// - capacity, bad_argument (null, no column, an option out of range): `keep` is as it was.
  /// Cost: that of `Mcd::deterministic` and rows x columns^2 multiply-adds.
  Status reject(const float* jacobian, const Vec2* force, std::size_t rows, std::size_t columns,
                const ForceOptions& options, std::uint8_t* keep);

  /// The same decision about a force that was not among those of the last `reject`, by their centre and covariance: with
  /// very many, a sample of them is enough to estimate from. Cost: columns^2 multiply-adds.
  /// \param jacobian  2 x columns, as before.
  bool agrees(const float* jacobian, Vec2 force) const;

  /// The estimate behind the last decision, in whitened parameters.
  const Mcd& mcd() const { return mcd_; }

 private:
  void whiten(const float* jacobian, std::size_t rows, std::size_t columns, const std::uint8_t* finite);

  void project(const float* jacobian, Vec2 force, double* row) const;
  void factorise();

  Mcd mcd_;
  double whiten_[kForceMaxColumns * (kForceMaxColumns + 1) / 2] = {};  // L by rows, its pivots inverted
  double factor_[kForceMaxColumns * (kForceMaxColumns + 1) / 2] =
      {};  // the same of the estimate's covariance
  double unit_ = 1;
  float least_ = 0;  // squared length of a force that is never rejected
  std::size_t columns_ = 0;
  float* row_ = nullptr;
  std::size_t row_capacity_ = 0, column_capacity_ = 0;
};

/// After the first solve: keeps every point whose residual (px) is finite and at most `factor` times the scale of the
/// residuals kept so far (their median length / 1.1774, at least `noise_px`), be it one kept before or not. Gives how
/// many that are. `scratch`: a float a point. Follow it by two or three more robust iterations.
std::size_t readmit(const Vec2* residual, std::size_t rows, float factor, float noise_px, float* scratch,
                    std::uint8_t* keep);

}  // namespace pliant
