// The starts of a tracker. A start's fit and the tracking use the same block, one after the other.
#include <new>

#include "pliant/tracker.hpp"
#include "track/landmark_fit.hpp"
#include "track/surface_offset.hpp"

namespace pliant {

namespace {

/// What a start from landmarks takes of the block.
struct FitMemory {
  Span<Correspondence> points;
  LandmarkFit* fit;

  FitMemory(Arena& arena, std::size_t count)
      : points(arena.take_span<Correspondence>(count)), fit(arena.take<LandmarkFit>(1)) {}
};

bool is_at(const Landmark& landmark, Vec2 uv) {
  return landmark.u == uv.x && landmark.v == uv.y;
}

}  // namespace

/// Noinline: the fit that is laid out for measuring is on the stack here, and nowhere else.
[[gnu::noinline]] static std::size_t fit_bytes(const Model& model, std::size_t points) {
  if (points == 0) return 0;
  Arena trial;
  FitMemory memory(trial, points);
  LandmarkFit measured;
  measured.lay_out(trial, model, points);
  return trial.used_bytes();
}

void Tracker::lay_out(Arena& arena, const Model& model, const TrackerLimits& limits) {
  limits_ = limits;
  if (limits_.key_frames > TrackerLimits::kMostKeyFrames) limits_.key_frames = TrackerLimits::kMostKeyFrames;
  started_ = false;
  arena.count_as(Purpose::state);
  start_q_ = arena.take<float>(model.parameters().count);
  landmark_offsets_ = arena.take<Vec3>(model.landmarks().count);
  block_ = arena.take<unsigned char>(0);
  const std::size_t before = arena.used_bytes(), fit = fit_bytes(model, limits_.start_points);
  lay_out_tracking(arena, model);
  block_bytes_ = arena.used_bytes() - before;
  arena.count_as(Purpose::solver);
  if (fit > block_bytes_) {
    arena.take<unsigned char>(fit - block_bytes_);
    block_bytes_ = fit;
  }
}

void Tracker::clear_offsets() {
  for (std::size_t k = 0; k < model().landmarks().count; ++k) landmark_offsets_[k] = {};
}

Status Tracker::check_start(const FrameView& frame, Span<const Vec2> markers) const {
  const Status status = check_frame(frame);
  if (status != Status::ok) return status;
  return markers.count <= limits_.markers ? Status::ok : Status::capacity;
}

Status Tracker::check_landmarks(Span<const NamedPoint> points) const {
  if (points.count > 0 && points.data == nullptr) return Status::bad_argument;
  for (const NamedPoint& p : points) {
    if (p.name == nullptr || model().find_landmark(p.name) == kNone) return Status::not_found;
    if (!is_finite(p.x)) return Status::bad_argument;
  }
  return Status::ok;
}

Status Tracker::start_from_landmarks(const FrameView& frame, Span<const NamedPoint> points,
                                     const StartOptions& start, const TrackerOptions& options,
                                     Span<const Vec2> markers) {
  Status status = check_start(frame, markers);
  if (status == Status::ok && points.count > limits_.start_points) status = Status::capacity;
  if (status == Status::ok && points.count < kLandmarkFitTuning.least_points) status = Status::too_few_points;
  if (status == Status::ok) status = check_landmarks(points);
  if (status == Status::ok && !(start.focal_px >= 0)) status = Status::bad_argument;
  if (status != Status::ok) return status;
  Camera camera;
  Pose pose;
  status = fit_to_landmarks(points, start, &camera, &pose);
  if (status == Status::ok) status = start_tracking(frame, camera, pose, start_q_, options, markers);
  if (status != Status::ok) return status;
  // The fit left image positions. Offsets are of the surface that is tracked, which may be a personalised one.
  const Span<const Landmark> landmarks = model().landmarks();
  for (std::size_t k = 0; k < landmarks.count; ++k) {
    Vec3& offset = landmark_offsets_[k];
    if (offset.z == 0) continue;
    const Vec2 x{offset.x, offset.y};
    offset = {};
    find_offset(estimator_.view(), estimator_.lens(),
                estimator_.surface_point({landmarks[k].u, landmarks[k].v}), x, &offset);
  }
  return status;
}

/// Fits `start_q_`, camera and pose to the points. Leaves where the person has landmarks in `landmark_offsets_`: x, y (px)
/// and 1; all 0 where the model's own place is as good. What was tracked before is gone.
Status Tracker::fit_to_landmarks(Span<const NamedPoint> points, const StartOptions& start, Camera* camera,
                                 Pose* pose) {
  started_ = false;
  const Model model = estimator_.model();
  for (std::size_t k = 0; k < model.parameters().count; ++k) start_q_[k] = 0;
  clear_offsets();

  Arena arena(block_, block_bytes_);
  const FitMemory memory(arena, points.count);
  PLIANT_ASSERT(!arena.exhausted());
  LandmarkFit& fit = *new (memory.fit) LandmarkFit();
  Status status = create_in(arena, fit, model, points.count);
  if (status != Status::ok) return status;
  for (std::size_t k = 0; k < points.count; ++k) {
    const Landmark& l = model.landmarks()[model.find_landmark(points[k].name)];
    memory.points[k] = {{l.u, l.v}, points[k].x, 1, is_silhouette_landmark(l.name)};
  }
  FitOptions options;
  options.width = limits_.width;
  options.height = limits_.height;
  options.focal_px = start.focal_px;
  options.camera = start.camera;
  status = fit.fit(memory.points, options, start_q_);
  if (status == Status::ok) {
    *camera = start.camera != nullptr ? *start.camera : camera_of(fit.report().view);
    *pose = pose_of(fit.report().view);
    if (start.keeps_landmark_offsets)
      for (const Correspondence& c : fit.personal_landmarks(memory.points))
        for (std::size_t k = 0; k < model.landmarks().count; ++k)
          if (is_at(model.landmarks()[k], c.uv)) landmark_offsets_[k] = {c.x.x, c.x.y, 1};
  }
  Arena again(block_, block_bytes_);
  lay_out_tracking(again, model);
  return status;
}

Status Tracker::start_from_box(const FrameView& frame, Vec2 corner, Vec2 size, const StartOptions& start,
                               const TrackerOptions& options, Span<const Vec2> markers) {
  Status status = check_start(frame, markers);
  if (status == Status::ok && !(start.focal_px >= 0 && size.x > 0 && size.y > 0))
    status = Status::bad_argument;
  if (status != Status::ok) return status;
  started_ = false;
  const Model model = estimator_.model();
  for (std::size_t k = 0; k < model.parameters().count; ++k) start_q_[k] = 0;
  const Camera camera = start_camera(start.camera, start.focal_px, frame.width, frame.height);
  View view;
  {
    Arena arena(block_, block_bytes_);
    Cascade cascade;
    status = create_in(arena, cascade, model);
    if (status == Status::ok) status = view_from_box(model, cascade, start_q_, corner, size, camera, &view);
    Arena again(block_, block_bytes_);
    lay_out_tracking(again, model);
  }
  if (status != Status::ok) return status;
  clear_offsets();
  return start_tracking(frame, camera, pose_of(view), start_q_, options, markers);
}

bool Tracker::fits_model(const SavedState& state) const {
  const Span<float> q = state.parameters;
  const Span<Vec3> offsets = state.landmark_offsets;
  return q.count == model().parameters().count && q.data != nullptr &&
         (offsets.empty() || (offsets.count == model().landmarks().count && offsets.data != nullptr));
}

Status Tracker::start_from_state(const FrameView& frame, const SavedState& state,
                                 const TrackerOptions& options, Span<const Vec2> markers) {
  if (!fits_model(state)) return Status::bad_argument;
  for (const Vec3& offset : state.landmark_offsets)
    if (!is_finite(offset)) return Status::bad_argument;
  const Status status =
      start_from_pose(frame, state.camera, state.pose, state.parameters.data, options, markers);
  if (status != Status::ok) return status;
  for (std::size_t k = 0; k < state.landmark_offsets.count; ++k)
    landmark_offsets_[k] = state.landmark_offsets[k];
  return status;
}

Status Tracker::save(SavedState* state) const {
  if (!started_) return Status::not_started;
  if (state == nullptr || !fits_model(*state)) return Status::bad_argument;
  state->camera = camera();
  state->pose = result_.pose;
  const Span<const float> q = estimator_.parameters();
  for (std::size_t k = 0; k < q.count; ++k) state->parameters[k] = q[k];
  for (std::size_t k = 0; k < state->landmark_offsets.count; ++k)
    state->landmark_offsets[k] = landmark_offsets_[k];
  return Status::ok;
}

Status Tracker::parameter(const char* name, float* value) const {
  if (!started_) return Status::not_started;
  const std::uint16_t k = name == nullptr ? kNone : model().find_parameter(name);
  if (k == kNone || value == nullptr) return Status::not_found;
  *value = estimator_.parameters()[k];
  return Status::ok;
}

Status Tracker::landmark(const char* name, Vec2* x) {
  const std::uint16_t k = name == nullptr || !started_ ? kNone : model().find_landmark(name);
  return started_ && k == kNone ? Status::not_found : landmark(k, x);
}

Status Tracker::landmark(std::size_t index, Vec2* x) {
  if (!started_) return Status::not_started;
  if (index >= model().landmarks().count) return Status::not_found;
  const Landmark& l = model().landmarks()[index];
  return project_beside(estimator_, {l.u, l.v}, landmark_offsets_[index], x) ? Status::ok
                                                                             : Status::underdetermined;
}

Status Tracker::place_landmarks(Span<const NamedPoint> points) {
  if (!started_) return Status::not_started;
  const Status status = check_landmarks(points);
  if (status != Status::ok) return status;
  for (const NamedPoint& p : points) {
    const Span<const Landmark> landmarks = model().landmarks();
    const Landmark& named = landmarks[model().find_landmark(p.name)];
    const Vec3 surface = estimator_.surface_point({named.u, named.v});
    for (std::size_t k = 0; k < landmarks.count; ++k)
      if (is_at(landmarks[k], {named.u, named.v}))
        find_offset(estimator_.view(), estimator_.lens(), surface, p.x, &landmark_offsets_[k]);
  }
  return Status::ok;
}

}  // namespace pliant
