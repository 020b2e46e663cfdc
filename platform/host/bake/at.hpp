#pragma once
/// \file at.hpp
/// Conversion of int indices.
#include <cstddef>

#include "pliant/status.hpp"

namespace pliant::host::bake {

/// A non-negative int as the index of a container.
constexpr std::size_t at(int i) {
  PLIANT_ASSERT(i >= 0);
  return static_cast<std::size_t>(i);
}

}  // namespace pliant::host::bake
