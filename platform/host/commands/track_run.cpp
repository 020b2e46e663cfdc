#include "host/commands/track_run.hpp"

#include <algorithm>
#include <chrono>

#include "host/io/failure.hpp"
#include "pliant/face_detector.hpp"

namespace pliant::host {

namespace {

/// Whether a frame's status is of the model's tables, which a search checks when it begins.
bool is_of_tables(Status status) {
  return (status >= Status::truncated && status <= Status::bad_table) || status == Status::misaligned;
}

/// Bad input: no track starts.
void require_start(Status status, const std::string& where) {
  if (status == Status::too_few_points)
    fail_input(where,
               "the model is not in the picture where the start puts it, or shows its back (points with sides swapped, or "
               "with y upwards?), or has no texture there");
  require(status, where);
}

}  // namespace

void TrackRun::start(const FrameView& frame, const Initial& initial, const InitialOptions& options) {
  const auto start = [&](ReducedTracker& tracker) {
    return tracker.start(frame, initial, options, options_, markers_.x);
  };
  if (const int factor = FrameReduction::factor_for(frames_.size()); factor > 1) {
    ReducedTracker overview(make_, frames_.size(), factor);
    if (start(overview) == Status::ok) reduces(overview);
  }
  require_start(start(tracker_), where(frame));
  if (reduces(tracker_)) require_start(start(tracker_), where(frame));
  add(frame, 0);
}

void TrackRun::begin_search(ReducedTracker& tracker, const std::string& model) const {
  const Status status = tracker.start_by_detection(initial_, options_);
  const ImageSize size = frames_.size();
  if (status == Status::not_found && std::max(size.width, size.height) > kLargestFramePx)
    fail_input(frames_.name(), "is searched up to " + std::to_string(kLargestFramePx) + " pixels a side, not at " +
                                   std::to_string(size.width) + "x" + std::to_string(size.height) +
                                   ": give --init or --box");
  if (status == Status::not_found)
    fail_input(model,
               "has neither learnt tables, for a face, nor a print to be found by: give --init or --box, or bake a face "
               "with --learnt, another surface with a texture that has corners");
  require(status, model);
}

void TrackRun::search(const FrameView& frame, const InitialOptions& options, const std::string& model) {
  initial_ = options;
  model_ = model;
  begin_search(tracker_, model);
  const int factor = FrameReduction::factor_for(frames_.size());
  if (factor > 1 && !tracker_.tracker().model().detector().empty()) {
    overview_ = std::make_unique<ReducedTracker>(make_, frames_.size(), factor);
    begin_search(*overview_, model);
  }
  track(frame);
}

void TrackRun::track(const FrameView& frame) {
  const auto before = std::chrono::steady_clock::now();
  if (reduces_for_overview(frame)) begin_search(tracker_, where(frame));
  const Status status = tracker_.update(frame);
  if (frames_.is_live() && status == Status::stale_frame)
    return;  // cameras deliver a frame twice now and then
  require(status, is_of_tables(status) ? model_ + ": learnt tables" : where(frame));
  if (reduces(tracker_)) {
    begin_search(tracker_, where(frame));
    require(tracker_.update(frame), where(frame));
  }
  const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - before;
  if (tracker_.tracker().is_started())
    add(frame, elapsed.count());
  else
    output_.add_lost(frames_, frame);
}

bool TrackRun::reduces(const ReducedTracker& started) {
  if (is_chosen_ || !started.tracker().is_started()) return false;
  is_chosen_ = true;
  const Model& model = started.tracker().model();
  // The scale at which templates fail was measured on faces, in millimetres.
  if (model.find_landmark("ibug36") == kNone || model.find_landmark("ibug45") == kNone) return false;
  const int factor = FrameReduction::factor_for(started.px_per_mm(), frames_.size());
  if (factor == 1) return false;
  err_ << frames_.name() << ": the face is large: tracked in frames reduced to 1/" << factor << "\n";
  tracker_ = ReducedTracker(make_, frames_.size(), factor);
  return true;
}

bool TrackRun::reduces_for_overview(const FrameView& frame) {
  if (is_chosen_) overview_ = nullptr;
  return overview_ != nullptr && overview_->update(frame) == Status::ok && reduces(*overview_);
}

void TrackRun::add(const FrameView& frame, double milliseconds) {
  focal_px_ = tracker_.focal_px();
  output_.add(frames_, frame, tracker_, milliseconds);
}

}  // namespace pliant::host
