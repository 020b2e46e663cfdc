#pragma once
/// \file fit_problem.hpp
/// Fitting problems for `pliant bench fit`, one text file each: image points of a shape that is linear in its coefficients,
/// seen by a pinhole camera. The coefficients have a prior of standard deviation 1.
#include <string>
#include <vector>

#include "pliant/camera.hpp"
#include "pliant/euler.hpp"
#include "pliant/robust.hpp"

namespace pliant::host {

/// A fitting problem and its state. Unknowns: rotation, log s, translation, log rho unless the focal length is known; then
/// the coefficients.
class LinearShapeFit {
 public:
  /// Reads `corr N modes K cx X cy Y sigma_px S`, `camera_true`, `camera_start` (rotation vector, translation, focal
  /// length), `coef_true`, and a line a point: u v, mean x y z, basis by rows (x, y, z) of K. Camera axes.
  /// Any other text is bad input; the message names the file.
  explicit LinearShapeFit(const std::string& path);

  std::size_t point_count() const { return observed_.size(); }
  std::size_t mode_count() const { return modes_; }
  std::size_t unknown_count() const { return pose_unknowns() + modes_; }

  void set_focal_known(bool known) { focal_is_known_ = known; }
  void set_loss(Loss loss) { loss_ = loss; }
  void set_prior(bool prior) { prior_ = prior ? 1.0f : 0.0f; }
  /// Sets the initial state of the next minimisation. \param camera  rotation vector, translation, focal length.
  void start_at(const std::vector<double>& camera, const std::vector<double>& coefficients);
  const std::vector<double>& camera_start() const { return camera_start_; }
  const std::vector<double>& camera_true() const { return camera_true_; }
  const std::vector<double>& coefficients_true() const { return coefficients_true_; }

  LeastSquaresProblem problem();
  /// The cost at the accepted state, loss and prior included, in double precision: half the sum of squares of residuals
  /// divided by sigma.
  double exact_cost() const;

 private:
  std::size_t pose_unknowns() const {
    return static_cast<std::size_t>(focal_is_known_ ? kPoseUnknowns : kPoseUnknownsWithFocal);
  }
  Vec3 position(std::size_t point, const float* coefficients) const;
  float linearise(NormalEquations& equations);
  float try_step(const float* step);
  float cost(const View& view, const float* coefficients) const;
  float prior_cost(const float* coefficients) const;

  std::size_t modes_ = 0;
  float sigma_ = 1;
  Vec2 centre_;
  std::vector<Vec2> observed_;
  std::vector<Vec3> mean_;
  std::vector<float> basis_;  // for each point 3 rows of modes_
  std::vector<double> camera_true_, camera_start_, coefficients_true_;
  bool focal_is_known_ = false;
  float prior_ = 1;
  Loss loss_ = Loss::squares;
  View view_, trial_view_;
  std::vector<float> coefficients_, trial_, along_x_, along_y_;
};

}  // namespace pliant::host
