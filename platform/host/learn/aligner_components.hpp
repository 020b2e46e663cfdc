#pragma once
/// \file aligner_components.hpp
/// Reduced-rank regression: a linear regression with many outputs as a few linear components.
#include "host/learn/aligner_encoding.hpp"
#include "host/learn/ridge.hpp"

namespace pliant::host::learn {

/// The components along which the predictions of a ridge solution vary most.
/// \param sums  of the examples. \param solution  of solve_ridge. \param components  at most; as many as outputs if fewer.
/// \return without information.
LearntGlobal reduce_to_components(const RidgeSums& sums, const std::vector<double>& solution,
                                  std::size_t components);

}  // namespace pliant::host::learn
