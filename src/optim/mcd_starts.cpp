// Scales are median absolute deviations, where the authors take Qn or tau: they cost O(n), and only choose starts.
#include "optim/mcd_starts.hpp"

#include "base/heap_sort.hpp"

namespace pliant::mcd {

void combine(const Cloud& cloud, const double* coefficient, float* out) {
  for (std::size_t i = 0; i < cloud.rows; ++i) out[i] = 0;
  for (std::size_t j = 0; j < cloud.columns; ++j) {
    const float c = static_cast<float>(coefficient[j]);
    const float* z = cloud.z + j * cloud.stride;
    for (std::size_t i = 0; i < cloud.rows; ++i) out[i] += c * z[i];
  }
}

float median(const float* value, std::size_t n, const Scratch& scratch) {
  return kth_smallest(value, n, (n + 1) / 2, scratch);
}

double median_deviation(float* value, std::size_t n, const Scratch& scratch) {
  const float center = median(value, n, scratch);
  for (std::size_t i = 0; i < n; ++i) {
    const float d = value[i] - center;
    value[i] = d < 0 ? -d : d;
  }
  return kMadToDeviation * static_cast<double>(median(value, n, scratch));
}

namespace {

void unpack(const Moments& moments, std::size_t p, Matrix out) {
  for (std::size_t j = 0; j < p; ++j)
    for (std::size_t k = 0; k <= j; ++k) out[j][k] = out[k][j] = moments.covariance[packed(j, k)];
}

void moments_of_all(const Cloud& cloud, const Scratch& scratch, const Moments& out) {
  for (std::size_t i = 0; i < cloud.rows; ++i) scratch.subset[i] = static_cast<std::uint16_t>(i);
  const float zero[kMcdMaxColumns] = {};
  moments(cloud, scratch.subset, cloud.rows, zero, scratch.block_float, out);
}

void make_correlation(std::size_t p, Matrix m) {
  double inverse[kMcdMaxColumns];
  for (std::size_t j = 0; j < p; ++j) inverse[j] = m[j][j] > 0 ? 1 / square_root(m[j][j]) : 0.0;
  for (std::size_t j = 0; j < p; ++j)
    for (std::size_t k = 0; k < p; ++k) m[j][k] = j == k ? 1.0 : m[j][k] * inverse[j] * inverse[k];
}

/// Ranks from 1, ties sharing their mean, or the normal scores of these.
void rank_column(const float* z, std::size_t n, bool normal_scores, std::uint16_t* order, float* out) {
  for (std::size_t i = 0; i < n; ++i) order[i] = static_cast<std::uint16_t>(i);
  heap_sort(order, n, [z](std::uint16_t a, std::uint16_t b) { return z[a] != z[b] ? z[a] < z[b] : a < b; });
  const double count = static_cast<double>(n);
  for (std::size_t first = 0, last = 0; first < n; first = last) {
    while (last < n && z[order[last]] == z[order[first]]) ++last;
    const double rank = 0.5 * static_cast<double>(first + 1 + last);
    const double score = normal_scores ? normal_quantile((rank - 1.0 / 3) / (count + 1.0 / 3)) : rank / count;
    for (std::size_t i = first; i < last; ++i) out[order[i]] = static_cast<float>(score);
  }
}

void squared_lengths(const Cloud& cloud, float* out) {
  for (std::size_t i = 0; i < cloud.rows; ++i) out[i] = 0;
  for (std::size_t j = 0; j < cloud.columns; ++j) {
    const float* z = cloud.z + j * cloud.stride;
    for (std::size_t i = 0; i < cloud.rows; ++i) out[i] += z[i] * z[i];
  }
}

/// Sum of z z^T / |z|^2; a row in the middle has no direction.
void spatial_sign_matrix(const Cloud& cloud, const Scratch& scratch, const StartRoom& room, Matrix out) {
  squared_lengths(cloud, room.line);
  for (std::size_t i = 0; i < cloud.rows; ++i)
    room.line[i] =
        room.line[i] > 1e-12f ? static_cast<float>(1 / square_root(static_cast<double>(room.line[i]))) : 0.0f;
  for (std::size_t j = 0; j < cloud.columns; ++j)
    for (std::size_t i = 0; i < cloud.rows; ++i)
      room.other[j * cloud.stride + i] = cloud.z[j * cloud.stride + i] * room.line[i];
  const Moments m = scratch.moments(cloud.columns);
  moments_of_all({room.other, cloud.stride, cloud.rows, cloud.columns}, scratch, m);
  unpack(m, cloud.columns, out);
  const double n = static_cast<double>(cloud.rows);
  for (std::size_t j = 0; j < cloud.columns; ++j)
    for (std::size_t k = 0; k < cloud.columns; ++k) out[j][k] += m.mean[j] * m.mean[k] * n / (n - 1);
}

/// Gnanadesikan and Kettenring: covariances from the scales of sums and differences.
void pairwise_scale_matrix(const Cloud& cloud, const Scratch& scratch, const StartRoom& room, Matrix out) {
  for (std::size_t j = 0; j < cloud.columns; ++j) {
    out[j][j] = 1;
    for (std::size_t k = 0; k < j; ++k) {
      double squares[2];
      for (int sign = 0; sign < 2; ++sign) {
        const float* a = cloud.z + j * cloud.stride;
        const float* b = cloud.z + k * cloud.stride;
        const float s = sign == 0 ? 1.0f : -1.0f;
        for (std::size_t i = 0; i < cloud.rows; ++i) room.line[i] = a[i] + s * b[i];
        const double scale = median_deviation(room.line, cloud.rows, scratch);
        squares[sign] = scale * scale;
      }
      out[j][k] = out[k][j] = 0.25 * (squares[0] - squares[1]);
    }
  }
}

void transform_columns(StartKind kind, const Cloud& cloud, const StartRoom& room) {
  for (std::size_t j = 0; j < cloud.columns; ++j) {
    const float* z = cloud.z + j * cloud.stride;
    float* out = room.other + j * cloud.stride;
    if (kind == StartKind::tanh_correlation)
      for (std::size_t i = 0; i < cloud.rows; ++i) out[i] = hyperbolic_tangent(z[i]);
    else
      rank_column(z, cloud.rows, kind == StartKind::normal_scores, room.order, out);
  }
}

}  // namespace

void start_matrix(StartKind kind, const Cloud& cloud, const Scratch& scratch, const StartRoom& room,
                  Matrix out) {
  const Moments m = scratch.moments(cloud.columns);
  switch (kind) {
    case StartKind::spatial_signs:
      spatial_sign_matrix(cloud, scratch, room, out);
      return;
    case StartKind::pairwise_scales:
      pairwise_scale_matrix(cloud, scratch, room, out);
      return;
    case StartKind::median_ball: {
      squared_lengths(cloud, room.line);
      const std::size_t half = (cloud.rows + 1) / 2;
      smallest_rows(room.line, cloud.rows, half, scratch.subset, scratch);
      const float zero[kMcdMaxColumns] = {};
      moments(cloud, scratch.subset, half, zero, scratch.block_float, m);
      unpack(m, cloud.columns, out);
      return;
    }
    case StartKind::tanh_correlation:
    case StartKind::rank_correlation:
    case StartKind::normal_scores:
      break;
  }
  transform_columns(kind, cloud, room);
  moments_of_all({room.other, cloud.stride, cloud.rows, cloud.columns}, scratch, m);
  unpack(m, cloud.columns, out);
  make_correlation(cloud.columns, out);
}

}  // namespace pliant::mcd
