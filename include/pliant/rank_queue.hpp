#pragma once
/// \file rank_queue.hpp
/// A priority queue of ids in fixed memory that gives the same order on every target and for every history.
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/id_set.hpp"

namespace pliant {

/// Binary heap over ids 0 ... capacity - 1, highest key first. Keys are 64-bit: a rank above, a tie-break by
/// content below, so that the order never depends on ids or insertion. set and remove cost O(log n), the rest
/// O(1). 12 bytes an id.
class RankQueue {
 public:
  /// \param capacity  at most 65,535.
  void lay_out(Arena& arena, std::size_t capacity);
  void clear();

  std::size_t count() const { return count_; }
  bool contains(std::uint16_t id) const { return place_[id] != kNone; }
  /// Precondition: count() > 0.
  std::uint16_t top() const { return id_[0]; }
  std::uint64_t top_key() const { return key_[0]; }
  /// Precondition: contains(id).
  std::uint64_t key(std::uint16_t id) const { return key_[place_[id]]; }

  /// Inserts id, or moves it to its new key.
  void set(std::uint16_t id, std::uint64_t key);
  /// Takes id out if it is in.
  void remove(std::uint16_t id);

 private:
  void place(std::size_t at, std::uint16_t id, std::uint64_t key) {
    id_[at] = id;
    key_[at] = key;
    place_[id] = static_cast<std::uint16_t>(at);
  }
  void sift_up(std::size_t hole, std::uint16_t id, std::uint64_t key);
  void sift_down(std::size_t hole, std::uint16_t id, std::uint64_t key);

  std::uint64_t* key_ = nullptr;  // in heap order, as id_
  std::uint16_t* id_ = nullptr;
  std::uint16_t* place_ = nullptr;  // of an id in the heap, or kNone
  std::size_t capacity_ = 0, count_ = 0;
};

}  // namespace pliant
