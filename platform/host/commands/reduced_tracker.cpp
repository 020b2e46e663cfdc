#include "host/commands/reduced_tracker.hpp"

namespace pliant::host {

namespace {

// What a start is given, in pixels of reduced frames.
InitialOptions reduced(InitialOptions options, const FrameReduction& by) {
  options.focal_px /= static_cast<float>(by.factor());
  if (options.camera) options.camera = by.reduced(*options.camera);
  return options;
}

TrackerOptions reduced(TrackerOptions options, const FrameReduction& by) {
  options.marker_exclusion_px /= static_cast<float>(by.factor());
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

std::vector<Vec2> reduced(std::vector<Vec2> places, const FrameReduction& by) {
  for (Vec2& x : places) x = by.reduced(x);
  return places;
}

}  // namespace

Status ReducedTracker::start(const FrameView& frame, const Initial& initial, const InitialOptions& options,
                             const TrackerOptions& tracker_options, const std::vector<Vec2>& markers) {
  const Initial small =
      std::visit([&](const auto& known) -> Initial { return reduced(known, by_); }, initial);
  return start_tracker(tracker(), by_.reduced(frame), small, reduced(options, by_),
                       reduced(tracker_options, by_), reduced(markers, by_));
}

Status ReducedTracker::start_by_detection(const InitialOptions& options,
                                          const TrackerOptions& tracker_options) {
  const InitialOptions small = reduced(options, by_);
  return tracker().start_by_detection(start_options(small), reduced(tracker_options, by_));
}

Status ReducedTracker::update(const FrameView& frame) {
  FrameResult result;
  return tracker().update(by_.reduced(frame), &result);
}

std::optional<Vec2> ReducedTracker::landmark(std::size_t k) {
  Vec2 x;
  if (tracker().landmark(k, &x) != Status::ok) return std::nullopt;
  return by_.whole(x);
}

std::optional<Vec2> ReducedTracker::marker(std::size_t k) {
  Vec2 x;
  if (!tracker().marker(k, &x)) return std::nullopt;
  return by_.whole(x);
}

WireMesh ReducedTracker::mesh() {
  WireMesh mesh = wire_of(tracker().estimator());
  for (Vec2& x : mesh.x) x = by_.whole(x);
  return mesh;
}

}  // namespace pliant::host
