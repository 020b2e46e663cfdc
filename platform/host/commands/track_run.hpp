#pragma once
/// \file track_run.hpp
/// One run of `pliant track`: starts the tracker, gives it every frame, and hands each result to the output.
#include <string>
#include <vector>

#include "host/commands/frame_stream.hpp"
#include "host/commands/initial_state.hpp"
#include "host/commands/track_output.hpp"
#include "pliant/tracker.hpp"

namespace pliant::host {

/// Image points of the first frame that are tracked with the surface and never observed.
struct Markers {
  std::vector<std::string> names;
  std::vector<Vec2> x;  ///< px
};

class TrackRun {
 public:
  /// All references must outlive the run.
  TrackRun(FrameStream& frames, Tracker& tracker, const TrackerOptions& options, const Markers& markers,
           TrackOutput& output)
      : frames_(frames), tracker_(tracker), options_(options), markers_(markers), output_(output) {}

  /// Starts on the first frame. Bad input, with the name of the file: what the tracker does not start on. Not to be called
  /// where the tracker finds the face itself.
  void start(const FrameView& frame, const Initial& initial, const InitialOptions& options);
  /// Lets the tracker find the face itself, from this frame on. Bad input, with the name of the model: it has no learnt
  /// tables.
  void search(const FrameView& frame, const InitialOptions& options, const std::string& model);
  /// Tracks or searches the next frame. Bad input: a frame that the tracker refuses.
  void track(const FrameView& frame);

 private:
  std::string where(const FrameView& frame) const {
    return frames_.name() + ": frame " + std::to_string(frames_.number(frame));
  }

  FrameStream& frames_;
  Tracker& tracker_;
  const TrackerOptions& options_;
  const Markers& markers_;
  TrackOutput& output_;
};

}  // namespace pliant::host
