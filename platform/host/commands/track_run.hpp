#pragma once
/// \file track_run.hpp
/// One run of `pliant track`: starts the tracker, gives it every frame, and hands each result to the output.
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "host/commands/frame_stream.hpp"
#include "host/commands/initial_state.hpp"
#include "host/commands/reduced_tracker.hpp"
#include "host/commands/track_output.hpp"

namespace pliant::host {

/// Image points of the first frame that are tracked with the surface and never observed.
struct Markers {
  std::vector<std::string> names;
  std::vector<Vec2> x;  ///< px
};

/// Where the first start shows a face that is larger than templates are made for, the run takes a tracker of reduced frames and
/// starts it on the same frame. In large frames a second tracker looks for such a face, in frames that are much reduced: at its
/// full size it may not be found. All that goes in and comes out is in pixels of the whole frames.
class TrackRun {
 public:
  /// All references must outlive the run. \param err  where a line says that frames are reduced.
  TrackRun(FrameStream& frames, ReducedTracker::Make make, const TrackerOptions& options,
           const Markers& markers, TrackOutput& output, std::ostream& err)
      : frames_(frames),
        make_(std::move(make)),
        options_(options),
        markers_(markers),
        output_(output),
        err_(err),
        tracker_(make_, frames.size(), 1) {}

  /// Starts on the first frame. Bad input, with the name of the file: what the tracker does not start on. Not to be called
  /// where the tracker finds the face itself.
  void start(const FrameView& frame, const Initial& initial, const InitialOptions& options);
  /// Lets the tracker find the face or print itself, from this frame on. Bad input, with the name of the model: it has neither
  /// learnt tables nor a print; with that of the frames: they are too large to be searched; and as `track`.
  void search(const FrameView& frame, const InitialOptions& options, const std::string& model);
  /// Tracks or searches the next frame. Bad input: a frame that the tracker refuses, or the model's tables of a search.
  void track(const FrameView& frame);

  /// Bytes of the tracker, and the focal length of the last track, px of the whole frames.
  std::size_t used_bytes() const { return tracker_.used_bytes(); }
  float focal_px() const { return focal_px_; }

 private:
  std::string where(const FrameView& frame) const {
    return frames_.name() + ": frame " + std::to_string(frames_.number(frame));
  }
  void begin_search(ReducedTracker& tracker, const std::string& model) const;
  /// Chooses the reduction by the scale of a tracker's track, once. \return whether the frames have to be reduced. The run's
  /// tracker is then a new one, which has not started.
  bool reduces(const ReducedTracker& started);
  /// Whether the face that the overview finds in this frame has to be reduced, as `reduces`.
  bool reduces_for_overview(const FrameView& frame);
  void add(const FrameView& frame, double milliseconds);

  FrameStream& frames_;
  ReducedTracker::Make make_;
  TrackerOptions options_;
  const Markers& markers_;
  TrackOutput& output_;
  std::ostream& err_;
  ReducedTracker tracker_;
  std::unique_ptr<ReducedTracker> overview_;  // null where there is none, or none is needed any more
  InitialOptions initial_;
  std::string model_;       // name of its file, for messages; empty where the run does not search
  bool is_chosen_ = false;  // the reduction
  float focal_px_ = 0;
};

}  // namespace pliant::host
