#pragma once
/// \file rank_queue.hpp
/// A priority queue of ids in fixed memory that gives the same order on every target and for every history.
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/id_set.hpp"

namespace pliant {

/// Heap with four children a node over ids 0 ... capacity - 1, highest key first. The upper 32 bits of a key
/// are a rank, the lower ones break ties by content, so the order does not depend on ids or on the order of
/// insertion. 12 bytes an id.
///
/// New ids are sorted in when `top` is called. Ids with keys below a floor keep their keys outside the heap.
class RankQueue {
 public:
  /// \param capacity  at most 65,535.
  void lay_out(Arena& arena, std::size_t capacity);
  /// \param floor  ids with lower keys never come to the top.
  void clear(std::uint64_t floor = 0);

  /// True where the id is in the queue.
  bool contains(std::uint16_t id) const {
    PLIANT_ASSERT(id < capacity_);
    return place_[id] != kNone;
  }
  /// Precondition: contains(id).
  std::uint64_t key(std::uint16_t id) const {
    PLIANT_ASSERT(contains(id));
    return key_[place_[id]];
  }
  /// The id with the highest key, or kNone where no key reaches the floor. O(log n) for each id inserted since the last
  /// call.
  std::uint16_t top() {
    if (sorted_ < heap_) sort_in();
    return heap_ > 0 ? id_[0] : kNone;
  }

  /// The highest of all keys, those below the floor included; 0 where there are none. O(n).
  std::uint64_t find_highest_key() const;

  /// Inserts id, O(1), or moves it to its new key, O(log n).
  void set(std::uint16_t id, std::uint64_t key) {
    if (place_[id] == kNone)
      insert(id, key);
    else
      move(id, key);
  }
  /// Inserts or moves id, but outside the heap, as if its key were below the floor. O(log n).
  void hold(std::uint16_t id, std::uint64_t key);
  /// Removes id, if it is there. O(log n).
  void remove(std::uint16_t id);

 private:
  void place(std::size_t at, std::uint16_t id, std::uint64_t key) {
    id_[at] = id;
    key_[at] = key;
    place_[id] = static_cast<std::uint16_t>(at);
  }
  void insert(std::uint16_t id, std::uint64_t key) { place(key < floor_ ? --low_ : heap_++, id, key); }
  void move(std::uint16_t id, std::uint64_t key);
  void sort_in();
  void sift(std::size_t hole, std::uint16_t id, std::uint64_t key);
  void sift_up(std::size_t hole, std::uint16_t id, std::uint64_t key);
  void sift_down(std::size_t hole, std::uint16_t id, std::uint64_t key);

  // The heap and the unsorted ids are at the front of the arrays; ids below the floor or on hold are at the back.
  std::uint64_t* key_ = nullptr;
  std::uint16_t* id_ = nullptr;
  std::uint16_t* place_ = nullptr;  // of an id in key_ and id_, or kNone
  std::size_t capacity_ = 0;
  std::size_t sorted_ = 0, heap_ = 0;  // sizes: of the heap; of the heap and the unsorted ids
  std::size_t low_ = 0;                // where the ids at the back begin
  std::uint64_t floor_ = 0;
};

}  // namespace pliant
