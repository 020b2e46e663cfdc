// The starts of a tracker by its caller.
#include "base/arrays.hpp"
#include "estimate/track_monitor.hpp"
#include "track/landmark_fit.hpp"
#include "track/second_look.hpp"
#include "track/template_tuning.hpp"
#include "track/tracker_parts.hpp"
#include "track/tracker_sizes.hpp"

namespace pliant {

namespace {

constexpr TrackerLimits with_templates(std::uint16_t patches) {
  TrackerLimits limits = profile_s();
  limits.patches = patches;
  return limits;
}
static_assert(is_usable(with_templates(kTrackMonitorTuning.least_inliers)) &&
                  !is_usable(with_templates(kTrackMonitorTuning.least_inliers - 1)),
              "templates of frame 0 can be enough for a tracked frame");

/// Whether an image position, or the size of a box, is a number and not far outside every picture.
bool is_near(Vec2 x) {
  return magnitude(x.x) <= kFarthestPx && magnitude(x.y) <= kFarthestPx;
}

/// Whether an offset is no longer than a pose's may be (is_possible, camera.hpp), mm. Not so for NaN.
bool is_near(const Vec3& offset) {
  return dot(offset, offset) <= kLargestFocalPx * kLargestFocalPx;
}

/// Whether a focal length is 0, unknown, or one that a camera can have (is_possible, camera.hpp), px.
bool is_focal_length(float px) {
  return px >= 0 && px <= kLargestFocalPx;
}

/// Whether a search can be made with the camera, or the focal length, of a start.
bool has_camera(const StartOptions& start, const TrackerLimits& limits) {
  const Camera camera = start_camera(start.camera, start.focal_px, limits.width, limits.height);
  Lens unused;
  return is_focal_length(start.focal_px) &&
         Lens::make(camera, limits.width, limits.height, &unused) == Status::ok;
}

/// The same options with a copy of the camera: that of the track which ends is in memory that the start uses.
StartOptions with_copy(const StartOptions& start, Camera* camera) {
  StartOptions copy = start;
  if (start.camera == nullptr) return copy;
  *camera = *start.camera;
  copy.camera = camera;
  return copy;
}

}  // namespace

Status TrackerParts::check_start(const FrameView& view, const TrackerOptions& options,
                                 Span<const Vec2> marker_places) const {
  Status status = region.check_frame(view);
  if (status == Status::ok) status = check(options);
  if (status != Status::ok) return status;
  if (marker_places.count > limits.markers) return Status::capacity;
  if (marker_places.count > 0 && marker_places.data == nullptr) return Status::bad_argument;
  for (Vec2 x : marker_places)
    if (!is_near(x)) return Status::bad_argument;
  return Status::ok;
}

Status TrackerParts::check_landmarks(Span<const NamedPoint> points) const {
  if (points.count > 0 && points.data == nullptr) return Status::bad_argument;
  for (const NamedPoint& p : points) {
    if (p.name == nullptr || !is_near(p.x)) return Status::bad_argument;
    if (model().find_landmark(p.name) == kNone) return Status::not_found;
  }
  return Status::ok;
}

bool TrackerParts::fits_model(const SavedState& state) const {
  const auto has = [](const auto& array, std::size_t count) {
    return array.count == count && (count == 0 || array.data != nullptr);
  };
  const std::size_t landmarks = state.landmark_offsets.empty() ? 0 : offsets.values().count;
  return has(state.parameters, start_q.count) && has(state.landmark_offsets, landmarks);
}

void TrackerParts::end_track() {
  is_started = false;
  progress.rest = nullptr;
  result = {};
  result.is_searching = detection != nullptr;
}

void TrackerParts::begin_stream() {
  order.forget_time();
  budget = {};
  if (noise != nullptr) noise->forget();
}

/// Runs `fit(arena)` in the memory of the tracking, which is laid out anew afterwards.
template <class Fit>
Status TrackerParts::fit_before_tracking(Fit&& fit) {
  end_track();
  Arena before(block.bytes.data, block.bytes.count);
  const Status status = fit(before);
  lay_out_tracking();
  return status;
}

/// What a start leaves to detection, if there are tables for it.
void TrackerParts::refine(const FrameView& view, const RoughStart& rough, StartPose* from) {
  if (detection != nullptr) detection->calls->refine(*this, view, rough, from);
}

/// The rest of the caller's starts. A fit that fails has overwritten what was known of the person, too.
Status TrackerParts::start_at_fit(Status fitted, const FrameView& frame_0, const RoughStart& rough,
                                  StartPose* from, const TrackerOptions& with,
                                  Span<const Vec2> marker_places) {
  begin_stream();
  const FrameView& view = quiet(frame_0);
  const bool is_fitted = fitted == Status::ok;
  refine(view, is_fitted ? rough : RoughStart{nullptr, RoughStart::kExact, rough.options}, from);
  if (is_fitted) fitted = start(view, *from, with, marker_places);
  if (fitted == Status::ok) return fitted;
  offsets.clear();
  // The search that follows is as the caller said, unless the camera, or the pose, is none.
  if (detection != nullptr && fitted != Status::bad_argument) detection->keep_start_of_caller(with);
  return fitted;
}

/// Frame 0, of checked arguments, with the parameters of start_q.
Status TrackerParts::start(const FrameView& view, const StartPose& from, const TrackerOptions& with,
                           Span<const Vec2> marker_places) {
  end_track();
  if (block.is_of_search) detection->calls->end_search(*this);
  EstimatorOptions of_estimator = with.estimator;
  of_estimator.time_ns = view.time_ns;
  if (texture != nullptr) (texture->*limits.surface_texture->start)(&of_estimator);
  Status status = estimator.start(from.camera, view.width, view.height, from.pose, start_q.data, with.is_free,
                                  of_estimator);
  progress.uses_edges = edges != nullptr && with.estimator.uses(Cue::edge);
  if (status == Status::ok) status = capture_frame_0(view, marker_places, with.marker_exclusion_px);
  if (status != Status::ok) return status;
  smooths = with.estimator.smooths;
  if (smooths) result.smoothed_pose = result.pose;
  order.note(view);
  progress.frame = progress.last_kept = 0;
  progress.bad_frames = 0;
  budget.costs = estimator.work_costs(limits.patch_window);
  budget.most = most_frame_work(limits, budget.costs, spring_rows(model(), limits));
  matcher.start(limits.keeps_previous && with.estimator.uses(Cue::flow));
  is_started = true;
  ++numbers.track;
  if (detection == nullptr || !detection->is_own_start()) {
    ++numbers.person;
    keeps_landmark_offsets = with.keeps_landmark_offsets;
  }
  if (keeps_landmark_offsets)
    offsets.place_pending(estimator);
  else
    offsets.clear();
  if (person != nullptr) limits.person->start(*this, with);
  if (detection != nullptr) detection->calls->begin_track(*this, view, with);
  return Status::ok;
}

/// Templates, edges and thumbnail of frame 0.
Status TrackerParts::capture_frame_0(const FrameView& view, Span<const Vec2> marker_places,
                                     float marker_exclusion_px) {
  Status status = Status::ok;
  if (first_templates == 0) {
    status = region.build(view, region.is_whole_frame() ? Vec2{} : key_frames.middle_of(estimator));
    if (status != Status::ok) return status;
    key_frames.take(view);
  }
  if (texture != nullptr) (texture->*limits.surface_texture->note)(estimator, region, 0);
  estimator.begin(view.time_ns);
  status = markers.place(estimator, marker_places, marker_exclusion_px);
  if (status != Status::ok) return status;
  // Markers come first: templates keep away from them.
  if (detection != nullptr && detection->is_own_start()) detection->restore_markers(*this);
  templates.clear();
  key_frames.clear();
  placement.place(templates, estimator, region, markers, 0,
                  first_templates > 0 ? first_templates : limits.patches);
  const auto captured = static_cast<std::uint16_t>(templates.count_first(limits.patches));
  std::size_t points = captured;
  if (progress.uses_edges) points += limits.edges->start(*this, captured);
  if (captured < kTrackerTuning.least_templates || points < kTrackMonitorTuning.least_inliers)
    return Status::too_few_points;
  result = {TrackState::tracking,
            pose_of(estimator.view()),
            captured,
            captured,
            0,
            0,
            static_cast<std::uint16_t>(estimator.mesh().vertex_count())};
  key_frames.trust(estimator);
  key_frames.keep(0, estimator.view(), 0, 0);
  return Status::ok;
}

Status Tracker::start_from_pose(const FrameView& frame, const Camera& camera, const Pose& pose,
                                const float* q, const TrackerOptions& options, Span<const Vec2> markers) {
  if (impl_ == nullptr) return Status::not_started;
  const Status status = impl_->check_start(frame, options, markers);
  if (status != Status::ok) return status;
  if (q != nullptr && !are_finite(q, impl_->start_q.count)) return Status::bad_argument;
  impl_->offsets.clear();
  for (std::size_t k = 0; k < impl_->start_q.count; ++k) impl_->start_q[k] = q == nullptr ? 0 : q[k];
  StartPose from{camera, pose};
  StartOptions known;
  known.camera = &camera;
  impl_->given = {q != nullptr, false};
  return impl_->start_at_fit(Status::ok, frame, {nullptr, RoughStart::kExact, known}, &from, options,
                             markers);
}

Status Tracker::start_from_landmarks(const FrameView& frame, Span<const NamedPoint> points,
                                     const StartOptions& start, const TrackerOptions& options,
                                     Span<const Vec2> markers) {
  if (impl_ == nullptr) return Status::not_started;
  Impl& t = *impl_;
  Status status = t.check_start(frame, options, markers);
  if (status == Status::ok && points.count > t.limits.start_points) status = Status::capacity;
  if (status == Status::ok && points.count < kLeastFitPoints) status = Status::too_few_points;
  if (status == Status::ok) status = t.check_landmarks(points);
  if (status == Status::ok && !is_focal_length(start.focal_px)) status = Status::bad_argument;
  if (status != Status::ok) return status;
  FitOptions fit;
  fit.width = frame.width;
  fit.height = frame.height;
  fit.focal_px = start.focal_px;
  StartPose found;
  const StartOptions known = with_copy(start, &found.camera);
  fit.camera = known.camera;
  t.offsets.clear();
  t.given = {};
  status = t.fit_before_tracking([&](Arena& arena) {
    // First, so that no other fault hides it: the search that follows would be made with this camera.
    if (!has_camera(known, t.limits)) return Status::bad_argument;
    return fit_to_landmarks(arena, t.model(), points, t.limits.samples_vertices, fit, t.start_q.data, &found,
                            &t.offsets);
  });
  return t.start_at_fit(status, frame, {nullptr, points.count, known}, &found, options, markers);
}

Status Tracker::start_from_box(const FrameView& frame, Vec2 corner, Vec2 size, const StartOptions& start,
                               const TrackerOptions& options, Span<const Vec2> markers) {
  if (impl_ == nullptr) return Status::not_started;
  Impl& t = *impl_;
  Status status = t.check_start(frame, options, markers);
  if (status == Status::ok && !(is_focal_length(start.focal_px) && size.x > 0 && size.y > 0 &&
                                is_near(corner) && is_near(size) && start.box <= BoxConvention::face_box))
    status = Status::bad_argument;
  if (status != Status::ok) return status;
  t.offsets.clear();
  t.given = {};
  for (float& value : t.start_q) value = 0;
  StartPose found;
  const StartOptions known = with_copy(start, &found.camera);
  found.camera = start_camera(known.camera, start.focal_px, frame.width, frame.height);
  FaceBox box;
  status = t.fit_before_tracking([&](Arena& arena) {
    Cascade* const cascade = arena.make<Cascade>();
    if (cascade == nullptr) return Status::out_of_memory;
    const Status created = create_in(arena, *cascade, t.model());
    if (created != Status::ok) return created;
    return fit_to_box(*cascade, {corner, size, start.box}, frame.width, frame.height, t.start_q.data, &found,
                      &box);
  });
  return t.start_at_fit(status, frame, {&box, 0, known}, &found, options, markers);
}

Status Tracker::start_by_detection(const StartOptions& start, const TrackerOptions& options) {
  if (impl_ == nullptr) return Status::not_started;
  Impl& t = *impl_;
  if (t.detection == nullptr) return Status::not_found;
  if (!has_camera(start, t.limits) || check(options) != Status::ok) return Status::bad_argument;
  t.detection->calls->begin_search(t, start, options);
  t.begin_stream();
  t.given = {};
  return Status::ok;
}

Status Tracker::start_from_state(const FrameView& frame, const SavedState& state,
                                 const TrackerOptions& options, Span<const Vec2> markers) {
  if (impl_ == nullptr) return Status::not_started;
  if (!impl_->fits_model(state)) return Status::bad_argument;
  for (const Vec3& offset : state.landmark_offsets)
    if (!is_near(offset)) return Status::bad_argument;
  const Status status =
      start_from_pose(frame, state.camera, state.pose, state.parameters.data, options, markers);
  if (status != Status::ok) return status;
  if (options.keeps_landmark_offsets && !state.landmark_offsets.empty())
    impl_->offsets.set(state.landmark_offsets);
  if (!is_started() || impl_->detection == nullptr || impl_->detection->look == nullptr) return Status::ok;
  impl_->limits.second_look->resume(*impl_, impl_->quiet(frame));
  return is_started() ? Status::ok : Status::too_few_points;
}

Status Tracker::save(SavedState* state) const {
  if (!is_started()) return Status::not_started;
  if (state == nullptr || !impl_->fits_model(*state)) return Status::bad_argument;
  state->camera = camera();
  state->pose = impl_->result.pose;
  copy(parameters().data, state->parameters.count, state->parameters.data);
  copy(impl_->offsets.values().data, state->landmark_offsets.count, state->landmark_offsets.data);
  return Status::ok;
}

}  // namespace pliant
