#pragma once
// The observations of a frame as rows of the least-squares problem: information, residual, alternatives, and the noise of each
// cue (docs/algorithms.md, sections 5.6 and 7.6).
#include <cstdint>

#include "estimate/surface_points.hpp"
#include "pliant/observation.hpp"
#include "pliant/robust.hpp"

namespace pliant {

inline constexpr std::size_t kCueCount = 3;

/// Tuning of observation rows.
struct ObservationRowsTuning {
  /// Model error of edges, added to their noise, mm. Edges of lids and lips slide further over the surface than texture does.
  /// Chosen on the order of cues and the recorded face (docs/experiments.md, section Tuning).
  float edge_error_mm = 1.7f;
  /// Information of a usable observation, 1/px^2, at most: that of a millionth of a pixel. Beyond, products overflow. Round value.
  float most_information = 1e12f;
  /// Square of the distance of a usable observation from the picture's corner, px^2, at most: a million px. Far beyond, squares
  /// of residuals overflow, and no step of the solve lowers an infinite cost. Round value.
  float most_distance_px2 = 1e12f;
  /// Tukey weight below which a row is an outlier. Round value, not tuned.
  float least_weight = 0.1f;
  /// Range of the robust scale of all residuals, in standard deviations. Below 1 the observations' own noise counts; above 8
  /// nothing fits anyway. Round values, not tuned.
  float least_scale = 1, most_scale = 8;
  /// Largest scale of the noise of one cue, in standard deviations, and the fewest rows that it is measured from. Round
  /// values, not tuned.
  float most_cue_scale = 4;
  std::size_t least_cue_rows = 8;
  /// Ratio of determinant to squared trace of an information below which it has rank one. One direction then weighs less
  /// than a thousandth of the other.
  float line_ratio = 1e-3f;
  /// Largest ratio of an information to that of the model error, which is added. Beyond, it is that of the model error within
  /// rounding, and the determinants of the sum, of a line, would be nothing but rounding. Round value, not tuned.
  float most_over_error = 1e5f;
};
inline constexpr ObservationRowsTuning kObservationRowsTuning{};

/// One row: the observations of one point, of which one counts.
struct ObservationRow {
  std::uint16_t id, first;     ///< point; its first observation
  std::uint8_t count, chosen;  ///< observations from `first` on, some perhaps unusable; the one in use
  Cue cue;
  bool is_kept, is_line;  ///< takes part in the minimisation; has information of rank one
};

/// How observations become rows.
struct RowPolicy {
  std::uint8_t cues = 0;     ///< bit k: cue k takes part
  float model_error_mm = 0;  ///< of all cues but edges
  float cue_scale_rate = 0;  ///< fraction by which a cue's scale follows its residuals, a frame
};

/// The rows of one solve, and the noise scale of each cue from frame to frame.
/// Lengths are whitened: they are in standard deviations of the observation. The length of a line is multiplied by the ratio of
/// the medians of a Rayleigh and a half-normal variable, so that one robust scale fits lines and points. The cost is without
/// it, so that the equations are its slope. Bytes: 36 a row.
class ObservationRows {
 public:
  void lay_out(Arena& arena, std::size_t rows);
  /// Starts without rows, with all cue scales at 1.
  void start(const RowPolicy& policy);
  void clear() { count_ = 0; }

  /// Makes a row of each run of usable observations with one id. Unusable observations are marked not_visible, those of a
  /// cue that is switched off rejected. The observations must stay until the last use of the rows.
  /// \param px_per_mm  image scale at which the model error is added.
  void gather(Span<Observation> observations, const SurfacePoints& points, float px_per_mm);

  std::size_t count() const { return count_; }
  ObservationRow& operator[](std::size_t k) { return rows_[k]; }
  const ObservationRow& operator[](std::size_t k) const { return rows_[k]; }
  /// Of each row, at the last `measure`.
  Vec2 residual(std::size_t k) const { return residuals_[k]; }
  Sym2 information(std::size_t k) const { return information_[k]; }
  float length(std::size_t k) const { return lengths_[k]; }
  /// Sum of the rows' losses at the last `measure`; of lines, over the square of that ratio. \param only_kept  of the rows that
  /// take part.
  float cost(Loss loss, float scale, bool only_kept) const;
  Observation* observations_of(std::size_t k) { return &observations_[rows_[k].first]; }

  /// Equations of all rows: two for a point, one for a line.
  std::size_t equations() const { return equations_; }
  /// Points, and points of cue patch, that the platform searched for.
  std::size_t searched() const { return searched_; }
  std::size_t patches_searched() const { return patches_searched_; }

  /// Chooses the alternative nearest to the projected position x, and computes residual and length of the row.
  void measure(std::size_t k, Vec2 x);
  /// Robust scale of the lengths of the rows kept, within the tuning's range.
  float scale();
  /// Keeps exactly the rows whose length is at most `limit`.
  void keep_within(float limit);
  /// Fraction of the rows that Tukey's loss in this scale makes outliers.
  float outlier_fraction(float scale) const;
  /// Squared residual of a row, px^2; of a line, across it.
  float squared_px(std::size_t k) const;

  /// Moves each cue's scale towards the ratio of its residuals to its standard deviations.
  void update_cue_scales();
  float cue_scale(Cue cue) const { return cue_scale_[static_cast<std::size_t>(cue)]; }

 private:
  bool is_usable(const Observation& o, const SurfacePoints& points) const;
  Sym2 information_of(const Observation& o) const;

  RowPolicy policy_;
  float cue_scale_[kCueCount] = {1, 1, 1};
  float px_per_mm_ = 1;
  Span<Observation> observations_;
  ObservationRow* rows_ = nullptr;
  std::size_t count_ = 0, capacity_ = 0;
  std::size_t equations_ = 0, searched_ = 0, patches_searched_ = 0;
  Sym2* information_ = nullptr;
  Vec2* residuals_ = nullptr;
  float *lengths_ = nullptr, *sorted_ = nullptr;
};

/// True if a length in this scale is that of an inlier.
inline bool is_inlier(float length, float scale) {
  return evaluate(Loss::tukey, length / scale).weight > kObservationRowsTuning.least_weight;
}

}  // namespace pliant
