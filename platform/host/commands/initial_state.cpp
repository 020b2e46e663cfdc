#include "host/commands/initial_state.hpp"

#include <algorithm>

#include "host/io/failure.hpp"

namespace pliant::host {

namespace {

std::vector<pliant::NamedPoint> names_and_places(const std::vector<NamedPoint>& points) {
  std::vector<pliant::NamedPoint> out;
  for (const NamedPoint& p : points) out.push_back({p.name.c_str(), p.x});
  return out;
}

InitialState state_of(const FitFile& fit, const std::string& path, const Model& model, std::ostream& err) {
  InitialState state{fit.camera, fit.pose, std::vector<float>(model.parameters().count, 0.0f)};
  list_unmatched(apply(fit.parameters, path, model, state.q.data()), path, err);
  state.landmarks = person_landmarks(model, fit);
  return state;
}

Status start_from(Tracker& tracker, const FrameView& frame, const InitialState& state, const InitialOptions&,
                  const TrackerOptions& options, Span<const Vec2> markers) {
  const Status status =
      tracker.start_from_pose(frame, state.camera, state.pose, state.q.data(), options, markers);
  if (status != Status::ok || !options.keeps_landmark_offsets) return status;
  const auto landmarks = names_and_places(state.landmarks);
  return tracker.place_landmarks({landmarks.data(), landmarks.size()});
}

Status start_from(Tracker& tracker, const FrameView& frame, const InitialLandmarks& landmarks,
                  const InitialOptions& initial, const TrackerOptions& options, Span<const Vec2> markers) {
  const auto points = names_and_places(landmarks.points);
  const Status status = tracker.start_from_landmarks(frame, {points.data(), points.size()},
                                                     start_options(initial), options, markers);
  if (status == Status::underdetermined) fail_input(landmarks.path, text(status));
  return status;
}

Status start_from(Tracker& tracker, const FrameView& frame, const GivenBox& box,
                  const InitialOptions& initial, const TrackerOptions& options, Span<const Vec2> markers) {
  StartOptions start = start_options(initial);
  start.box = box.convention;
  return tracker.start_from_box(frame, box.corner, box.size, start, options, markers);
}

}  // namespace

StartOptions start_options(const InitialOptions& options) {
  StartOptions start;
  start.focal_px = options.focal_px;
  start.camera = options.camera ? &*options.camera : nullptr;
  return start;
}

Initial read_initial(const std::string& path, const ModelFile& file, const ImageSize& size,
                     const std::string& frames, const InitialOptions& options, std::ostream& err) {
  const std::string text = read_file(path);
  if (!is_fit(text)) {
    const std::vector<NamedPoint> points = parse_points(path, text);
    check_points(file, path, points);
    if (std::none_of(points.begin(), points.end(), [](const NamedPoint& p) { return p.uv.has_value(); }))
      return InitialLandmarks{path, points};
  }
  const FitFile fit = fit_in(path, text, file, size, frames, options.focal_px, options.camera);
  return state_of(fit, path, file.model(), err);
}

Status start_tracker(Tracker& tracker, const FrameView& frame, const Initial& initial,
                     const InitialOptions& options, const TrackerOptions& tracker_options,
                     const std::vector<Vec2>& markers) {
  return std::visit(
      [&](const auto& known) {
        return start_from(tracker, frame, known, options, tracker_options, {markers.data(), markers.size()});
      },
      initial);
}

}  // namespace pliant::host
