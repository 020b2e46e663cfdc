#pragma once
/// \file frame_order.hpp
/// Whether a frame comes twice or late.
#include <cstdint>
#include <limits>

#include "pliant/frame.hpp"

namespace pliant {

class FrameOrder {
 public:
  /// A clock may be set back and a sequence number may be left out, but not both.
  bool is_stale(const FrameView& view) const {
    const bool is_next = view.sequence != sequence_ && view.sequence - sequence_ < 0x80000000u;
    return view.time_ns <= time_ns_ && !is_next;
  }
  void note(const FrameView& view) {
    time_ns_ = view.time_ns;
    sequence_ = view.sequence;
  }
  /// The next frame may have any time.
  void forget_time() { time_ns_ = std::numeric_limits<std::int64_t>::min(); }

 private:
  std::int64_t time_ns_ = std::numeric_limits<std::int64_t>::min();  // of the last frame
  std::uint32_t sequence_ = 0;
};

}  // namespace pliant
