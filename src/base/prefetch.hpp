#pragma once
/// \file prefetch.hpp
/// Fetches memory before it is read.
#include <cstddef>

#include "base/lanes.hpp"
#include "pliant/geometry.hpp"

namespace pliant {

/// Starts to fetch the samples of a surface point that is evaluated a few points later. Only a hint, where the processor has
/// vectors: there the evaluation of many points would wait for the memory of each. Elsewhere it means nothing.
inline void prefetch_samples([[maybe_unused]] const Vec3* samples) {
  constexpr std::size_t kLine = 64, kLines = 4;  // bytes; what most points of a face use
  if constexpr (kHasVectors)
    for (std::size_t k = 0; k < kLines; ++k)
      __builtin_prefetch(reinterpret_cast<const unsigned char*>(samples) + k * kLine);
}

}  // namespace pliant
