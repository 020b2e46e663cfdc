#pragma once
/// \file detection_run.hpp
/// A tracker that starts by itself, and what it finds.
#include "host/bench/annotated_faces.hpp"
#include "host/io/files.hpp"
#include "host/io/owned.hpp"
#include "pliant/tracker.hpp"

namespace pliant::host {

/// Below this landmark error a face is aligned right.
constexpr double kRightError = 0.06;

class DetectionRun {
 public:
  DetectionRun(const ModelFile& file, const TrackerLimits& limits) : tracker_(file.model(), limits) {}
  /// With the default limits for frames of this size.
  DetectionRun(const ModelFile& file, int width, int height);

  /// Gives the tracker the next frame. Bad input: the tracker refuses it.
  void update(const FrameView& frame);
  /// Whether the last frame has a track that is not lost.
  bool has_track() { return is_started_ && result_.state != TrackState::lost; }
  /// Landmarks of the last frame.
  NamedLandmarks landmarks();
  const FrameResult& result() const { return result_; }
  Tracker& tracker() { return *tracker_; }

 private:
  Owned<Tracker> tracker_;
  FrameResult result_;
  bool is_started_ = false;
};

}  // namespace pliant::host
