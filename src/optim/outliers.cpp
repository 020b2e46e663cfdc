// Minimum covariance determinant: the steps before the search (finite rows, columns in units of their own spread) and after
// it (corrections, reweighting, distances); docs/algorithms.md, sections 6.1, 6.4 and 6.6.
//
// Columns are scaled by their median absolute deviations. The estimate is affine equivariant, so this changes nothing in
// exact arithmetic; in floats it allows one pivot floor for all data. A column whose h central values are equal spans no
// volume. It is left out, with every row that differs there; the factorisation would fail on it.
#include "pliant/outliers.hpp"

#include "optim/mcd_search.hpp"
#include "pliant/geometry.hpp"

namespace pliant {

namespace {

constexpr double kFarthest = 1e9;  // scales

constexpr std::size_t round_up(std::size_t n) {
  return (n + mcd::kRowPadding - 1) / mcd::kRowPadding * mcd::kRowPadding;
}

float narrow(double x) {
  constexpr double kMost = 3e38;
  return static_cast<float>(x > kMost ? kMost : (x < -kMost ? -kMost : x));
}

bool is_valid(const McdOptions& o) {
  return o.alpha >= 0.5f && o.alpha <= 1.0f && o.cutoff > 0.0f && o.cutoff < 1.0f && o.starts >= 1 &&
         o.starts <= 100000;
}

}  // namespace

void Mcd::lay_out(Arena& arena, const McdLimits& limits) {
  PLIANT_ASSERT(limits.rows <= kMcdMaxRows && limits.columns <= kMcdMaxColumns);
  row_capacity_ = limits.rows < kMcdMaxRows ? limits.rows : kMcdMaxRows;
  column_capacity_ = limits.columns < kMcdMaxColumns ? limits.columns : kMcdMaxColumns;
  stride_ = round_up(row_capacity_) + mcd::kRowPadding;  // groups of rows may read past their end
  const std::size_t p = column_capacity_;
  z_ = arena.take<float>(stride_ * p);
  other_ = arena.take<float>(stride_ * p);
  float** const columns[] = {&work_, &distance_, &raw_distance_};
  for (float** column : columns) *column = arena.take<float>(stride_);
  std::uint16_t** const lists[] = {&row_of_, &subset_, &best_, &order_};
  for (std::uint16_t** list : lists) *list = arena.take<std::uint16_t>(stride_);
  key_ = arena.take<std::uint32_t>(stride_);
  block_float_ = arena.take<float>(mcd::kBlock * p);
  block_double_ = arena.take<double>(mcd::kBlock * p);
  matrices_ = arena.take<double>(2 * p * p);
  moments_room_ = arena.take<double>(p + mcd::packed_size(p));
  factor_room_ = arena.take<double>(mcd::packed_size(p));
  shape_room_ = arena.take<double>(p + mcd::packed_size(p));
  float_shape_room_ = arena.take<float>(p + mcd::packed_size(p));
  seen_ = arena.take<ScaledNumber>(mcd::kRemembered);
  candidate_pool_ = arena.take<float>(mcd::kCandidates * (p + mcd::packed_size(p)));
  histogram_ = arena.take<std::uint16_t>(mcd::kHistogram);
  estimates_ = arena.take<McdEstimate>(2);
  if (estimates_ != nullptr) estimates_[0] = estimates_[1] = {};
  if (histogram_ != nullptr && !arena.exhausted())
    for (std::size_t i = 0; i < mcd::kHistogram; ++i) histogram_[i] = 0;
  rows_ = columns_ = best_count_ = 0;
}

mcd::Scratch Mcd::scratch() const {
  return {work_,         subset_,       key_,         histogram_,  block_float_,
          block_double_, moments_room_, factor_room_, shape_room_, float_shape_room_};
}

mcd::Search Mcd::begin_search() {
  return {{z_, stride_, used_rows_, active_columns_}, subset_size_, scratch(), best_, seen_};
}

Status Mcd::prepare(const float* data, std::size_t rows, std::size_t columns, const McdOptions& options) {
  if (data == nullptr || columns == 0 || !is_valid(options)) return Status::bad_argument;
  if (rows > row_capacity_ || columns > column_capacity_) return Status::capacity;
  rows_ = rows;
  columns_ = columns;
  full_steps_ = best_count_ = 0;
  determinant_ = {};
  raw_correction_ = reweighted_correction_ = 1;
  estimates_[0] = estimates_[1] = {};
  finite_rows_ = 0;
  for (std::size_t i = 0; i < rows; ++i) {
    bool finite = true;
    for (std::size_t j = 0; j < columns; ++j) finite = finite && is_finite(data[i * columns + j]);
    row_of_[finite_rows_] = static_cast<std::uint16_t>(i);
    finite_rows_ += finite ? 1u : 0u;
    distance_[i] = raw_distance_[i] = finite ? 0.0f : kMcdOffSubspace;
  }
  used_rows_ = finite_rows_;
  cutoff_ = chi_square_quantile(columns, static_cast<double>(options.cutoff));
  if (finite_rows_ <= columns + 1) {
    answer_too_few(data);
    return Status::too_few_points;
  }
  subset_size_ = mcd_subset_size(finite_rows_, columns, static_cast<double>(options.alpha));
  active_columns_ = columns;
  for (std::size_t j = 0; j < columns; ++j) active_[j] = 1;
  for (std::size_t pass = 0; pass <= columns && !standardise(data); ++pass) {
  }
  return Status::ok;
}

void Mcd::answer_too_few(const float* data) {
  for (std::size_t j = 0; j < columns_ && used_rows_ > 0; ++j) {
    for (std::size_t i = 0; i < used_rows_; ++i) work_[i] = data[row_of_[i] * columns_ + j];
    estimates_[0].center[j] =
        static_cast<double>(mcd::kth_smallest(work_, used_rows_, (used_rows_ + 1) / 2, scratch()));
  }
  estimates_[1] = estimates_[0];
}

/// \return false when a column turned out to be constant. It is then inactive and the rows are fewer, so all columns have
/// to be standardised again.
bool Mcd::standardise(const float* data) {
  active_columns_ = 0;
  for (std::size_t j = 0; j < columns_; ++j)
    if (active_[j] != 0) {
      if (!standardise_column(data, j)) return false;
      ++active_columns_;
    }
  return true;
}

bool Mcd::standardise_column(const float* data, std::size_t column) {
  const std::size_t n = used_rows_, middle = (n + 1) / 2;
  for (std::size_t i = 0; i < n; ++i) work_[i] = data[row_of_[i] * columns_ + column];
  const float center = mcd::kth_smallest(work_, n, middle, scratch());
  const double median = static_cast<double>(center);
  for (std::size_t i = 0; i < n; ++i) {
    const double from_median = static_cast<double>(work_[i]) - median;
    work_[i] = narrow(from_median < 0 ? -from_median : from_median);
  }
  float deviation = mcd::kth_smallest(work_, n, middle, scratch());
  if (deviation == 0.0f) deviation = mcd::kth_smallest(work_, n, subset_size_, scratch());
  median_[column] = median;
  if (deviation == 0.0f) {
    active_[column] = 0;
    keep_rows_at(data, column, center);
    return false;
  }
  const double scale = mcd::kMadToDeviation * static_cast<double>(deviation);
  scale_[column] = scale;
  float* z = z_ + active_columns_ * stride_;
  for (std::size_t i = 0; i < n; ++i) {
    const double value = (static_cast<double>(data[row_of_[i] * columns_ + column]) - median) / scale;
    z[i] = static_cast<float>(value > kFarthest ? kFarthest : (value < -kFarthest ? -kFarthest : value));
  }
  for (std::size_t i = n; i < stride_; ++i) z[i] = 0;
  return true;
}

void Mcd::keep_rows_at(const float* data, std::size_t column, float value) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < used_rows_; ++i) {
    const std::uint16_t row = row_of_[i];
    const bool same = data[row * columns_ + column] == value;
    if (!same) distance_[row] = raw_distance_[row] = kMcdOffSubspace;
    row_of_[kept] = row;
    kept += same ? 1u : 0u;
  }
  used_rows_ = kept;
}

/// Mean and `correction` times covariance of the rows listed, the squared distances of all rows in that
/// metric, and the determinant of the plain covariance. True where it is regular.
bool Mcd::estimate_from(const std::uint16_t* row, std::size_t count, double correction, float* distance,
                        McdEstimate& estimate, ScaledNumber& determinant) {
  const mcd::Cloud cloud{z_, stride_, used_rows_, active_columns_};
  double shift[kMcdMaxColumns];
  for (std::size_t j = 0; j < active_columns_; ++j) shift[j] = static_cast<double>(z_[j * stride_ + row[0]]);
  const mcd::Scratch room = scratch();
  const mcd::Moments moments = room.moments(active_columns_);
  mcd::moments(cloud, row, count, shift, block_double_, moments);
  mcd::Shape<double> shape = room.shape(active_columns_);
  mcd::make_shape(moments, active_columns_, room, shape);
  mcd::squared_distances(cloud, shape, block_double_, work_);
  const float inverse = static_cast<float>(1 / correction);
  for (std::size_t i = 0; i < used_rows_; ++i) distance[row_of_[i]] = work_[i] * inverse;
  determinant = shape.determinant;
  std::size_t a = 0;
  for (std::size_t j = 0; j < columns_; ++j) {
    estimate.center[j] = median_[j];
    if (active_[j] == 0) continue;
    estimate.center[j] += scale_[j] * moments.mean[a];
    std::size_t b = 0;
    for (std::size_t k = 0; k <= j; ++k) {
      if (active_[k] == 0) continue;
      const double value = correction * scale_[j] * scale_[k] * moments.covariance[mcd::packed(a, b++)];
      estimate.covariance[j * columns_ + k] = estimate.covariance[k * columns_ + j] = value;
    }
    determinant = mcd::times(determinant, scale_[j] * scale_[j]);
    ++a;
  }
  return !shape.singular;
}

Status Mcd::finish(const McdOptions& options) {
  const std::size_t p = active_columns_, n = finite_rows_;
  const double alpha = static_cast<double>(options.alpha);
  if (p == 0) {  // all good rows are one point
    best_count_ = subset_size_;
    for (std::size_t i = 0; i < best_count_; ++i) best_[i] = row_of_[i];
    for (std::size_t j = 0; j < columns_; ++j) estimates_[0].center[j] = estimates_[1].center[j] = median_[j];
    return Status::degenerate_data;
  }
  cutoff_ = chi_square_quantile(p, static_cast<double>(options.cutoff));
  const double fraction = static_cast<double>(subset_size_) / static_cast<double>(n);
  raw_correction_ = mcd_consistency_factor(p, fraction) * mcd_small_sample_raw(n, p, alpha);
  const bool regular =
      estimate_from(best_, subset_size_, raw_correction_, raw_distance_, estimates_[0], determinant_);
  std::size_t good = 0;
  for (std::size_t i = 0; i < used_rows_; ++i) {
    subset_[good] = static_cast<std::uint16_t>(i);
    good += is_flagged_raw(row_of_[i]) ? 0u : 1u;
  }
  if (good <= p) {  // the corrections of tiny samples can flag nearly all rows; reweight from the subset then
    for (good = 0; good < subset_size_; ++good) subset_[good] = best_[good];
  }
  reweighted_correction_ = mcd_consistency_factor(p, static_cast<double>(good) / static_cast<double>(n)) *
                           mcd_small_sample_reweighted(n, p, alpha);
  ScaledNumber unused;
  estimate_from(subset_, good, reweighted_correction_, distance_, estimates_[1], unused);
  best_count_ = subset_size_;
  for (std::size_t i = 0; i < best_count_; ++i) best_[i] = row_of_[best_[i]];
  return regular && p == columns_ ? Status::ok : Status::degenerate_data;
}

}  // namespace pliant
