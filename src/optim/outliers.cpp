// Minimum covariance determinant: the steps before the search (finite rows, columns in units of their own spread) and after
// it (corrections, reweighting, distances); docs/algorithms.md, sections 6.1, 6.4 and 6.6.
//
// Columns are scaled by their median absolute deviations. The estimate is affine equivariant, so this changes nothing in
// exact arithmetic; in floats it allows one pivot floor for all data. A column whose h central values are equal spans no
// volume. It is left out, with every row that differs there; the factorisation would fail on it.
#include "pliant/outliers.hpp"

#include "optim/mcd_state.hpp"
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

void Mcd::State::lay_out(Arena& arena, const McdLimits& limits) {
  row_capacity = limits.rows < kMcdMaxRows ? limits.rows : kMcdMaxRows;
  column_capacity = limits.columns < kMcdMaxColumns ? limits.columns : kMcdMaxColumns;
  stride = round_up(row_capacity) + mcd::kRowPadding;  // groups of rows may read past their end
  const std::size_t p = column_capacity;
  z = arena.take<float>(stride * p);
  other = arena.take<float>(stride * p);
  scratch.distance = arena.take<float>(stride);
  row_of = arena.take<std::uint16_t>(stride);
  scratch.subset = arena.take<std::uint16_t>(stride);
  order = arena.take<std::uint16_t>(stride);
  scratch.key = arena.take<std::uint32_t>(stride);
  scratch.block_float = arena.take<float>(mcd::kBlock * p);
  scratch.block_double = arena.take<double>(mcd::kBlock * p);
  matrices = arena.take<double>(2 * p * p);
  scratch.moments_room = arena.take<double>(p + packed_size(p));
  scratch.factor_room = arena.take<double>(packed_size(p));
  scratch.shape_room = arena.take<double>(p + packed_size(p));
  scratch.float_shape_room = arena.take<float>(p + packed_size(p));
  seen = arena.take<ScaledNumber>(mcd::kRemembered);
  candidate_pool = arena.take<float>(mcd::kCandidates * (p + packed_size(p)));
  scratch.histogram = arena.take<std::uint16_t>(mcd::kHistogram);
}

void Mcd::lay_out(Arena& arena, const McdLimits& limits) {
  PLIANT_ASSERT(limits.rows <= kMcdMaxRows && limits.columns <= kMcdMaxColumns);
  state_ = arena.take<State>(1);
  State state;
  state.lay_out(arena, limits);
  if (state_ != nullptr) *state_ = state;
  distance_ = arena.take<float>(state.stride);
  raw_distance_ = arena.take<float>(state.stride);
  best_ = arena.take<std::uint16_t>(state.stride);
  estimates_ = arena.take<McdEstimate>(2);
  rows_ = columns_ = best_count_ = 0;
  if (arena.is_measuring() || arena.exhausted()) return;
  estimates_[0] = estimates_[1] = {};
  for (std::size_t i = 0; i < mcd::kHistogram; ++i) state.scratch.histogram[i] = 0;
}

Status Mcd::prepare(const float* data, std::size_t rows, std::size_t columns, const McdOptions& options) {
  if (data == nullptr || columns == 0 || !is_valid(options)) return Status::bad_argument;
  if (state_ == nullptr || rows > state_->row_capacity || columns > state_->column_capacity)
    return Status::capacity;
  rows_ = rows;
  columns_ = columns;
  full_steps_ = best_count_ = 0;
  determinant_ = {};
  raw_correction_ = reweighted_correction_ = 1;
  estimates_[0] = estimates_[1] = {};
  state_->finite_rows = 0;
  for (std::size_t i = 0; i < rows; ++i) {
    bool finite = true;
    for (std::size_t j = 0; j < columns; ++j) finite = finite && is_finite(data[i * columns + j]);
    state_->row_of[state_->finite_rows] = static_cast<std::uint16_t>(i);
    state_->finite_rows += finite ? 1u : 0u;
    distance_[i] = raw_distance_[i] = finite ? 0.0f : kMcdOffSubspace;
  }
  state_->used_rows = state_->finite_rows;
  cutoff_ = chi_square_quantile(columns, static_cast<double>(options.cutoff));
  if (state_->finite_rows <= columns + 1) {
    answer_too_few(data);
    return Status::too_few_points;
  }
  state_->subset_size = mcd_subset_size(state_->finite_rows, columns, static_cast<double>(options.alpha));
  state_->active_columns = columns;
  for (std::size_t j = 0; j < columns; ++j) state_->active[j] = 1;
  for (std::size_t pass = 0; pass <= columns && !standardise(data); ++pass) {
  }
  return Status::ok;
}

void Mcd::answer_too_few(const float* data) {
  for (std::size_t j = 0; j < columns_ && state_->used_rows > 0; ++j) {
    for (std::size_t i = 0; i < state_->used_rows; ++i)
      state_->scratch.distance[i] = data[state_->row_of[i] * columns_ + j];
    estimates_[0].center[j] = static_cast<double>(mcd::kth_smallest(
        state_->scratch.distance, state_->used_rows, (state_->used_rows + 1) / 2, state_->scratch));
  }
  estimates_[1] = estimates_[0];
}

/// \return false when a column turned out to be constant. It is then inactive and the rows are fewer, so all columns have
/// to be standardised again.
bool Mcd::standardise(const float* data) {
  state_->active_columns = 0;
  for (std::size_t j = 0; j < columns_; ++j)
    if (state_->active[j] != 0) {
      if (!standardise_column(data, j)) return false;
      ++state_->active_columns;
    }
  return true;
}

bool Mcd::standardise_column(const float* data, std::size_t column) {
  const std::size_t n = state_->used_rows, middle = (n + 1) / 2;
  for (std::size_t i = 0; i < n; ++i)
    state_->scratch.distance[i] = data[state_->row_of[i] * columns_ + column];
  const float center = mcd::kth_smallest(state_->scratch.distance, n, middle, state_->scratch);
  const double median = static_cast<double>(center);
  for (std::size_t i = 0; i < n; ++i) {
    const double from_median = static_cast<double>(state_->scratch.distance[i]) - median;
    state_->scratch.distance[i] = narrow(from_median < 0 ? -from_median : from_median);
  }
  float deviation = mcd::kth_smallest(state_->scratch.distance, n, middle, state_->scratch);
  if (deviation == 0.0f)
    deviation = mcd::kth_smallest(state_->scratch.distance, n, state_->subset_size, state_->scratch);
  state_->median[column] = median;
  if (deviation == 0.0f) {
    state_->active[column] = 0;
    keep_rows_at(data, column, center);
    return false;
  }
  const double scale = mcd::kMadToDeviation * static_cast<double>(deviation);
  state_->scale[column] = scale;
  float* z = state_->z + state_->active_columns * state_->stride;
  for (std::size_t i = 0; i < n; ++i) {
    const double value = (static_cast<double>(data[state_->row_of[i] * columns_ + column]) - median) / scale;
    z[i] = static_cast<float>(value > kFarthest ? kFarthest : (value < -kFarthest ? -kFarthest : value));
  }
  for (std::size_t i = n; i < state_->stride; ++i) z[i] = 0;
  return true;
}

void Mcd::keep_rows_at(const float* data, std::size_t column, float value) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < state_->used_rows; ++i) {
    const std::uint16_t row = state_->row_of[i];
    const bool same = data[row * columns_ + column] == value;
    if (!same) distance_[row] = raw_distance_[row] = kMcdOffSubspace;
    state_->row_of[kept] = row;
    kept += same ? 1u : 0u;
  }
  state_->used_rows = kept;
}

/// Mean and `correction` times covariance of the rows listed, the squared distances of all rows in that
/// metric, and the determinant of the plain covariance. True where it is regular.
bool Mcd::estimate_from(const std::uint16_t* row, std::size_t count, double correction, float* distance,
                        McdEstimate& estimate, ScaledNumber& determinant) {
  const mcd::Cloud cloud = state_->cloud();
  double shift[kMcdMaxColumns];
  for (std::size_t j = 0; j < state_->active_columns; ++j)
    shift[j] = static_cast<double>(state_->z[j * state_->stride + row[0]]);
  const mcd::Scratch room = state_->scratch;
  const mcd::Moments moments = room.moments(state_->active_columns);
  mcd::moments(cloud, row, count, shift, state_->scratch.block_double, moments);
  mcd::Shape<double> shape = room.shape(state_->active_columns);
  mcd::make_shape(moments, state_->active_columns, room, shape);
  mcd::squared_distances(cloud, shape, state_->scratch.block_double, state_->scratch.distance);
  const float inverse = static_cast<float>(1 / correction);
  for (std::size_t i = 0; i < state_->used_rows; ++i)
    distance[state_->row_of[i]] = state_->scratch.distance[i] * inverse;
  determinant = shape.determinant;
  std::size_t a = 0;
  for (std::size_t j = 0; j < columns_; ++j) {
    estimate.center[j] = state_->median[j];
    if (state_->active[j] == 0) continue;
    estimate.center[j] += state_->scale[j] * moments.mean[a];
    std::size_t b = 0;
    for (std::size_t k = 0; k <= j; ++k) {
      if (state_->active[k] == 0) continue;
      const double value =
          correction * state_->scale[j] * state_->scale[k] * moments.covariance[packed(a, b++)];
      estimate.covariance[j * columns_ + k] = estimate.covariance[k * columns_ + j] = value;
    }
    determinant = mcd::times(determinant, state_->scale[j] * state_->scale[j]);
    ++a;
  }
  return !shape.singular;
}

Status Mcd::finish(const McdOptions& options) {
  const std::size_t p = state_->active_columns, n = state_->finite_rows;
  const double alpha = static_cast<double>(options.alpha);
  if (p == 0) {  // all good rows are one point
    best_count_ = state_->subset_size;
    for (std::size_t i = 0; i < best_count_; ++i) best_[i] = state_->row_of[i];
    for (std::size_t j = 0; j < columns_; ++j)
      estimates_[0].center[j] = estimates_[1].center[j] = state_->median[j];
    return Status::degenerate_data;
  }
  cutoff_ = chi_square_quantile(p, static_cast<double>(options.cutoff));
  const double fraction = static_cast<double>(state_->subset_size) / static_cast<double>(n);
  raw_correction_ = mcd_consistency_factor(p, fraction) * mcd_small_sample_raw(n, p, alpha);
  const bool regular =
      estimate_from(best_, state_->subset_size, raw_correction_, raw_distance_, estimates_[0], determinant_);
  std::size_t good = 0;
  for (std::size_t i = 0; i < state_->used_rows; ++i) {
    state_->scratch.subset[good] = static_cast<std::uint16_t>(i);
    good += is_flagged_raw(state_->row_of[i]) ? 0u : 1u;
  }
  if (good <= p) {  // the corrections of tiny samples can flag nearly all rows; reweight from the subset then
    for (good = 0; good < state_->subset_size; ++good) state_->scratch.subset[good] = best_[good];
  }
  reweighted_correction_ = mcd_consistency_factor(p, static_cast<double>(good) / static_cast<double>(n)) *
                           mcd_small_sample_reweighted(n, p, alpha);
  ScaledNumber unused;
  estimate_from(state_->scratch.subset, good, reweighted_correction_, distance_, estimates_[1], unused);
  best_count_ = state_->subset_size;
  for (std::size_t i = 0; i < best_count_; ++i) best_[i] = state_->row_of[best_[i]];
  return regular && p == columns_ ? Status::ok : Status::degenerate_data;
}

}  // namespace pliant
