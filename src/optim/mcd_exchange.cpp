// Exchanges of single rows (after Hawkins' feasible solution algorithm, 1994). A subset at which C-steps stop is often not a
// minimum: a C-step ignores that the covariance changes with the rows. The determinant after one exchange follows exactly
// from the old factors, so finding the best pair of rows near the border of the subset is cheap.
#include "optim/mcd_search.hpp"

namespace pliant::mcd {

namespace {

constexpr std::size_t kBorder = kBlock / 2;  // rows tried on each side

/// The rows of `from` with the `count` largest or smallest keys, by repeated selection into a sorted list.
struct Border {
  std::uint16_t row[kBorder];
  float key[kBorder];
  std::size_t count = 0;

  void offer(std::uint16_t candidate, float value) {  // keeps the smallest keys
    if (count == kBorder && !(value < key[count - 1])) return;
    std::size_t place = count < kBorder ? count++ : count - 1;
    for (; place > 0 && value < key[place - 1]; --place) {
      row[place] = row[place - 1];
      key[place] = key[place - 1];
    }
    row[place] = candidate;
    key[place] = value;
  }
};

void whiten(const Cloud& cloud, const Shape<double>& shape, std::uint16_t row, double* out) {
  double c[kMcdMaxColumns];
  const double* w = shape.whitener;
  for (std::size_t k = 0; k < cloud.columns; ++k) {
    c[k] = static_cast<double>(cloud.z[k * cloud.stride + row]) - shape.mean[k];
    out[k] = 0;
    for (std::size_t j = 0; j <= k; ++j) out[k] += *w++ * c[j];
  }
}

double dot(const double* a, const double* b, std::size_t p) {
  double sum = 0;
  for (std::size_t k = 0; k < p; ++k) sum += a[k] * b[k];
  return sum;
}

/// Determinant after the exchange over that before, from products of the rows' whitened offsets u (leaves)
/// and v (comes): with scatter A = (h-1) S, A' = A - h/(h-1) u u^T + (h-1)/h w w^T, w = v + u/(h-1).
double determinant_ratio(double uu, double uv, double vv, double h) {
  const double g = 1 / (h - 1);
  const double uw = (uv + g * uu) * g, ww = (vv + 2 * g * uv + g * g * uu) * g;
  return (1 - h * g * uu * g) * (1 + ww / (h * g)) + uw * uw;
}

struct Pair {
  std::size_t leaves, comes;
  double ratio;
};

// This function and the loops of FAST-MCD are not inlined, so that their arrays are not on the stack at the same time.
[[gnu::noinline]] Pair best_pair(const Cloud& cloud, const Shape<double>& shape, const Border& inside,
                                 const Border& outside, double h, double* room) {
  const std::size_t p = cloud.columns;
  double* const u = room;
  double* const v = room + kBorder * p;
  for (std::size_t j = 0; j < inside.count; ++j) whiten(cloud, shape, inside.row[j], u + j * p);
  for (std::size_t i = 0; i < outside.count; ++i) whiten(cloud, shape, outside.row[i], v + i * p);
  Pair best{0, 0, 1 - kTuning.least_gain};
  for (std::size_t j = 0; j < inside.count; ++j) {
    const double* uj = u + j * p;
    const double uu = dot(uj, uj, p);
    for (std::size_t i = 0; i < outside.count; ++i) {
      const double* vi = v + i * p;
      const double ratio = determinant_ratio(uu, dot(uj, vi, p), dot(vi, vi, p), h);
      if (ratio < best.ratio) best = {inside.row[j], outside.row[i], ratio};
    }
  }
  return best;
}

}  // namespace

void Search::exchange(std::size_t rounds) {
  for (std::size_t round = 0; round < rounds && subset_size < cloud.rows; ++round) {
    Shape<double> shape = scratch.shape(cloud.columns);
    fit_shape(cloud, best, subset_size, scratch, shape);
    squared_distances(cloud, shape, scratch.block_double, scratch.distance);
    Border inside, outside;
    for (std::size_t i = 0, next = 0; i < cloud.rows; ++i) {
      const bool is_inside = next < subset_size && best[next] == i;
      next += is_inside ? 1u : 0u;
      const float d = scratch.distance[i];
      if (is_inside)
        inside.offer(static_cast<std::uint16_t>(i), -d);
      else
        outside.offer(static_cast<std::uint16_t>(i), d);
    }
    const Pair pair =
        best_pair(cloud, shape, inside, outside, static_cast<double>(subset_size), scratch.block_double);
    if (!(pair.ratio < 1 - kTuning.least_gain)) return;
    std::size_t place = 0;
    while (best[place] != pair.leaves) ++place;
    const auto comes = static_cast<std::uint16_t>(pair.comes);
    for (; place + 1 < subset_size && best[place + 1] < comes; ++place) best[place] = best[place + 1];
    for (; place > 0 && best[place - 1] > comes; --place) best[place] = best[place - 1];
    best[place] = comes;
    fit_shape(cloud, best, subset_size, scratch, shape);
    best_determinant = shape.determinant;
    seen_count = 0;
    converge(shape);
  }
}

}  // namespace pliant::mcd
