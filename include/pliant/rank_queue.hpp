#pragma once
/// \file rank_queue.hpp
/// A priority queue of ids in fixed memory that gives the same order on every target and for every history.
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/id_set.hpp"

namespace pliant {

/// Heap with four children a node over ids 0 ... capacity - 1, highest key first. Keys are 64-bit: a rank
/// above, a tie-break by content below, so that the order never depends on ids or insertion. 12 bytes an id.
///
/// Work is put off where it may turn out to be none: new ids wait unsorted until somebody asks for the top,
/// and ids with keys below a floor are kept with their keys, but outside the heap.
class RankQueue {
 public:
  /// \param capacity  at most 65,535.
  void lay_out(Arena& arena, std::size_t capacity);
  /// \param floor  ids with lower keys never come to the top.
  void clear(std::uint64_t floor = 0);

  bool contains(std::uint16_t id) const { return place_[id] != kNone; }
  /// Precondition: contains(id).
  std::uint64_t key(std::uint16_t id) const { return key_[place_[id]]; }
  /// The id with the highest key, or kNone where none reaches the floor. O(log n) for each id that has come
  /// since the last call.
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
  /// Keeps id with its key, as if that were below the floor. O(log n).
  void hold(std::uint16_t id, std::uint64_t key);
  /// Takes id out if it is in. O(log n).
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

  // The heap and those that wait are at the front of the arrays, those below the floor or on hold at the
  // back.
  std::uint64_t* key_ = nullptr;
  std::uint16_t* id_ = nullptr;
  std::uint16_t* place_ = nullptr;  // of an id in key_ and id_, or kNone
  std::size_t capacity_ = 0;
  std::size_t sorted_ = 0, heap_ = 0;  // heap, and heap with those that wait
  std::size_t low_ = 0;                // where the latter begin
  std::uint64_t floor_ = 0;
};

}  // namespace pliant
