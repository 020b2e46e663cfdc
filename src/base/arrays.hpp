#pragma once
// Loops over plain arrays.
#include <cstddef>

#include "pliant/geometry.hpp"

namespace pliant {

/// \pre the arrays do not overlap.
template <class T>
void copy(const T* from, std::size_t count, T* to) {
  for (std::size_t i = 0; i < count; ++i) to[i] = from[i];
}

inline bool are_finite(const float* x, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i)
    if (!is_finite(x[i])) return false;
  return true;
}

}  // namespace pliant
