#pragma once
/// \file at.hpp
#include <cstddef>

namespace pliant::host::bake {

/// An int that is known not to be negative, as the index of a container.
constexpr std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

}  // namespace pliant::host::bake
