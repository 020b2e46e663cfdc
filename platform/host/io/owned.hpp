#pragma once
/// \file owned.hpp
/// An arena object together with its memory, for host code.
#include <vector>

#include "host/io/failure.hpp"
#include "pliant/arena.hpp"

namespace pliant::host {

/// A piece of an arena's block. A vector of it is aligned as an arena needs, which one of bytes need not be.
struct alignas(Arena::kAlignment) ArenaLine {
  unsigned char bytes[Arena::kAlignment];
};

template <class T>
class Owned {
 public:
  /// Creates the object for these limits in a block of the measured size.
  template <class... Limits>
  explicit Owned(const Limits&... limits)
      : block_(measured_bytes<T>(limits...) / sizeof(ArenaLine) + 1),
        arena_(block_.data(), block_.size() * sizeof(ArenaLine)) {
    require(create_in(arena_, object_, limits...), "memory");
  }
  Owned(const Owned&) = delete;
  Owned& operator=(const Owned&) = delete;

  T& operator*() { return object_; }
  const T& operator*() const { return object_; }
  T* operator->() { return &object_; }
  const T* operator->() const { return &object_; }
  std::size_t used_bytes() const { return arena_.used_bytes(); }

 private:
  std::vector<ArenaLine> block_;
  Arena arena_;
  T object_;
};

}  // namespace pliant::host
