#pragma once
/// \file id_set.hpp
/// A pool of 16-bit ids, each free or in use.
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"

namespace pliant {

/// The id or index that means none: no vertex, face, half-edge, or entry of a table.
constexpr std::uint16_t kNone = 0xFFFF;

/// Ids 0 ... capacity - 1, each free or in use. `take` returns the lowest free id, so the next ids depend
/// only on which ids are in use, not on the history, and ids stay dense. Two levels of bits, capacity / 8
/// bytes. `take` costs two bit scans and at most 16 word reads; the rest is O(1) unless said otherwise.
class IdSet {
 public:
  /// \param capacity  at most 65,535.
  void lay_out(Arena& arena, std::size_t capacity);
  /// Ids below `used` are in use, all others free. O(capacity / 64).
  void reset(std::size_t used);
  /// Copies the state of a set. Precondition: the same capacity.
  void copy_from(const IdSet& other);

  std::size_t capacity() const { return capacity_; }            ///< Ids that there are.
  std::size_t used_count() const { return used_; }              ///< Ids in use.
  std::size_t free_count() const { return capacity_ - used_; }  ///< Ids that are free.
  /// True for an id in use.
  bool is_used(std::uint16_t id) const { return id < capacity_ && (free_[id >> 6] >> (id & 63) & 1) == 0; }

  /// Takes the lowest free id into use. Precondition: free_count() > 0.
  std::uint16_t take() {
    PLIANT_ASSERT(free_count() > 0);
    const std::size_t word = lowest_;
    const std::uint64_t bits = free_[word];
    free_[word] = bits & (bits - 1);
    if (free_[word] == 0) find_lowest(word);
    ++used_;
    return static_cast<std::uint16_t>(word << 6 | lowest_bit(bits));
  }
  /// Frees an id. Precondition: it is in use.
  void put_back(std::uint16_t id) {
    PLIANT_ASSERT(is_used(id));
    const std::size_t word = id >> 6;
    if (free_[word] == 0) groups_[word >> 6] |= std::uint64_t{1} << (word & 63);
    free_[word] |= std::uint64_t{1} << (id & 63);
    if (word < lowest_) lowest_ = word;
    --used_;
  }
  /// The lowest id in use that is at least `from`; the capacity when there is none. O(capacity / 64).
  std::size_t next_used(std::size_t from) const {
    if (from >= capacity_) return capacity_;
    if (is_used(static_cast<std::uint16_t>(from))) return from;  // usually so in a walk
    std::size_t word = from >> 6;
    std::uint64_t bits = ~free_[word] >> (from & 63) << (from & 63);
    for (const std::size_t last = (capacity_ - 1) >> 6; bits == 0 && word < last;) bits = ~free_[++word];
    if (bits == 0) return capacity_;
    const std::size_t id = word << 6 | lowest_bit(bits);
    return id < capacity_ ? id : capacity_;
  }

  /// Walks the ids in use in ascending order. A change during the walk counts for ids that are still ahead.
  class Iterator {
   public:
    /// At the first used id from `id` on.
    Iterator(const IdSet& set, std::size_t id) : set_(&set), id_(id) {}
    std::uint16_t operator*() const { return static_cast<std::uint16_t>(id_); }  ///< The id.
    /// The next used id.
    Iterator& operator++() {
      id_ = set_->next_used(id_ + 1);
      return *this;
    }
    /// Whether two are at different ids.
    bool operator!=(const Iterator& other) const { return id_ != other.id_; }

   private:
    const IdSet* set_;
    std::size_t id_;
  };
  Iterator begin() const { return {*this, next_used(0)}; }  ///< The lowest id in use.
  Iterator end() const { return {*this, capacity_}; }       ///< One behind the last.

 private:
  static unsigned lowest_bit(std::uint64_t bits) { return static_cast<unsigned>(__builtin_ctzll(bits)); }

  void find_lowest(std::size_t emptied);

  std::uint64_t* free_ = nullptr;                     // bit set: id is free
  std::uint64_t* groups_ = nullptr;                   // bit set: that word of free_ is not zero
  std::size_t capacity_ = 0, used_ = 0, lowest_ = 0;  // lowest_: the first word with a free id, or words
};

}  // namespace pliant
