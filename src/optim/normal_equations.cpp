// Packed normal equations (docs/algorithms.md, sections 5.3 to 5.5): accumulation, scaled Cholesky within limits, variances.
#include "pliant/normal_equations.hpp"

#include "base/lanes.hpp"
#include "base/wide_vectors.hpp"
#include "optim/normal_equations_tuning.hpp"

namespace pliant {

namespace {

constexpr NormalEquationsTuning kTuning = kNormalEquationsTuning;
constexpr std::size_t kGatheredRows = kTuning.gathered_rows, kTileRows = kTuning.tile_rows,
                      kTileColumns = kTuning.tile_columns, kPanel = kTuning.panel;
constexpr std::size_t kWideLanes = 8;  // floats of the widest vector that add_spread is compiled for
constexpr std::size_t kBeyond =
    kHasVectors ? kWideLanes : 0;  // where vectors of H's last row end; they add zeros

/// Columns of one observation, and what they meet.
struct SparseRows {
  const std::uint16_t* unknown;
  const Vec2* column;
  std::size_t count;
  Vec2 force;
  Sym2 w;
};

/// g += B^T W r and, in H, h_(k, j) += (B^T W B)_(k, j) for each column k of B and all j >= k. B is spread over n columns with
/// zeros, in x and y, which are zero before and afterwards. Up to the last column, rounded up to whole vectors: beyond a row's
/// end, zeros are added to the next row.
PLIANT_WIDE_VECTORS
void add_spread(float* __restrict h, float* __restrict g, std::size_t n, const SparseRows& b,
                float* __restrict x, float* __restrict y) {
  const Sym2 w = b.w;
  for (std::size_t i = 0; i < b.count; ++i) {
    x[b.unknown[i]] = b.column[i].x;
    y[b.unknown[i]] = b.column[i].y;
  }
  const std::size_t end = b.count > 0 ? b.unknown[b.count - 1] + kWideLanes : 0;
  for (std::size_t i = 0; i < b.count; ++i) {
    const std::size_t k = b.unknown[i], whole = (end - k) / kWideLanes * kWideLanes;
    PLIANT_ASSERT(i + 1 == b.count || k < b.unknown[i + 1]);
    const Vec2 c = b.column[i];
    g[k] += b.force.x * c.x + b.force.y * c.y;
    const float wx = w.xx * c.x + w.xy * c.y, wy = w.xy * c.x + w.yy * c.y;
    float* __restrict const row = h + k * (2 * n + 1 - k) / 2;
    const float *const along_x = x + k, *const along_y = y + k;
    for (std::size_t j = 0; j < whole; ++j) row[j] += wx * along_x[j] + wy * along_y[j];
  }
  for (std::size_t i = 0; i < b.count; ++i) x[b.unknown[i]] = y[b.unknown[i]] = 0;
}

/// y -= f x over [0, n).
void subtract_scaled(float* y, float f, const float* x, std::size_t n) {
  std::size_t j = 0;
  for (; j + kLanes <= n; j += kLanes) store(load(y + j) - splat(f) * load(x + j), y + j);
  for (; j < n; ++j) y[j] -= f * x[j];
}

/// Subtracts from the packed triangle y of n rows, in order, what four rows x of the factor eliminate. Same bits as one after the
/// other, with a quarter of the loads and stores.
PLIANT_WIDE_VECTORS
void subtract_panel(float* __restrict y, const float* const (&x)[kPanel], std::size_t n) {
  const float* __restrict x0 = x[0], * __restrict x1 = x[1], * __restrict x2 = x[2], * __restrict x3 = x[3];
  for (; n > 0; --n, ++x0, ++x1, ++x2, ++x3) {
    const float f0 = *x0, f1 = *x1, f2 = *x2, f3 = *x3;
    for (std::size_t j = 0; j < n; ++j) {
      float v = y[j];
      v -= f0 * x0[j];
      v -= f1 * x1[j];
      v -= f2 * x2[j];
      v -= f3 * x3[j];
      y[j] = v;
    }
    y += n;
  }
}

float dot_product(const float* a, const float* b, std::size_t n) {
  Lanes first = splat(0), second = splat(0);
  std::size_t j = 0;
  for (; j + 2 * kLanes <= n; j += 2 * kLanes) {
    first += load(a + j) * load(b + j);
    second += load(a + j + kLanes) * load(b + j + kLanes);
  }
  float total = sum(first + second);
  for (; j < n; ++j) total += a[j] * b[j];
  return total;
}

}  // namespace

void NormalEquations::lay_out(Arena& arena, std::size_t unknowns) {
  const std::size_t packed = unknowns * (unknowns + 1) / 2;
  h_ = arena.take<float>(packed + kBeyond);
  factor_ = arena.take<float>(packed);
  stride_ = unknowns + kTileColumns;  // a tile may end beyond the last unknown, where the rows are zero
  rows_ = arena.take<float>(kGatheredRows * stride_);
  row_residual_ = arena.take<float>(kGatheredRows);
  if (kHasVectors) {
    spread_x_ = arena.take<float>(stride_);
    spread_y_ = arena.take<float>(stride_);
  }
  float** const vectors[] = {&g_, &scale_, &lower_, &upper_, &right_, &solution_, &compact_};
  for (float** vector : vectors) *vector = arena.take<float>(unknowns);
  pinned_ = arena.take<Pin>(unknowns);
  free_ = arena.take<std::uint16_t>(unknowns);
  capacity_ = unknowns;
  count_ = gathered_ = 0;
}

void NormalEquations::reset(std::size_t count) {
  PLIANT_ASSERT(count <= capacity_);
  count_ = count;
  gathered_ = 0;
  for (std::size_t j = 0; kHasVectors && j < count + kBeyond; ++j) spread_x_[j] = spread_y_[j] = 0;
  for (std::size_t i = 0; i < count * (count + 1) / 2; ++i) h_[i] = 0;
  for (std::size_t i = 0; i < count; ++i) {
    g_[i] = 0;
    lower_[i] = -1e30f;
    upper_[i] = 1e30f;
  }
}

void NormalEquations::add(const std::uint16_t* unknown, const Vec2* column, std::size_t columns,
                          Vec2 residual, Sym2 w) {
  if (gradient_only_ || kTuning.dense_denominator * columns < kTuning.dense_numerator * count_) {
    add_sparse(unknown, column, columns, residual, w);
    return;
  }
  // W = L L^T with L = [a 0; b c]; the rows of L^T B.
  const float a = square_root(w.xx), b = a > 0 ? w.xy / a : 0.0f, c = square_root(w.yy - b * b);
  float* first = gathered_row(a * residual.x + b * residual.y);
  float* second = gathered_row(c * residual.y);
  if (columns != count_)
    for (std::size_t j = 0; j < count_; ++j) first[j] = second[j] = 0;
  for (std::size_t j = 0; j < columns; ++j) {
    first[unknown[j]] = a * column[j].x + b * column[j].y;
    second[unknown[j]] = c * column[j].y;
  }
  if (gathered_ == kGatheredRows) flush();
}

void NormalEquations::add_dense(const float* along_x, const float* along_y, Vec2 residual, Sym2 w) {
  if (gradient_only_) {
    for (std::size_t j = 0; j < count_; ++j) {
      const float wx = w.xx * along_x[j] + w.xy * along_y[j], wy = w.xy * along_x[j] + w.yy * along_y[j];
      g_[j] += wx * residual.x + wy * residual.y;
      h_[index(j, j)] += wx * along_x[j] + wy * along_y[j];
    }
    return;
  }
  const float a = square_root(w.xx), b = a > 0 ? w.xy / a : 0.0f, c = square_root(w.yy - b * b);
  float* first = gathered_row(a * residual.x + b * residual.y);
  float* second = gathered_row(c * residual.y);
  for (std::size_t j = 0; j < count_; ++j) {
    first[j] = a * along_x[j] + b * along_y[j];
    second[j] = c * along_y[j];
  }
  if (gathered_ == kGatheredRows) flush();
}

/// The next gathered row, zero beyond the unknowns.
float* NormalEquations::gathered_row(float residual) {
  float* row = rows_ + gathered_ * stride_;
  row_residual_[gathered_] = residual;
  ++gathered_;
  for (std::size_t j = count_; j < count_ + kTileColumns; ++j) row[j] = 0;
  return row;
}

/// With vectors, the columns are first written into two full rows, which are zero between calls, so that each row of H is
/// updated by whole vectors. Without, only the elements of these columns are: H is the same, because the others are zeros.
void NormalEquations::add_sparse(const std::uint16_t* unknown, const Vec2* column, std::size_t columns,
                                 Vec2 residual, Sym2 w) {
  const Vec2 force{w.xx * residual.x + w.xy * residual.y, w.xy * residual.x + w.yy * residual.y};
  if (kHasVectors && !gradient_only_) {
    add_spread(h_, g_, count_, {unknown, column, columns, force, w}, spread_x_, spread_y_);
    return;
  }
  for (std::size_t i = 0; i < columns; ++i) g_[unknown[i]] += force.x * column[i].x + force.y * column[i].y;
  if (gradient_only_) {
    for (std::size_t i = 0; i < columns; ++i) {
      const Vec2 b = column[i];
      h_[index(unknown[i], unknown[i])] += b.x * (w.xx * b.x + w.xy * b.y) + b.y * (w.xy * b.x + w.yy * b.y);
    }
    return;
  }
  for (const Vec2* const end = column + columns; column != end; ++column, ++unknown) {
    const float wx = w.xx * column->x + w.xy * column->y, wy = w.xy * column->x + w.yy * column->y;
    float* const row = h_ + index(*unknown, 0);
    const std::uint16_t* at = unknown;
    const Vec2* other = column;
    do {
      PLIANT_ASSERT(other == column || at[-1] < at[0]);
      row[*at++] += wx * other->x + wy * other->y;
    } while (++other != end);
  }
}

/// Adds the gathered rows to H and g.
void NormalEquations::flush() {
  for (std::size_t r = 0; r < gathered_; ++r)
    subtract_scaled(g_, -row_residual_[r], rows_ + r * stride_, count_);
  if (gathered_ > 0)
    for (std::size_t i = 0; i < count_; i += kTileRows)
      for (std::size_t j = i; j < count_; j += kTileColumns) add_tile(i, j);
  gathered_ = 0;
}

/// Adds the gathered rows to a tile of H. The sums stay in registers.
void NormalEquations::add_tile(std::size_t row, std::size_t column) {
  Lanes left[kTileRows] = {}, right[kTileRows] = {};
  const float *a = rows_ + row, *b = rows_ + column;
  for (std::size_t r = 0; r < gathered_; ++r, a += stride_, b += stride_) {
    const Lanes b0 = load(b), b1 = load(b + kLanes);
    for (std::size_t i = 0; i < kTileRows; ++i) {
      const Lanes f = splat(a[i]);
      left[i] += f * b0;
      right[i] += f * b1;
    }
  }
  for (std::size_t i = 0; i < kTileRows && row + i < count_; ++i) {
    float* target = h_ + index(row + i, 0);
    if (row + i <= column && column + kTileColumns <= count_) {
      store(load(target + column) + left[i], target + column);
      store(load(target + column + kLanes) + right[i], target + column + kLanes);
      continue;
    }
    float part[kTileColumns];
    store(left[i], part);
    store(right[i], part + kLanes);
    for (std::size_t j = 0; j < kTileColumns; ++j)
      if (column + j >= row + i && column + j < count_) target[column + j] += part[j];
  }
}

void NormalEquations::add_prior(std::size_t unknown, float residual, float weight) {
  h_[index(unknown, unknown)] += weight;
  g_[unknown] += weight * residual;
}

void NormalEquations::set_limits(std::size_t unknown, float lower, float upper) {
  lower_[unknown] = lower;
  upper_[unknown] = upper;
}

/// Calls f(i, H(k, i)) for all i. The elements before the diagonal lie in the rows above, each a shorter step on.
template <class F>
void NormalEquations::for_row(std::size_t k, F f) const {
  const float* element = h_ + k;
  for (std::size_t i = 0; i < count_; ++i) {
    f(i, *element);
    element += i < k ? count_ - i - 1 : 1;
  }
}

/// Copies S H S + damping I, restricted to the free unknowns, into `factor_` (upper triangle, packed). An unknown is free
/// if it is observed and not at a limit. What was undetermined beside another unknown may be determined now that this one is at its
/// limit.
void NormalEquations::copy_scaled(float damping) {
  free_count_ = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    if (pinned_[i] == Pin::at_limit || !(h_[index(i, i)] > 0)) continue;
    pinned_[i] = Pin::none;
    free_[free_count_++] = static_cast<std::uint16_t>(i);
  }
  float* to = factor_;
  for (std::size_t k = 0; k < free_count_; ++k, to += free_count_ - k + 1) {
    const std::size_t i = free_[k];
    const float* from = h_ + index(i, 0);
    const float s = scale_[i];
    for (std::size_t l = k; l < free_count_; ++l) to[l - k] = from[free_[l]] * s * scale_[free_[l]];
    to[0] += damping;
  }
}

/// Row i of the factor. Columns below i are not stored: the pointer is to where column 0 would be.
float* NormalEquations::factor_row(std::size_t i) {
  return factor_ + (i * free_count_ - i * (i + 1) / 2);
}

/// Marks an unknown that the observations do not determine, given the unknowns before it.
void NormalEquations::pin_undetermined(std::size_t k) {
  float* row = factor_row(k);
  pinned_[free_[k]] = Pin::undetermined;
  row[k] = 1;
  for (std::size_t j = k + 1; j < free_count_; ++j) row[j] = 0;
}

/// U^T U = S H S + damping I in outer-product form, four pivots at a time: the inner loops run along packed rows.
void NormalEquations::factorise(float damping) {
  ++factorisations_;
  copy_scaled(damping);
  const std::size_t n = free_count_;
  for (std::size_t first = 0; first < n; first += kPanel) {
    const std::size_t end = first + kPanel < n ? first + kPanel : n;
    for (std::size_t k = first; k < end; ++k) {
      float* row = factor_row(k);
      for (std::size_t above = first; above < k; ++above) {
        const float* pivot_row = factor_row(above);
        subtract_scaled(row + k, pivot_row[k], pivot_row + k, n - k);
      }
      if (row[k] < kTuning.least_pivot) {
        pin_undetermined(k);
        continue;
      }
      const float pivot = square_root(row[k]), inverse = 1.0f / pivot;
      row[k] = pivot;
      for (std::size_t j = k + 1; j < n; ++j) row[j] *= inverse;
    }
    if (end == n) return;
    const float* const panel[kPanel] = {factor_row(first) + end, factor_row(first + 1) + end,
                                        factor_row(first + 2) + end, factor_row(first + 3) + end};
    subtract_panel(factor_row(end) + end, panel, n - end);
  }
}

/// Solves U^T U x = right for the free unknowns. All others get zero.
void NormalEquations::back_substitute(const float* right, float* x) {
  const std::size_t n = free_count_;
  float* y = compact_;
  for (std::size_t k = 0; k < n; ++k) y[k] = right[free_[k]];
  for (std::size_t k = 0; k < n; ++k) {
    const float* row = factor_row(k);
    y[k] = pinned_[free_[k]] == Pin::undetermined ? 0.0f : y[k] / row[k];
    subtract_scaled(y + k + 1, y[k], row + k + 1, n - k - 1);
  }
  for (std::size_t k = n; k-- > 0;) {
    const float* row = factor_row(k);
    const float rest = y[k] - dot_product(row + k + 1, y + k + 1, n - k - 1);
    y[k] = pinned_[free_[k]] == Pin::undetermined ? 0.0f : rest / row[k];
  }
  for (std::size_t i = 0; i < count_; ++i) x[i] = 0;
  for (std::size_t k = 0; k < n; ++k) x[free_[k]] = y[k];
}

/// Computes the scales that give H a unit diagonal. An unknown with a zero diagonal is undetermined.
void NormalEquations::start_scaled() {
  flush();
  for (std::size_t i = 0; i < count_; ++i) {
    const float d = h_[index(i, i)];
    scale_[i] = d > 0 ? 1.0f / square_root(d) : 1.0f;
    pinned_[i] = d > 0 ? Pin::none : Pin::undetermined;
  }
}

/// Pins unknowns at a limit whose force points outwards. Most of them stay there, and a factorisation is saved.
void NormalEquations::pin_pushed_out() {
  for (std::size_t i = 0; i < count_; ++i) {
    const bool is_pushed_out = (g_[i] > 0 && upper_[i] == 0) || (g_[i] < 0 && lower_[i] == 0);
    if (pinned_[i] == Pin::none && is_pushed_out) pinned_[i] = Pin::at_limit;
  }
}

/// Sets unknowns that leave their limits to the limit. \return whether there were any.
bool NormalEquations::pin_to_limits(float* step) {
  bool changed = false;
  for (std::size_t i = 0; i < count_; ++i) {
    if (pinned_[i] == Pin::at_limit) continue;
    step[i] = pinned_[i] == Pin::undetermined ? 0.0f : solution_[i] * scale_[i];
    if (step[i] >= lower_[i] && step[i] <= upper_[i]) continue;
    step[i] = clamped(i, step[i]);
    pinned_[i] = Pin::at_limit;
    changed = true;
  }
  return changed;
}

/// Frees unknowns at a limit whose force points inside, now that others are at their limits. \return whether there were any.
bool NormalEquations::release_from_limits(float damping, const float* step) {
  float largest = 0;
  for (std::size_t i = 0; i < count_; ++i) largest = max(largest, magnitude(g_[i]) * scale_[i]);
  bool changed = false;
  for (std::size_t k = 0; k < count_; ++k) {
    if (pinned_[k] != Pin::at_limit || !(lower_[k] < upper_[k])) continue;
    float force = g_[k] - damping * h_[index(k, k)] * step[k];
    for_row(k, [&](std::size_t i, float element) { force -= element * step[i]; });
    const float inside = step[k] >= upper_[k] ? -force : force;
    if (inside * scale_[k] <= kTuning.releasing_force * largest) continue;
    pinned_[k] = Pin::none;
    changed = true;
  }
  return changed;
}

void NormalEquations::solve(float damping, float* step) {
  const std::size_t n = count_;
  start_scaled();
  for (std::size_t i = 0; i < n; ++i) step[i] = 0;
  pin_pushed_out();
  for (int round = 0; round < kTuning.limit_rounds; ++round) {
    for (std::size_t i = 0; i < n; ++i) right_[i] = g_[i];
    for (std::size_t k = 0; k < n; ++k)  // the columns of pinned unknowns move to the right-hand side
      if (pinned_[k] == Pin::at_limit && step[k] != 0)
        for_row(k, [&](std::size_t i, float element) { right_[i] -= element * step[k]; });
    for (std::size_t i = 0; i < n; ++i) right_[i] *= scale_[i];
    factorise(damping);
    back_substitute(right_, solution_);
    if (!pin_to_limits(step) && !release_from_limits(damping, step)) break;
  }
  undetermined_ = 0;
  for (std::size_t i = 0; i < n; ++i) undetermined_ += pinned_[i] == Pin::undetermined;
}

void NormalEquations::variances(float* variance) {
  start_scaled();
  factorise(0);
  undetermined_ = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    undetermined_ += pinned_[i] == Pin::undetermined;
    variance[i] = 0;
  }
  const std::size_t n = free_count_;
  for (std::size_t k = 0; k < n; ++k) {
    if (pinned_[free_[k]] == Pin::undetermined) continue;
    // |U^-T e_k|^2, by forward substitution from k on.
    for (std::size_t j = k; j < n; ++j) compact_[j] = 0;
    compact_[k] = 1;
    float total = 0;
    for (std::size_t i = k; i < n; ++i) {
      const float* row = factor_row(i);
      const float y = pinned_[free_[i]] == Pin::undetermined ? 0.0f : compact_[i] / row[i];
      total += y * y;
      subtract_scaled(compact_ + i + 1, y, row + i + 1, n - i - 1);
    }
    variance[free_[k]] = total * scale_[free_[k]] * scale_[free_[k]];
  }
}

float NormalEquations::predicted_decrease(const float* step) {
  float decrease = 0;
  for (std::size_t k = 0; k < count_; ++k) decrease += 0.5f * g(k) * step[k];
  return decrease;
}

}  // namespace pliant
