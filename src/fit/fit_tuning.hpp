#pragma once
// Tuning of the fit of one image.
#include <cstddef>

namespace pliant {

/// Each constant: meaning, unit, reason, experiment.
struct FitTuning {
  /// Rounds of minimisation, count. All but the last use Huber's loss, whose cost has one minimum; the last uses Tukey's,
  /// which gives gross outliers no weight. The robust scale is renewed before each. Round value, not tuned.
  int stages = 3;
  /// Matches of silhouette landmarks a stage, count. Between two matches the contour points stay fixed, so a match that
  /// moves needs a few repeats. The experiment that chose 3 is not recorded; with 3, a face rendered at 30 degrees of yaw is
  /// fitted as well as a frontal one (tests/unit/host/fit_face_test.cpp).
  int silhouette_matches = 3;
  /// Times that a folded-over state is moved back before the last valid one is taken, count. One is enough where positions are
  /// linear in the parameters; with rotations the fold-over may remain. Not tuned.
  int fold_over_tries = 6;
  /// Vectors that move no vertex by this, mm, are left out of the question whether a fit has folded the surface over, which is one
  /// of right angles in triangles of 8 mm. Round value, not tuned.
  float fold_over_slack_mm = 0.2f;
  /// Standard deviation of log(f / expected f) where the focal length is not known. 0.3 spans most cameras of phones and
  /// laptops, whose f is 0.7 to 2 times the larger side. Not tuned.
  float focal_log_sd = 0.3f;
  /// Points are on one line if their spread across it is below this many standard deviations of a point, or below this
  /// fraction of their spread along it. The rotation about the line is then undetermined. The fraction is above the rounding
  /// error of floats. Tested on exact and noisy lines (tests/unit/fit/fit_test.cpp).
  float line_sds = 2;
  float line_fraction = 0.005f;
  /// Iterations of the pose-only fit of each candidate for the initial view, before and after its robust scale is
  /// renewed, count. Enough to tell which candidate has the lowest cost. Not tuned.
  int start_iterations = 6, start_iterations_rescaled = 4;
  /// Yaw of the turned candidates, rad, either way. They help where the weak-perspective candidates are on the wrong side
  /// of a nearly flat set of points. Not tuned.
  float start_yaw_rad = 0.5f;
  /// Ridge of the weak-perspective equations, as a fraction of their trace: keeps flat sets of points solvable. The result
  /// is refined afterwards, so the value matters little. Round value.
  float ridge_fraction = 1e-3f;
  /// Largest step of an iteration: turn (rad), and log of scale and of perspective. The projection is far from linear
  /// beyond. Round values.
  float max_turn_rad = 0.5f, max_log_step = 0.7f;
};
inline constexpr FitTuning kFitTuning{};

/// Tuning of the search for other solutions (docs/experiments.md, Other solutions of a fit).
struct OtherSolutionTuning {
  /// Other states are tried where the points at rest are nearly in a plane: standard deviation across it, at most, as a fraction of
  /// their spread. Five and more landmarks of the built-in face have 0.14 and more, sheets 0.
  float most_relief = 0.1f;
  /// They are also tried with so few points, count, unless the model is of people: of 60 portraits no fit to 5, 9 or all landmarks
  /// had a better solution. And where the robust cost is above this a point: it is two standard deviations away on average. The
  /// page of points does both.
  std::size_t few_points = 9;
  float good_cost = 2;
  /// Another solution counts if its cost is below this fraction of the first one's.
  float clearly_better = 0.7f;
  /// States that are tried, and iterations from each, count; and the tilts of four of them, rad. As the page of points has them.
  int states = 6, iterations = 8;
  float tilt_rad = 0.5f;
};
inline constexpr OtherSolutionTuning kOtherSolutionTuning{};

/// Tuning of the match of silhouette landmarks.
struct SilhouetteMatchTuning {
  /// Side of the depth buffer that hides parts of the contour, cells. It covers the image of the base mesh. Not tuned.
  int depth_cells = 48;
  /// A landmark's own place is turned away where the cosine between its normal and the viewing ray is below this. Just
  /// before the contour (0), so that a landmark does not jump when it gets there. Not tuned.
  float turned_away_cosine = 0.1f;
  /// Largest distance of a contour point from the landmark's (u,v): along v, in units of the chart; along u, the larger of a
  /// distance and a fraction of the distance to the middle of the face. Further away is the contour of the nose. Fits the charts of
  /// the built-in face and of ICT-FaceKit; the experiment is not recorded.
  float reach_v = 0.12f, reach_u = 0.15f, reach_u_fraction = 0.6f;
};
inline constexpr SilhouetteMatchTuning kSilhouetteMatchTuning{};

}  // namespace pliant
