#include "pliant/rank_queue.hpp"

namespace pliant {

void RankQueue::lay_out(Arena& arena, std::size_t capacity) {
  capacity_ = capacity;
  key_ = arena.take<std::uint64_t>(capacity);
  id_ = arena.take<std::uint16_t>(capacity);
  place_ = arena.take<std::uint16_t>(capacity);
  sorted_ = heap_ = 0;
  low_ = capacity;
}

void RankQueue::clear(std::uint64_t floor) {
  for (std::size_t i = 0; i < capacity_; ++i) place_[i] = kNone;
  sorted_ = heap_ = 0;
  low_ = capacity_;
  floor_ = floor;
}

void RankQueue::sift_up(std::size_t hole, std::uint16_t id, std::uint64_t key) {
  while (hole > 0) {
    const std::size_t parent = (hole - 1) / 4;
    if (key_[parent] >= key) break;
    place(hole, id_[parent], key_[parent]);
    hole = parent;
  }
  place(hole, id, key);
}

void RankQueue::sift_down(std::size_t hole, std::uint16_t id, std::uint64_t key) {
  const std::uint64_t* const keys = key_;
  const std::size_t end = sorted_;
  for (std::size_t child = 4 * hole + 1; child < end; child = 4 * hole + 1) {
    std::size_t best = child;
    std::uint64_t best_key = keys[child];
    if (child + 3 < end) {  // in two rounds, without branches on the keys
      const std::uint64_t k1 = keys[child + 1], k2 = keys[child + 2], k3 = keys[child + 3];
      const std::size_t left = child + (k1 > best_key ? 1 : 0), right = child + 2 + (k3 > k2 ? 1 : 0);
      const std::uint64_t left_key = k1 > best_key ? k1 : best_key, right_key = k3 > k2 ? k3 : k2;
      best = left + (right - left) * (right_key > left_key ? 1 : 0);
      best_key = right_key > left_key ? right_key : left_key;
    } else {
      for (std::size_t i = child + 1; i < end; ++i)
        if (keys[i] > best_key) {
          best = i;
          best_key = keys[i];
        }
    }
    if (best_key <= key) break;
    place(hole, id_[best], best_key);
    hole = best;
  }
  place(hole, id, key);
}

void RankQueue::sift(std::size_t hole, std::uint16_t id, std::uint64_t key) {
  if (hole > 0 && key > key_[(hole - 1) / 4])
    sift_up(hole, id, key);
  else
    sift_down(hole, id, key);
}

void RankQueue::sort_in() {
  for (; sorted_ < heap_; ++sorted_) sift_up(sorted_, id_[sorted_], key_[sorted_]);
}

std::uint64_t RankQueue::find_highest_key() const {
  std::uint64_t highest = 0;
  for (std::size_t i = 0; i < heap_; ++i) highest = key_[i] > highest ? key_[i] : highest;
  for (std::size_t i = low_; i < capacity_; ++i) highest = key_[i] > highest ? key_[i] : highest;
  return highest;
}

void RankQueue::move(std::uint16_t id, std::uint64_t key) {
  const std::size_t at = place_[id];
  if (key < floor_) {
    hold(id, key);
  } else if (at >= low_) {
    remove(id);
    insert(id, key);
  } else if (at >= sorted_) {
    key_[at] = key;
  } else if (key != key_[at]) {
    sift(at, id, key);
  }
}

void RankQueue::hold(std::uint16_t id, std::uint64_t key) {
  if (place_[id] != kNone && place_[id] >= low_) {
    key_[place_[id]] = key;
  } else {
    remove(id);
    place(--low_, id, key);
  }
}

void RankQueue::remove(std::uint16_t id) {
  const std::size_t at = place_[id];
  if (at == kNone) return;
  place_[id] = kNone;
  if (at >= low_) {
    if (at != low_) place(at, id_[low_], key_[low_]);
    ++low_;
    return;
  }
  --heap_;
  if (sorted_ > heap_) sorted_ = heap_;
  if (at == heap_) return;
  if (at < sorted_)
    sift(at, id_[heap_], key_[heap_]);
  else
    place(at, id_[heap_], key_[heap_]);
}

}  // namespace pliant
