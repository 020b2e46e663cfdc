#pragma once
// The six scatter matrices that DetMCD starts from (Hubert, Rousseeuw & Verdonck 2012; docs/algorithms.md, section 6.3).
#include "optim/mcd_kernel.hpp"

namespace pliant::mcd {

enum class StartKind {
  tanh_correlation,
  rank_correlation,
  normal_scores,
  spatial_signs,
  median_ball,
  pairwise_scales
};
inline constexpr StartKind kAllStarts[] = {StartKind::median_ball,      StartKind::tanh_correlation,
                                           StartKind::rank_correlation, StartKind::normal_scores,
                                           StartKind::spatial_signs,    StartKind::pairwise_scales};

/// A square matrix by rows, in memory of the arena's.
struct Matrix {
  double* value;
  std::size_t columns;
  double* operator[](std::size_t row) const { return value + row * columns; }
};

/// Room for a start: `other` for as many values as the cloud has, `line` and `order` for one a row, `matrices` for two.
struct StartRoom {
  float* other;
  float* line;
  std::uint16_t* order;
  double* matrices;
};

/// One of the six, up to a factor.
void start_matrix(StartKind kind, const Cloud& cloud, const Scratch& scratch, const StartRoom& room,
                  Matrix out);

/// out[i] = sum over j of coefficient[j] z_j[i].
void combine(const Cloud& cloud, const double* coefficient, float* out);
/// The median (the lower one of two).
float median(const float* value, std::size_t n, const Scratch& scratch);
/// Median absolute deviation of `value`, made consistent for Gaussian data. Overwrites it.
double median_deviation(float* value, std::size_t n, const Scratch& scratch);

}  // namespace pliant::mcd
