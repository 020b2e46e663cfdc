#include "track/detection_state.hpp"

#include "base/arrays.hpp"
#include "track/tracker_parts.hpp"

namespace pliant {

void DetectionState::lay_out(Arena& arena, const DetectionCalls* of, const Model& model,
                             const TrackerLimits& limits) {
  calls = of;
  kept.lay_out(arena, model);
  markers = arena.take<MarkerPlace>(limits.markers);
}

void DetectionState::begin_search(TrackerParts& t, const StartOptions& start, const TrackerOptions& options) {
  if (t.is_started) keep_parameters(t);
  t.end_track();
  kept.keep(start);
  kept.keep(options);
}

Status DetectionState::start(TrackerParts& t, const FrameView& frame, const StartPose& found,
                             const TrackerOptions& options) {
  restore_markers = [](TrackerParts& of) {
    of.markers.restore(of.estimator, of.detection->markers, of.detection->marker_count);
  };
  t.budget.forget_waiting();  // what is left of a track before
  const Status status = t.start(frame, found, options, {});
  restore_markers = nullptr;
  return status;
}

bool DetectionState::keep_start_of_caller(const TrackerOptions& options) {
  if (is_own_start()) return false;
  kept.keep(*of_caller);
  kept.keep(options);
  return true;
}

void DetectionState::keep_parameters(TrackerParts& t) {
  copy(t.estimator.parameters().data, t.start_q.count, t.start_q.data);
}

void DetectionState::give_up(TrackerParts& t) {
  keep_parameters(t);
  t.end_track();
}

}  // namespace pliant
