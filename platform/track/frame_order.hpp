#pragma once
/// \file frame_order.hpp
/// Whether a frame comes twice or late.
#include <cstdint>

#include "pliant/frame.hpp"

namespace pliant {

class FrameOrder {
 public:
  /// A clock may be set back and a sequence number may be left out, but not both.
  bool is_stale(const FrameView& view) const {
    // Numbers go round: those of earlier frames, and the last one's, are far ahead.
    const std::uint32_t skipped = view.sequence - sequence_ - 1;
    return has_frame_ && view.time_ns <= time_ns_ && skipped >= 0x7FFFFFFFu;
  }
  void note(const FrameView& view) {
    time_ns_ = view.time_ns;
    sequence_ = view.sequence;
    has_frame_ = true;
  }
  /// The next frame may have any time.
  void forget_time() { has_frame_ = false; }

 private:
  std::int64_t time_ns_ = 0;  // of the last frame
  std::uint32_t sequence_ = 0;
  bool has_frame_ = false;
};

}  // namespace pliant
