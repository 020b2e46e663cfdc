#pragma once
// Tuned constants of the edge finder.

namespace pliant {

/// Tuning of the edge search. Each constant: unit, reason, experiment. The experiments are the tests of edges of
/// known position (tests/unit/vision/edges_test.cpp).
struct EdgeTuning {
  /// Search range in standard deviations of the prediction. Three hold 99.7 % of normally distributed errors.
  float range_sd = 3;
  /// Smallest and largest search range, px. Round values, not tuned.
  float min_range_px = 2, max_range_px = 24;
  /// Smallest step, grey levels. Round value, not tuned.
  float min_step_grey = 8;
  /// How far the derivative must stand out of the local noise, standard deviations. 4.5 gives false edges at under 3
  /// % of points on noise alone (test "without an edge none is found").
  float min_derivative_sd = 4.5f;
  /// How far the derivative's second difference must stand out, standard deviations. With less, noise chooses among
  /// the positions on a flat maximum, and the claimed variance is too small (test "with noise the claimed deviation
  /// is the real one", blur 3 px, noise of 10 grey levels).
  float min_bend_sd = 6;
  /// Added in squares to the prediction's deviation before near edges are preferred, px: edges closer than this are
  /// equally likely. Round value, not tuned.
  float indifference_px = 1;
  /// Preference of an alternative relative to the best edge, at least. Round value, not tuned.
  float min_alternative_fraction = 0.5f;
  /// If more edges than hypotheses reach this fraction of the best one's preference, the point is ambiguous. Round
  /// value, not tuned.
  float ambiguous_fraction = 0.8f;
  /// Noise of a pixel that is assumed at least, grey levels: rounding.
  float noise_floor_grey = 1;
  /// Standard deviation that no result claims to be better than, px. The error on clean edges is 0.01 to 0.05 px.
  float position_floor_px = 0.05f;
};
inline constexpr EdgeTuning kEdgeTuning{};

}  // namespace pliant
