// Distances and moments in lanes (docs/algorithms.md, section 6.1), four 16-byte vectors at a time. GCC and Clang translate
// vector types to what the target has, down to scalars, with the same results.
#include "optim/mcd_kernel.hpp"

#include <cstring>

namespace pliant::mcd {

namespace {

template <class Real>
struct VectorOf;
template <>
struct VectorOf<float> {
  typedef float Type __attribute__((vector_size(16)));
};
template <>
struct VectorOf<double> {
  typedef double Type __attribute__((vector_size(16)));
};
template <class Real>
using Vector = typename VectorOf<Real>::Type;
template <class Real>
inline constexpr std::size_t kLanes = 16 / sizeof(Real);

template <class Real>
Vector<Real> load(const Real* at) {
  Vector<Real> v;
  std::memcpy(&v, at, sizeof v);
  return v;
}

void store(Vector<float> v, float* at) {
  std::memcpy(at, &v, sizeof v);
}
void store(Vector<double> v, double* at) {
  std::memcpy(at, &v, sizeof v);
}

Vector<float> load_as(const float* at, float) {
  return load(at);
}
Vector<double> load_as(const float* at, double) {
  return Vector<double>{static_cast<double>(at[0]), static_cast<double>(at[1])};
}

void store_as_float(Vector<float> v, float* at) {
  store(v, at);
}
void store_as_float(Vector<double> v, float* at) {
  at[0] = static_cast<float>(v[0]);
  at[1] = static_cast<float>(v[1]);
}

float sum_of(Vector<float> v) {
  return (v[0] + v[1]) + (v[2] + v[3]);
}
double sum_of(Vector<double> v) {
  return v[0] + v[1];
}

constexpr double kSmallestPivot = 1e-14;  // of standardised data: their resolution, squared
constexpr double kFar = 1e30;

}  // namespace

ScaledNumber times(ScaledNumber a, double positive) {
  int e;
  a.mantissa = split_exponent(a.mantissa * positive, e);
  a.exponent += e;
  return a;
}

bool is_less(ScaledNumber a, ScaledNumber b) {
  return a.exponent != b.exponent ? a.exponent < b.exponent : a.mantissa < b.mantissa;
}

bool is_close(ScaledNumber a, ScaledNumber b, double tolerance) {
  const int difference = a.exponent - b.exponent;
  if (difference < -1 || difference > 1) return false;
  const double ratio = a.mantissa / b.mantissa * (difference > 0 ? 2.0 : (difference < 0 ? 0.5 : 1.0)) - 1;
  return ratio <= tolerance && -ratio <= tolerance;
}

template <class Real>
void squared_distances(const Cloud& cloud, const Shape<Real>& shape, Real* block, float* out) {
  constexpr std::size_t kVectors = 4, kStep = kVectors * kLanes<Real>;
  static_assert(kStep <= kBlock);
  const std::size_t p = cloud.columns;
  for (std::size_t row = 0; row < cloud.rows; row += kStep) {
    Vector<Real> d[kVectors] = {};
    const Real* w = shape.whitener;
    for (std::size_t k = 0; k < p; ++k) {
      const float* column = cloud.z + k * cloud.stride + row;
      for (std::size_t v = 0; v < kVectors; ++v)
        store(load_as(column + v * kLanes<Real>, Real()) - shape.mean[k],
              block + k * kStep + v * kLanes<Real>);
      Vector<Real> a[kVectors] = {};
      for (std::size_t j = 0; j <= k; ++j)
        for (std::size_t v = 0; v < kVectors; ++v) a[v] += w[j] * load(block + j * kStep + v * kLanes<Real>);
      w += k + 1;
      for (std::size_t v = 0; v < kVectors; ++v) d[v] += a[v] * a[v];
    }
    for (std::size_t v = 0; v < kVectors; ++v) store_as_float(d[v], out + row + v * kLanes<Real>);
  }
  for (std::size_t row = 0; row < cloud.rows; ++row)
    if (!(out[row] <= static_cast<float>(kFar))) out[row] = static_cast<float>(kFar);
}

namespace {

/// out[t] += a . b_t for `Tile` rows of b, kBlock apart.
template <std::size_t Tile, class Real>
void add_dots(const Real* a, const Real* b, std::size_t count, double* out) {
  Vector<Real> sum[Tile] = {};
  for (std::size_t i = 0; i < count; i += kLanes<Real>) {
    const Vector<Real> x = load(a + i);
    for (std::size_t t = 0; t < Tile; ++t) sum[t] += x * load(b + t * kBlock + i);
  }
  for (std::size_t t = 0; t < Tile; ++t) out[t] += static_cast<double>(sum_of(sum[t]));
}

template <class Real>
void add_block(const Real* block, std::size_t count, std::size_t p, double* sum, double* product) {
  for (std::size_t j = 0; j < p; ++j) {
    const Real* a = block + j * kBlock;
    Vector<Real> total = {};
    for (std::size_t i = 0; i < count; i += kLanes<Real>) total += load(a + i);
    sum[j] += static_cast<double>(sum_of(total));
    double* out = product + packed(j, 0);
    std::size_t k = 0;
    for (; k + 4 <= j + 1; k += 4) add_dots<4>(a, block + k * kBlock, count, out + k);
    switch (j + 1 - k) {
      case 3:
        add_dots<3>(a, block + k * kBlock, count, out + k);
        break;
      case 2:
        add_dots<2>(a, block + k * kBlock, count, out + k);
        break;
      case 1:
        add_dots<1>(a, block + k * kBlock, count, out + k);
        break;
      default:
        break;
    }
  }
}

}  // namespace

template <class Real>
void moments(const Cloud& cloud, const std::uint16_t* row, std::size_t count, const Real* shift, Real* block,
             const Moments& out) {
  const std::size_t p = cloud.columns;
  for (std::size_t j = 0; j < p; ++j) out.mean[j] = 0;
  for (std::size_t k = 0; k < packed_size(p); ++k) out.covariance[k] = 0;
  for (std::size_t first = 0; first < count; first += kBlock) {
    const std::size_t size = count - first < kBlock ? count - first : kBlock;
    const std::size_t whole = (size + kLanes<Real> - 1) / kLanes<Real> * kLanes<Real>;
    for (std::size_t j = 0; j < p; ++j) {
      const float* column = cloud.z + j * cloud.stride;
      Real* to = block + j * kBlock;
      for (std::size_t i = 0; i < size; ++i) to[i] = static_cast<Real>(column[row[first + i]]) - shift[j];
      for (std::size_t i = size; i < whole; ++i) to[i] = 0;
    }
    add_block(block, whole, p, out.mean, out.covariance);
  }
  const double n = static_cast<double>(count), divisor = count > 1 ? 1 / (n - 1) : 0.0;
  for (std::size_t j = 0; j < p; ++j)
    for (std::size_t k = 0; k <= j; ++k) {
      double& value = out.covariance[packed(j, k)];
      value = (value - out.mean[j] * out.mean[k] / n) * divisor;
    }
  for (std::size_t j = 0; j < p; ++j) out.mean[j] = out.mean[j] / n + static_cast<double>(shift[j]);
}

namespace {

/// a = L, lower Cholesky factor of a, in place. False where a pivot had to be raised to its floor.
bool factorise(double* a, std::size_t p, double relative_floor, ScaledNumber& determinant) {
  bool is_regular = true;
  determinant = {};
  for (std::size_t j = 0; j < p; ++j) {
    double* row = a + packed(j, 0);
    const double floor = relative_floor * row[j] + kSmallestPivot;
    for (std::size_t k = 0; k < j; ++k) {
      const double* above = a + packed(k, 0);
      double s = row[k];
      for (std::size_t i = 0; i < k; ++i) s -= row[i] * above[i];
      row[k] = s / above[k];
    }
    double pivot = row[j];
    for (std::size_t i = 0; i < j; ++i) pivot -= row[i] * row[i];
    if (!(pivot > floor)) {
      pivot = floor;
      is_regular = false;
    }
    determinant = times(determinant, pivot);
    row[j] = square_root(pivot);
  }
  return is_regular;
}

}  // namespace

template <class Real>
void make_shape(const Moments& from, std::size_t p, const Scratch& scratch, Shape<Real>& shape) {
  double* const l = scratch.factor_room;
  for (std::size_t k = 0; k < packed_size(p); ++k) l[k] = from.covariance[k];
  shape.singular = !factorise(l, p, kPivotFloor<Real>, shape.determinant);
  for (std::size_t j = 0; j < p; ++j) {  // in place: row j of L^-1 needs rows of L^-1 above and row j of L
    double* row = l + packed(j, 0);
    const double inverse = 1 / row[j];
    for (std::size_t k = 0; k < j; ++k) {
      double s = 0;
      for (std::size_t i = k; i < j; ++i) s += row[i] * l[packed(i, k)];
      row[k] = -s * inverse;
    }
    row[j] = inverse;
  }
  for (std::size_t k = 0; k < packed_size(p); ++k) shape.whitener[k] = static_cast<Real>(l[k]);
  for (std::size_t j = 0; j < p; ++j) shape.mean[j] = static_cast<Real>(from.mean[j]);
}

template void squared_distances(const Cloud&, const Shape<float>&, float*, float*);
template void squared_distances(const Cloud&, const Shape<double>&, double*, float*);
template void moments(const Cloud&, const std::uint16_t*, std::size_t, const float*, float*, const Moments&);
template void moments(const Cloud&, const std::uint16_t*, std::size_t, const double*, double*,
                      const Moments&);
template void make_shape(const Moments&, std::size_t, const Scratch&, Shape<float>&);
template void make_shape(const Moments&, std::size_t, const Scratch&, Shape<double>&);

}  // namespace pliant::mcd
