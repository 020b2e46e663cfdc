#pragma once
// The queue of frames between a camera's thread and the application's.
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>

namespace pliant {

/// A queue of at most `capacity` items. A full queue drops its oldest item, so that a slow reader gets the newest
/// frames and no growing delay. All functions may be called from any thread.
template <class T>
class FrameQueue {
 public:
  explicit FrameQueue(std::size_t capacity) : capacity_(capacity > 0 ? capacity : 1) {}

  /// Adds an item. \return the oldest item if it was dropped for it, or `item` itself if the queue is closed.
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

  /// Removes the oldest item. If the queue is empty, waits for an item for at most `patience`. \return nothing if none
  /// came, and at once if the queue is closed and empty.
  std::optional<T> pop(std::chrono::milliseconds patience) {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait_for(lock, patience, [this] { return is_closed_ || !items_.empty(); });
    if (items_.empty()) return std::nullopt;
    std::optional<T> item(std::move(items_.front()));
    items_.pop_front();
    return item;
  }

  /// From now on nothing is added; items that are inside can still be popped.
  void close() {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_closed_ = true;
    changed_.notify_all();
  }
  /// Empties and opens the queue and sets dropped_count to 0.
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
