#pragma once
// Frames between a camera's thread and ours.
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>

namespace pliant {

/// A queue of at most `capacity` items. A full queue gives up its oldest: who comes late gets the newest pictures, not a
/// growing delay. Safe between threads.
template <class T>
class FrameQueue {
 public:
  explicit FrameQueue(std::size_t capacity) : capacity_(capacity > 0 ? capacity : 1) {}

  /// Takes `item`; returns the oldest one where that had to go, or `item` itself when the queue is closed.
  std::optional<T> push(T item) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (is_closed_) return item;
    std::optional<T> dropped;
    if (items_.size() == capacity_) {
      dropped = std::move(items_.front());
      items_.pop_front();
      ++dropped_count_;
    }
    items_.push_back(std::move(item));
    changed_.notify_one();
    return dropped;
  }

  /// The oldest item, waited for at most `patience`; nothing when none came, or at once when the queue is closed and empty.
  std::optional<T> pop(std::chrono::milliseconds patience) {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait_for(lock, patience, [this] { return is_closed_ || !items_.empty(); });
    if (items_.empty()) return std::nullopt;
    std::optional<T> item(std::move(items_.front()));
    items_.pop_front();
    return item;
  }

  /// From now on nothing is taken; what is inside can still be popped.
  void close() {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_closed_ = true;
    changed_.notify_all();
  }
  /// Empty, open, nothing dropped.
  void reset() {
    const std::lock_guard<std::mutex> lock(mutex_);
    items_.clear();
    is_closed_ = false;
    dropped_count_ = 0;
  }

  bool is_closed() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return is_closed_;
  }
  std::uint64_t dropped_count() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return dropped_count_;
  }

 private:
  const std::size_t capacity_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<T> items_;
  bool is_closed_ = false;
  std::uint64_t dropped_count_ = 0;
};

}  // namespace pliant
