#pragma once
// Two buffers that a camera's DMA fills in turn, and what its interrupt and the program say to each other about them.
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "pliant/frame.hpp"

/// One side runs in the camera's interrupt (`filling`, `on_frame_complete`), the other in the program (`take`,
/// `give_back`). A frame that is complete while the program still holds the one before is dropped and counted: the
/// camera fills its buffer again, and what the program reads is never written to.
class CameraBuffers {
 public:
  /// \param first, second  each of height * stride_bytes, where the DMA can write. With a data cache: uncached, or
  ///                       invalidated before on_frame_complete.
  CameraBuffers(std::uint8_t* first, std::uint8_t* second, int width, int height, std::size_t stride_bytes)
      : pixels_{first, second}, width_(width), height_(height), stride_bytes_(stride_bytes) {}
  CameraBuffers(const CameraBuffers&) = delete;
  CameraBuffers& operator=(const CameraBuffers&) = delete;

  /// Where the next frame goes.
  std::uint8_t* filling() { return pixels_[filling_]; }

  /// The frame in `filling` is complete. \param time_ns  of its exposure.
  void on_frame_complete(std::int64_t time_ns) {
    ++sequence_;
    if (ready_.load(std::memory_order_acquire)) {
      const std::uint32_t before = dropped_.load(std::memory_order_relaxed);
      dropped_.store(before + 1, std::memory_order_relaxed);  // nobody else writes it
      return;
    }
    view_ = {pixels_[filling_], width_, height_, stride_bytes_, 1, time_ns, sequence_};
    filling_ = 1 - filling_;
    ready_.store(true, std::memory_order_release);
  }

  /// The frame that is complete, until it is given back. False when there is none.
  bool take(pliant::FrameView* frame) {
    if (!ready_.load(std::memory_order_acquire)) return false;
    *frame = view_;
    return true;
  }
  void give_back() { ready_.store(false, std::memory_order_release); }

  /// Frames dropped so far. Either side may ask.
  std::uint32_t dropped() const { return dropped_.load(std::memory_order_relaxed); }

 private:
  std::uint8_t* pixels_[2];
  int width_, height_;
  std::size_t stride_bytes_;
  int filling_ = 0;
  std::uint32_t sequence_ = 0;
  std::atomic<std::uint32_t> dropped_{0};
  pliant::FrameView view_;
  std::atomic<bool> ready_{false};
};
