#pragma once
/// \file person_estimate.hpp
/// What the frames of a track say of the person, view by view (docs/algorithms.md, section 7.20).
#include "pliant/geometry.hpp"
#include "track/person_equations.hpp"

namespace pliant {

/// Tuning of the estimate. Chosen on six rendered people who turn to 60 degrees (docs/experiments.md, Turned heads).
struct PersonEstimateTuning {
  /// Sines of yaw that separate the views: every 15 degrees, the middle view is frontal. Templates change
  /// about so fast.
  float yaw_sines[4] = {0.1305f, 0.3827f, 0.6088f, 0.7934f};
  /// Frames that a view's mean goes back. More frames of one view tell nothing new: their errors repeat. Round value.
  std::size_t most_frames = 8;
  /// Views, at least, before the estimate is used: what one view says of depth is less than its systematic errors. With the
  /// outermost two 30 degrees apart, twenty rendered heads that turn had 3.29 instead of 3.18 degrees at 95 % found by
  /// detection, 2.27 instead of 2.04 from landmarks, and the recorded face 2.13 instead of 2.08 % from 25 points, 3.70
  /// instead of 3.68 % from five.
  int least_views = 2;
  /// rad. Standard deviation of the rotation that the start got wrong. An alignment's error is 3 to 5 degrees.
  float turn_sd = 0.087f;
};
inline constexpr PersonEstimateTuning kPersonEstimateTuning{};

/// Information on the turn of the model against its start and on the identity, one mean a view, in fixed
/// memory: frames of one view are averaged and not added, so that errors that repeat do not count as many
/// measurements.
/// Bytes: 36 n (n + 3) / 2 + 36 for n = 3 + identity parameters.
class PersonEstimate {
 public:
  static constexpr std::size_t kViews = 9;

  /// \param unknowns  3 + identity parameters.
  void lay_out(Arena& arena, std::size_t unknowns);
  void clear();

  /// The view in which the camera lies in this direction (model's axes, unit).
  static std::size_t view_towards(Vec3 camera);
  /// Frames that the mean of a view holds.
  std::size_t frames(std::size_t view) const { return frames_[view]; }
  /// Takes the last unknowns of `frame`, linearised at `now`, into the mean of a view.
  void add(std::size_t view, PersonEquations& frame, const float* now);
  /// Whether there are enough views.
  bool is_usable() const;
  /// The value that agrees best with all views and with the start. \param start, sd  of each identity parameter.
  /// \param equations  of at least as many unknowns, the last of which have what else is known, counted from zero; is
  ///        overwritten. \return false where it cannot be solved.
  bool solve(const float* start, const float* sd, PersonEquations& equations, float* x) const;

 private:
  std::size_t stride() const { return unknowns_ * (unknowns_ + 3) / 2; }

  float* means_ = nullptr;  // of each view: the upper triangle of H, then g
  std::size_t frames_[kViews] = {};
  std::size_t unknowns_ = 0;
};

}  // namespace pliant
