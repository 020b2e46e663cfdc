#include "host/commands/track_run.hpp"

#include <chrono>

#include "host/io/failure.hpp"

namespace pliant::host {

namespace {

// What a start is given, in pixels of reduced frames.
InitialOptions reduced(InitialOptions options, const FrameReduction& by) {
  options.focal_px /= static_cast<float>(by.factor());
  if (options.camera) options.camera = by.reduced(*options.camera);
  return options;
}

std::vector<NamedPoint> reduced(std::vector<NamedPoint> points, const FrameReduction& by) {
  for (NamedPoint& p : points) p.x = by.reduced(p.x);
  return points;
}

InitialState reduced(const InitialState& state, const FrameReduction& by) {
  return {by.reduced(state.camera), state.pose, state.q, reduced(state.landmarks, by)};
}

InitialLandmarks reduced(const InitialLandmarks& landmarks, const FrameReduction& by) {
  return {landmarks.path, reduced(landmarks.points, by)};
}

GivenBox reduced(const GivenBox& box, const FrameReduction& by) {
  return {by.reduced(box.corner), (1 / static_cast<float>(by.factor())) * box.size, box.convention};
}

Status start_reduced(Tracker& tracker, const FrameView& frame, const Initial& initial,
                     const InitialOptions& options, const TrackerOptions& tracker_options,
                     std::vector<Vec2> markers, FrameReduction& by) {
  if (by.factor() == 1) return start_tracker(tracker, frame, initial, options, tracker_options, markers);
  for (Vec2& x : markers) x = by.reduced(x);
  const Initial small = std::visit([&](const auto& known) -> Initial { return reduced(known, by); }, initial);
  return start_tracker(tracker, by.reduced(frame), small, reduced(options, by), tracker_options, markers);
}

}  // namespace

void TrackRun::start(const FrameView& frame, const Initial& initial, const InitialOptions& options) {
  FrameReduction overview(FrameReduction::factor_for(frames_.size()));
  const auto start = [&](Tracker& tracker, FrameReduction& by) {
    return start_reduced(tracker, frame, initial, options, options_, markers_.x, by);
  };
  if (overview.factor() > 1) {
    const auto tracker = make_(overview.reduced(frames_.size()));
    if (start(**tracker, overview) == Status::ok) reduces(**tracker, overview);
  }
  require(start(**tracker_, reduction_), where(frame));
  if (reduces(**tracker_, reduction_)) require(start(**tracker_, reduction_), where(frame));
  add(frame, 0);
}

void TrackRun::begin_search(Tracker& tracker, const FrameReduction& by, const std::string& model) const {
  const InitialOptions options = reduced(initial_, by);
  const Status status = tracker.start_by_detection(start_options(options), options_);
  if (status == Status::not_found)
    fail_input(model, "has no learnt tables to find a face with: give --init, or bake it with --learnt");
  require(status, model);
}

void TrackRun::search(const FrameView& frame, const InitialOptions& options, const std::string& model) {
  initial_ = options;
  begin_search(**tracker_, reduction_, model);
  overview_reduction_ = FrameReduction(FrameReduction::factor_for(frames_.size()));
  if (overview_reduction_.factor() > 1 && !(*tracker_)->model().detector().empty()) {
    overview_ = make_(overview_reduction_.reduced(frames_.size()));
    begin_search(**overview_, overview_reduction_, model);
  }
  track(frame);
}

void TrackRun::track(const FrameView& frame) {
  FrameResult result;
  const auto before = std::chrono::steady_clock::now();
  if (reduces_for_overview(frame)) begin_search(**tracker_, reduction_, where(frame));
  const Status status = (*tracker_)->update(reduction_.reduced(frame), &result);
  if (frames_.is_live() && status == Status::stale_frame)
    return;  // cameras deliver a frame twice now and then
  require(status, where(frame));
  if (reduces(**tracker_, reduction_)) {
    begin_search(**tracker_, reduction_, where(frame));
    require((*tracker_)->update(reduction_.reduced(frame), &result), where(frame));
  }
  const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - before;
  if ((*tracker_)->is_started())
    add(frame, elapsed.count());
  else
    output_.add_lost(frames_, frame);
}

bool TrackRun::reduces(Tracker& started, const FrameReduction& by) {
  if (is_chosen_ || !started.is_started()) return false;
  is_chosen_ = true;
  const Model& model = started.model();
  // The scale at which templates fail was measured on faces, in millimetres.
  if (model.find_landmark("ibug36") == kNone || model.find_landmark("ibug45") == kNone) return false;
  const float px_per_mm = static_cast<float>(by.factor()) * started.camera().f / started.result().pose.t.z;
  reduction_ = FrameReduction(FrameReduction::factor_for(px_per_mm, frames_.size()));
  if (reduction_.factor() == 1) return false;
  err_ << frames_.name() << ": the face is large: tracked in frames reduced to 1/" << reduction_.factor()
       << "\n";
  options_.marker_exclusion_px /= static_cast<float>(reduction_.factor());
  tracker_ = make_(reduction_.reduced(frames_.size()));
  return true;
}

bool TrackRun::reduces_for_overview(const FrameView& frame) {
  if (is_chosen_) overview_ = nullptr;
  if (overview_ == nullptr) return false;
  FrameResult result;
  if ((*overview_)->update(overview_reduction_.reduced(frame), &result) != Status::ok) return false;
  return reduces(**overview_, overview_reduction_);
}

void TrackRun::add(const FrameView& frame, double milliseconds) {
  focal_px_ = static_cast<float>(reduction_.factor()) * (*tracker_)->camera().f;
  output_.add(frames_, frame, **tracker_, reduction_, milliseconds);
}

}  // namespace pliant::host
