#pragma once
// The inner loops of the minimum covariance determinant: distances, selection, moments. Columns are stored one after
// another. Rows are read in fixed lanes and a fixed order, so vector code gives the same bits as scalar code. Searches run
// in float; reported results are computed in double.
#include <cstddef>
#include <cstdint>

#include "base/elementary.hpp"
#include "base/packed_triangle.hpp"
#include "optim/mcd_tuning.hpp"
#include "pliant/outliers.hpp"

namespace pliant::mcd {

inline constexpr std::size_t kBlock = 64;       // rows gathered at a time
inline constexpr std::size_t kRowPadding = 16;  // distances are computed for multiples of this many rows
inline constexpr std::size_t kHistogram = 4096;

/// Standardised data: value of row i, column j at z[j * stride + i]. Readable up to the next multiple of
/// kRowPadding.
struct Cloud {
  const float* z;
  std::size_t stride, rows, columns;
};

/// Plain mean and covariance (over count - 1), lower triangle packed by rows, in memory of the arena's.
struct Moments {
  double *mean, *covariance;
};

/// Centre and whitener W = L^-1, where L L^T is the covariance. The squared distance of x is |W (x - mean)|^2. The arrays
/// lie in the arena.
template <class Real>
struct Shape {
  Real *mean, *whitener;
  ScaledNumber determinant = {};
  bool singular = false;
};

/// Smallest pivot of a column, given those before it, relative to its variance: below, data as precise as
/// float can't tell it from zero.
template <class Real>
inline constexpr double kPivotFloor = sizeof(Real) == sizeof(float) ? 1e-6 : 1e-13;

/// Memory that the steps use in turn. There is one set of moments and one shape at a time.
struct Scratch {
  float* distance;
  std::uint16_t* subset;
  std::uint32_t* key;
  std::uint16_t* histogram;  // kHistogram counts, all zero between calls
  float* block_float;        // columns x kBlock
  double* block_double;
  double *moments_room, *factor_room;  // columns + packed_size(columns) values, and packed_size(columns)
  double* shape_room;                  // as moments_room
  float* float_shape_room;
  float* block(float) const { return block_float; }
  double* block(double) const { return block_double; }
  Moments moments(std::size_t columns) const { return {moments_room, moments_room + columns}; }
  Shape<double> shape(std::size_t columns) const { return {shape_room, shape_room + columns}; }
  Shape<float> float_shape(std::size_t columns) const {
    return {float_shape_room, float_shape_room + columns};
  }
};

ScaledNumber times(ScaledNumber a, double positive);
bool is_less(ScaledNumber a, ScaledNumber b);
/// |a / b - 1| <= tolerance.
bool is_close(ScaledNumber a, ScaledNumber b, double tolerance);

/// The k-th smallest (from 1) of n values, none NaN: exact, whatever their order.
float kth_smallest(const float* value, std::size_t n, std::size_t k, const Scratch& scratch);
/// Rows of the h smallest values, ties by row number, ascending.
void smallest_rows(const float* value, std::size_t n, std::size_t h, std::uint16_t* row,
                   const Scratch& scratch);

/// Squared distances of all rows, as floats. Uses `block`.
template <class Real>
void squared_distances(const Cloud& cloud, const Shape<Real>& shape, Real* block, float* out);

/// Moments of the rows listed, accumulated about `shift` (any point near them).
template <class Real>
void moments(const Cloud& cloud, const std::uint16_t* row, std::size_t count, const Real* shift, Real* block,
             const Moments& out);

/// Whitener and determinant. A pivot below its floor is put on it, and the shape is `singular`.
template <class Real>
void make_shape(const Moments& moments, std::size_t columns, const Scratch& scratch, Shape<Real>& shape);

/// Shape of the rows listed.
template <class Real>
void fit_shape(const Cloud& cloud, const std::uint16_t* row, std::size_t count, const Scratch& scratch,
               Shape<Real>& shape) {
  Real shift[kMcdMaxColumns];
  for (std::size_t j = 0; j < cloud.columns; ++j)
    shift[j] = static_cast<Real>(cloud.z[j * cloud.stride + row[0]]);
  const Moments sums = scratch.moments(cloud.columns);
  moments(cloud, row, count, shift, scratch.block(Real()), sums);
  make_shape(sums, cloud.columns, scratch, shape);
}

/// C-step: the shape of the h rows nearest in the metric of `shape`, which never has a larger determinant
/// than that of another h rows that `shape` came from. The rows are left in scratch.subset.
template <class Real>
void c_step(const Cloud& cloud, std::size_t h, const Scratch& scratch, Shape<Real>& shape) {
  squared_distances(cloud, shape, scratch.block(Real()), scratch.distance);
  smallest_rows(scratch.distance, cloud.rows, h, scratch.subset, scratch);
  const Moments sums = scratch.moments(cloud.columns);
  moments(cloud, scratch.subset, h, shape.mean, scratch.block(Real()), sums);
  make_shape(sums, cloud.columns, scratch, shape);
}

}  // namespace pliant::mcd
