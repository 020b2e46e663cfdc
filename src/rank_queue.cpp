#include "pliant/rank_queue.hpp"

namespace pliant {

void RankQueue::lay_out(Arena& arena, std::size_t capacity) {
  capacity_ = capacity;
  key_ = arena.take<std::uint64_t>(capacity);
  id_ = arena.take<std::uint16_t>(capacity);
  place_ = arena.take<std::uint16_t>(capacity);
  count_ = 0;
}

void RankQueue::clear() {
  for (std::size_t i = 0; i < capacity_; ++i) place_[i] = kNone;
  count_ = 0;
}

void RankQueue::sift_up(std::size_t hole, std::uint16_t id, std::uint64_t key) {
  while (hole > 0) {
    const std::size_t parent = (hole - 1) / 2;
    if (key_[parent] >= key) break;
    place(hole, id_[parent], key_[parent]);
    hole = parent;
  }
  place(hole, id, key);
}

void RankQueue::sift_down(std::size_t hole, std::uint16_t id, std::uint64_t key) {
  for (std::size_t child = 2 * hole + 1; child < count_; child = 2 * hole + 1) {
    child += child + 1 < count_ && key_[child + 1] > key_[child] ? 1 : 0;
    if (key_[child] <= key) break;
    place(hole, id_[child], key_[child]);
    hole = child;
  }
  place(hole, id, key);
}

void RankQueue::set(std::uint16_t id, std::uint64_t key) {
  const std::size_t at = place_[id];
  if (at == kNone)
    sift_up(count_++, id, key);
  else if (key > key_[at])
    sift_up(at, id, key);
  else
    sift_down(at, id, key);
}

void RankQueue::remove(std::uint16_t id) {
  const std::size_t at = place_[id];
  if (at == kNone) return;
  place_[id] = kNone;
  if (at == --count_) return;
  const std::uint16_t last = id_[count_];
  const std::uint64_t key = key_[count_];
  if (at > 0 && key > key_[(at - 1) / 2])
    sift_up(at, last, key);
  else
    sift_down(at, last, key);
}

}  // namespace pliant
