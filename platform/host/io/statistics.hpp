#pragma once
/// \file statistics.hpp
/// Quantiles of measured values.
#include <vector>

namespace pliant::host {

/// The value below which `fraction` (0 to 1) of the values lie, interpolated linearly; NaN if there are none.
double quantile(std::vector<double> values, double fraction);

/// The quantile of 1/2; 0 if there are no values.
double median(std::vector<double> values);
/// The same without interpolation: one of the values, of two in the middle the larger one.
double upper_median(std::vector<double> values);

}  // namespace pliant::host
