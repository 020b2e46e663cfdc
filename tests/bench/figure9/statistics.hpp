#pragma once
/// \file statistics.hpp
/// Summaries of an error over time, and how sure a difference of two is.
#include <vector>

namespace pliant::figure9 {

struct Summary {
  double mean = 0, median = 0, p95 = 0, last_100 = 0;
};
/// All 0 if there are no values.
Summary summarise(const std::vector<double>& error);

/// The mean of a - b, frame by frame, with its 95 % interval by block bootstrap: blocks of 30 frames drawn with
/// replacement, 2000 times, because errors of neighbouring frames are not independent.
struct Difference {
  double mean = 0, low = 0, high = 0;
};
Difference paired_difference(const std::vector<double>& a, const std::vector<double>& b);

}  // namespace pliant::figure9
