#pragma once
/// \file outliers.hpp
/// Minimum covariance determinant: a robust centre and covariance of a point cloud, and its outliers (Rousseeuw & Van
/// Driessen 1999; Hubert, Rousseeuw & Verdonck 2012; docs/algorithms.md, sections 6.1 to 6.6).
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"

namespace pliant {

/// Largest number of columns.
inline constexpr std::size_t kMcdMaxColumns = 24;
/// Largest number of rows: row numbers are 16-bit.
inline constexpr std::size_t kMcdMaxRows = 4096;
/// Squared distance of a row that lies outside a subspace that holds the majority.
inline constexpr float kMcdOffSubspace = 1e30f;

/// Fix the memory of an Mcd: the largest data. Bytes for p columns: 8 a value, 24 a row, 1,290 a column, 150
/// p^2, and 20 kB: 50 kB for 256 x 6, 1 MB for 4096 x 24. About 2 kB of stack besides.
struct McdLimits {
  std::size_t rows = 512;   ///< at most kMcdMaxRows
  std::size_t columns = 6;  ///< at most kMcdMaxColumns
};

/// Options of an Mcd search.
struct McdOptions {
  /// Size of the subset as a fraction of the rows, in [0.5, 1]. 0.5 tolerates outliers in half of the rows,
  /// 0.75 in a quarter.
  float alpha = 0.5f;
  /// Quantile of chi-square beyond which a row is flagged, in (0,1).
  float cutoff = 0.975f;
  /// Random starts of `fast`, in [1, 100000].
  std::uint32_t starts = 500;
  /// Exchanges of single rows after the C-steps, at most. 50 find lower determinants than thousands of
  /// starts; each costs about three C-steps on all rows. 0 is the published algorithm.
  std::uint32_t exchanges = 0;
  /// Seed of the random generator of `fast`. Equal seeds give equal bits.
  std::uint64_t seed = 1;
};

/// Which deterministic starts to try. With hundreds of rows one is about as good as six, and many times
/// cheaper. With a few dozen rows six find lower determinants; one start followed by exchanges does too.
enum class McdStarts : std::uint8_t { median_ball, all_six };

/// A positive number mantissa * 2^exponent, mantissa in [0.5, 1): a determinant that cannot overflow.
struct ScaledNumber {
  double mantissa = 0.5;  ///< in [0.5, 1)
  int exponent = 1;       ///< of 2
};

/// Centre (`columns` values) and covariance (columns x columns, by rows, symmetric, semi-definite).
struct McdEstimate {
  double center[kMcdMaxColumns];                       ///< one value a column, in its unit
  double covariance[kMcdMaxColumns * kMcdMaxColumns];  ///< columns x columns, by rows
};

/// Searches the h of n rows whose covariance has the smallest determinant. They give the raw estimate, scaled
/// to be consistent for Gaussian data and corrected for small samples (Pison, Van Aelst & Willems 2002). All
/// rows near the raw estimate give the reweighted one. Results are valid until the next call.
///
/// Rows with a NaN or an infinity are ignored: squared distance kMcdOffSubspace. Values further than 1e9
/// median absolute deviations from the median count as that far.
///
/// Statuses of `fast` and `deterministic`:
/// - ok
/// - degenerate_data: h or more rows share a subspace (a constant column, a plane). The results are those within the
///   subspace: rows off it are flagged, and the covariance is singular, or nearly so
/// - too_few_points: at most columns + 1 finite rows. No finite row is flagged; the centre holds medians, the
///   covariance 0
/// - capacity: more rows or columns than the limits; nothing has changed
/// - bad_argument: null data, no column, or an option out of range; nothing has changed
class Mcd {
 public:
  /// Takes its memory from the arena; called by create_in and measured_bytes (arena.hpp).
  void lay_out(Arena& arena, const McdLimits& limits);

  /// FAST-MCD on `rows` x `columns` values, by rows. Makes two C-steps from each of `starts` random subsets,
  /// and follows the ten best to convergence. Above 600 rows the starts run on at most five groups of about
  /// 300 rows first.
  /// Cost: about starts x min(rows, 600) x columns^2 x 2 multiply-adds.
  Status fast(const float* data, std::size_t rows, std::size_t columns, const McdOptions& options = {});

  /// DetMCD on the same. Not random; the result does not depend on the order of the rows, up to rounding and ties.
  /// Cost of a start: about rows x columns^2 x 12 multiply-adds.
  Status deterministic(const float* data, std::size_t rows, std::size_t columns, McdStarts starts,
                       const McdOptions& options = {});

  std::size_t rows() const { return rows_; }        ///< Rows of the last data.
  std::size_t columns() const { return columns_; }  ///< Columns of the last data.
  /// Size h of the best subset, and its rows in ascending order.
  Span<const std::uint16_t> best_subset() const { return {best_, best_count_}; }
  /// Determinant of the plain covariance (divided by h - 1) of the best subset, over the columns that vary.
  ScaledNumber determinant() const { return determinant_; }
  /// The best subset's mean and covariance times both corrections.
  const McdEstimate& raw() const { return estimates_[0]; }
  /// Mean and corrected covariance of the rows that `raw` does not flag.
  const McdEstimate& reweighted() const { return estimates_[1]; }
  /// Consistency factor times small-sample factor of each estimate.
  double raw_correction() const { return raw_correction_; }
  /// The same of the reweighted covariance.
  double reweighted_correction() const { return reweighted_correction_; }
  /// Squared distance beyond which rows are flagged.
  double cutoff() const { return cutoff_; }
  /// Squared Mahalanobis distances of all rows, finite and not negative.
  Span<const float> raw_squared_distances() const { return {raw_distance_, rows_}; }
  /// Those from the reweighted estimate.
  Span<const float> squared_distances() const { return {distance_, rows_}; }
  /// Whether a row lies beyond the cutoff of the reweighted estimate.
  bool is_flagged(std::size_t row) const { return !(distance_[row] <= static_cast<float>(cutoff_)); }
  /// The same of the raw estimate.
  bool is_flagged_raw(std::size_t row) const { return !(raw_distance_[row] <= static_cast<float>(cutoff_)); }
  /// C-steps on all rows in the last call.
  std::size_t full_steps() const { return full_steps_; }

 private:
  struct State;  // in the arena

  Status prepare(const float* data, std::size_t rows, std::size_t columns, const McdOptions& options);
  bool standardise(const float* data);
  bool standardise_column(const float* data, std::size_t column);
  void keep_rows_at(const float* data, std::size_t column, float value);
  void answer_too_few(const float* data);
  Status finish(const McdOptions& options);
  bool estimate_from(const std::uint16_t* row, std::size_t count, double correction, float* distance,
                     McdEstimate& estimate, ScaledNumber& determinant);

  State* state_ = nullptr;
  std::uint16_t* best_ = nullptr;
  float *distance_ = nullptr, *raw_distance_ = nullptr;  // a row
  std::size_t rows_ = 0, columns_ = 0, best_count_ = 0, full_steps_ = 0;
  ScaledNumber determinant_;
  McdEstimate* estimates_ = nullptr;  // raw, reweighted
  double raw_correction_ = 1, reweighted_correction_ = 1, cutoff_ = 0;
};

/// Size h of the subset for n rows, p columns: floor(2m - n + 2(n - m) alpha), m = floor((n + p + 1) / 2).
std::size_t mcd_subset_size(std::size_t rows, std::size_t columns, double alpha);

/// Quantile of chi-square with `freedom` in [1, 26] degrees of freedom, probability in [1e-12, 1 - 1e-6], to 1e-9 relative. For a
/// smaller probability it is too large. For a larger one its error is what the rounding of the probability makes it. Outside
/// (0,1), or for NaN, it is some value from 0 to about 400. At most 80 steps. No libm.
double chi_square_quantile(std::size_t freedom, double probability);
/// P(chi-square with `freedom` degrees <= x), to 1e-12.
double chi_square_probability(std::size_t freedom, double x);
/// Factor that makes the covariance of the central fraction of Gaussian data consistent:
/// fraction / P(chi2_{p+2} <= chi2_{p;fraction}). 1 for fraction >= 1.
double mcd_consistency_factor(std::size_t columns, double fraction);
/// Small-sample factors of the raw and the reweighted covariance (Pison, Van Aelst & Willems 2002), alpha in
/// [0.5, 1].
double mcd_small_sample_raw(std::size_t rows, std::size_t columns, double alpha);
/// The same of the reweighted covariance.
double mcd_small_sample_reweighted(std::size_t rows, std::size_t columns, double alpha);

}  // namespace pliant
