#pragma once
/// \file reduced_tracker.hpp
/// A tracker and the reduction of its frames.
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "host/commands/frame_reduction.hpp"
#include "host/commands/initial_state.hpp"
#include "host/io/owned.hpp"
#include "host/render/overlay.hpp"
#include "pliant/tracker.hpp"

namespace pliant::host {

/// All that goes in and comes out is in pixels of the whole frames, but for what `tracker` gives.
class ReducedTracker {
 public:
  /// Makes a tracker of frames of this size.
  using Make = std::function<std::unique_ptr<Owned<Tracker>>(ImageSize)>;

  /// \param whole  size of the frames before they are reduced. \param factor  by which they are reduced; 1: not at all.
  ReducedTracker(const Make& make, ImageSize whole, int factor)
      : by_(factor), tracker_(make(by_.reduced(whole))) {}

  /// As start_tracker.
  Status start(const FrameView& frame, const Initial& initial, const InitialOptions& options,
               const TrackerOptions& tracker_options, const std::vector<Vec2>& markers);
  Status start_by_detection(const InitialOptions& options, const TrackerOptions& tracker_options);
  Status update(const FrameView& frame);

  Tracker& tracker() { return **tracker_; }
  const Tracker& tracker() const { return *tracker_->operator->(); }
  int factor() const { return by_.factor(); }
  std::size_t used_bytes() const { return tracker_->used_bytes(); }

  /// Of a track: its focal length and residual, px; the scale at which it shows the model, px a mm.
  float focal_px() const { return scale() * tracker().camera().f; }
  float rms_px() const { return scale() * tracker().result().rms_px; }
  float px_per_mm() const { return focal_px() / tracker().result().pose.t.z; }
  /// Nothing where the camera does not see them.
  std::optional<Vec2> landmark(std::size_t k);
  std::optional<Vec2> marker(std::size_t k);
  WireMesh mesh();

 private:
  float scale() const { return static_cast<float>(by_.factor()); }

  FrameReduction by_;
  std::unique_ptr<Owned<Tracker>> tracker_;
};

}  // namespace pliant::host
