// The C interface: the caller's block holds the handle, then what lasts from start to start, then what the fit and the
// tracker use by turns.
#include <cstdint>
#include <new>

#include "track/landmark_fit.hpp"
#include "pliant/pliant.h"
#include "pliant/tracker.hpp"
#include "track/surface_offset.hpp"

using namespace pliant;

struct pliant_tracker {
  Model model;
  TrackerLimits limits;
  std::uint16_t start_points;
  float* parameters;
  Vec3* landmark_offsets;
  unsigned char* shared;
  std::size_t shared_bytes;
  Camera camera;
  Tracker tracker;
  bool is_started;
};

namespace {

constexpr std::uint16_t kMostStartPoints = 160;

static_assert(sizeof(FrameView) >= sizeof(pliant_frame) - 8 && sizeof(Pose) == sizeof(pliant_pose));
static_assert(static_cast<int>(Status::stale_frame) == PLIANT_STALE_FRAME);
static_assert(static_cast<int>(Status::not_found) == PLIANT_NOT_FOUND);
static_assert(static_cast<int>(Status::misaligned) == PLIANT_MISALIGNED);
static_assert(static_cast<int>(TrackState::lost) == PLIANT_LOST);

pliant_status plain(Status status) {
  return static_cast<pliant_status>(status);
}

/// False for limits that nothing can be made for.
bool read_limits(const pliant_limits& from, TrackerLimits* to) {
  if (from.profile != 'S' && from.profile != 'L') return false;
  *to = from.profile == 'S' ? profile_s() : profile_l();
  to->width = from.width;
  to->height = from.height;
  to->region_width = from.region_width;
  to->region_height = from.region_height;
  to->patches = from.patches;
  to->key_patches = from.key_patches;
  to->vertices = from.vertices;
  const bool has_region = from.region_width != 0 || from.region_height != 0;
  const bool region_fits = from.region_width >= 64 && from.region_height >= 64 &&
                           from.region_width <= from.width && from.region_height <= from.height;
  return from.width >= 64 && from.height >= 64 && (!has_region || region_fits) && from.patches >= 6 &&
         from.start_points >= 4 && from.start_points <= kMostStartPoints;
}

bool is_aligned(const void* memory) {
  return memory != nullptr && reinterpret_cast<std::uintptr_t>(memory) % Arena::kAlignment == 0;
}

std::size_t larger(std::size_t a, std::size_t b) {
  return a > b ? a : b;
}

constexpr std::size_t kScratchBytes = PLIANT_SCRATCH_BYTES;
static_assert(sizeof(Tracker) <= kScratchBytes && sizeof(Fitter) <= kScratchBytes);

/// What the larger of fit, with the points before it, and tracker takes. Each is made in `scratch` to be measured: they are
/// too large for a stack.
std::size_t measure_shared(void* scratch, const Model& model, const TrackerLimits& limits,
                           std::uint16_t start_points) {
  Arena trial;
  (new (scratch) Tracker())->lay_out(trial, model, limits);
  Arena points;
  points.take<Correspondence>(start_points);
  return larger(trial.used_bytes(), points.used_bytes() + Arena::kAlignment +
                                        landmark_fit_bytes(model, start_points, *new (scratch) Fitter()));
}

/// The handle's own parts, and room that fit and tracker use by turns.
void lay_out(Arena& arena, pliant_tracker* handle, const Model& model, std::size_t shared_bytes) {
  arena.take<unsigned char>(sizeof(pliant_tracker));
  float* const parameters = arena.take<float>(model.parameters().count);
  Vec3* const landmark_offsets = arena.take<Vec3>(model.landmarks().count);
  unsigned char* const shared = arena.take<unsigned char>(shared_bytes);
  if (handle == nullptr || arena.exhausted()) return;
  handle->parameters = parameters;
  handle->landmark_offsets = landmark_offsets;
  handle->shared = shared;
  handle->shared_bytes = shared_bytes;
}

/// What creating and asking for the size have in common.
Status read(const void* table, std::size_t table_bytes, const pliant_limits* from, Model* model,
            TrackerLimits* limits) {
  if (from == nullptr || !read_limits(*from, limits)) return Status::bad_argument;
  return Model::open(table, table_bytes, model);
}

FrameView view_of(const pliant_frame& f) {
  return {f.pixels, f.width, f.height, f.stride_bytes, f.pixel_step_bytes, f.time_ns, f.sequence};
}

/// A start's frame, before anything is fitted to it.
Status check(const pliant_tracker* t, const pliant_frame* frame) {
  if (t == nullptr || frame == nullptr) return Status::bad_argument;
  const Status status = check(view_of(*frame));
  if (status != Status::ok) return status;
  return frame->width == t->limits.width && frame->height == t->limits.height ? Status::ok
                                                                              : Status::size_mismatch;
}

/// Lays the tracker out anew, over whatever was there, and starts it with the handle's parameters.
Status start(pliant_tracker* t, const pliant_frame& frame, const Camera& camera, const Pose& pose) {
  Arena arena(t->shared, t->shared_bytes);
  Status status = create_in(arena, t->tracker, t->model, t->limits);
  if (status == Status::ok) status = t->tracker.start(view_of(frame), camera, pose, t->parameters, {}, {});
  t->camera = camera;
  t->is_started = status == Status::ok;
  return status;
}

/// The same, with the landmarks where the model has them.
Status start_as_model(pliant_tracker* t, const pliant_frame& frame, const Camera& camera, const Pose& pose) {
  for (std::size_t k = 0; k < t->model.landmarks().count; ++k) t->landmark_offsets[k] = {};
  return start(t, frame, camera, pose);
}

/// iBUG's points 00 to 16 run along the jaw, where the face ends in the picture.
bool is_silhouette(const char* name) {
  for (int k = 0; k < 4; ++k)
    if (name[k] != "ibug"[k]) return false;
  return name[4] == '0' || (name[4] == '1' && name[5] <= '6');
}

float focal_or_default(const pliant_tracker* t, float focal_px) {
  const int side = t->limits.width > t->limits.height ? t->limits.width : t->limits.height;
  return focal_px > 0 ? focal_px : FitOptions{}.default_focal_ratio * static_cast<float>(side);
}

void fill(pliant_tracker* t, const FrameResult& from, pliant_result* to) {
  const Pose& p = from.pose;
  *to = {{{p.q.w, p.q.x, p.q.y, p.q.z}, {p.t.x, p.t.y, p.t.z}},
         {t->camera.f, t->camera.cx, t->camera.cy},
         from.rms_px,
         from.tracked,
         from.inliers,
         static_cast<std::int32_t>(from.state)};
}

}  // namespace

#define PLIANT_TEXT(x) #x
#define PLIANT_VERSION_TEXT(a, b, c) PLIANT_TEXT(a) "." PLIANT_TEXT(b) "." PLIANT_TEXT(c)

const char* pliant_version(void) {
  return PLIANT_VERSION_TEXT(PLIANT_VERSION_MAJOR, PLIANT_VERSION_MINOR, PLIANT_VERSION_PATCH);
}

const char* pliant_status_text(pliant_status status) {
  return text(status < 0 || status > 255 ? Status{255} : static_cast<Status>(status));
}

pliant_limits pliant_profile(char name) {
  if (name != 'S' && name != 'L') return {};
  const TrackerLimits l = name == 'S' ? profile_s() : profile_l();
  return {l.width,         l.height,  l.region_width,
          l.region_height, l.patches, l.key_patches,
          l.vertices,      68,        static_cast<std::uint16_t>(name)};
}

pliant_status pliant_required_bytes(void* scratch, size_t scratch_bytes, const void* table,
                                    size_t table_bytes, const pliant_limits* limits, size_t* bytes) {
  if (bytes == nullptr || !is_aligned(scratch)) return PLIANT_BAD_ARGUMENT;
  if (scratch_bytes < kScratchBytes) return PLIANT_OUT_OF_MEMORY;
  Model model;
  TrackerLimits own;
  const Status status = read(table, table_bytes, limits, &model, &own);
  if (status != Status::ok) return plain(status);
  Arena trial;
  lay_out(trial, nullptr, model, measure_shared(scratch, model, own, limits->start_points));
  *bytes = trial.used_bytes();
  return PLIANT_OK;
}

pliant_status pliant_create(void* memory, size_t bytes, const void* table, size_t table_bytes,
                            const pliant_limits* limits, pliant_tracker** tracker) {
  if (!is_aligned(memory) || tracker == nullptr) return PLIANT_BAD_ARGUMENT;
  Model model;
  TrackerLimits own;
  const Status status = read(table, table_bytes, limits, &model, &own);
  if (status != Status::ok) return plain(status);
  if (bytes < sizeof(pliant_tracker)) return PLIANT_OUT_OF_MEMORY;
  const std::size_t shared_bytes = measure_shared(memory, model, own, limits->start_points);
  auto* const handle = new (memory) pliant_tracker();
  handle->model = model;
  handle->limits = own;
  handle->start_points = limits->start_points;
  Arena arena(memory, bytes);
  lay_out(arena, handle, model, shared_bytes);
  if (arena.exhausted()) return PLIANT_OUT_OF_MEMORY;
  *tracker = handle;
  return PLIANT_OK;
}

pliant_status pliant_start_pose(pliant_tracker* t, const pliant_frame* frame, const pliant_camera* camera,
                                const pliant_pose* pose, const float* parameters) {
  const Status status = check(t, frame);
  if (status != Status::ok) return plain(status);
  if (camera == nullptr || pose == nullptr) return PLIANT_BAD_ARGUMENT;
  for (std::size_t k = 0; k < t->model.parameters().count; ++k)
    t->parameters[k] = parameters == nullptr ? 0 : parameters[k];
  return plain(start_as_model(
      t, *frame, {camera->f, camera->cx, camera->cy},
      {{pose->q[0], pose->q[1], pose->q[2], pose->q[3]}, {pose->t[0], pose->t[1], pose->t[2]}}));
}

pliant_status pliant_start_points(pliant_tracker* t, const pliant_frame* frame, float focal_px,
                                  const pliant_point* points, size_t count) {
  Status status = check(t, frame);
  if (status != Status::ok) return plain(status);
  if (points == nullptr || !(focal_px >= 0)) return PLIANT_BAD_ARGUMENT;
  if (count > t->start_points) return PLIANT_CAPACITY;
  if (count < 4) return PLIANT_TOO_FEW_POINTS;
  const auto index_of = [t](const pliant_point& p) {
    return p.landmark == nullptr ? kNone : t->model.find_landmark(p.landmark);
  };
  for (std::size_t k = 0; k < count; ++k)
    if (index_of(points[k]) == kNone) return PLIANT_NOT_FOUND;
  t->is_started = false;  // the fit takes the tracker's memory
  Arena arena(t->shared, t->shared_bytes);
  const auto given = arena.take_span<Correspondence>(count);
  for (std::size_t k = 0; k < count; ++k) {
    const Landmark& l = t->model.landmarks()[index_of(points[k])];
    given[k] = {{l.u, l.v}, {points[k].x, points[k].y}, 1, is_silhouette(l.name)};
  }
  FitOptions options;
  options.width = frame->width;
  options.height = frame->height;
  options.focal_px = focal_px;
  FitReport report;
  status = fit_landmarks(arena, t->model, given, options, t->parameters, &report, t->landmark_offsets);
  if (status == Status::ok) status = start(t, *frame, camera_of(report.view), pose_of(report.view));
  return plain(status);
}

pliant_status pliant_start_box(pliant_tracker* t, const pliant_frame* frame, float focal_px, float x, float y,
                               float width, float height) {
  Status status = check(t, frame);
  if (status != Status::ok) return plain(status);
  if (!(focal_px >= 0)) return PLIANT_BAD_ARGUMENT;
  t->is_started = false;
  Arena arena(t->shared, t->shared_bytes);
  Cascade cascade;
  status = create_in(arena, cascade, t->model);
  if (status != Status::ok) return plain(status);
  for (std::size_t k = 0; k < t->model.parameters().count; ++k) t->parameters[k] = 0;
  const Camera camera = centred_camera(frame->width, frame->height, focal_or_default(t, focal_px));
  View view;
  status = view_from_box(t->model, cascade, t->parameters, {x, y}, {width, height}, camera, &view);
  if (status == Status::ok) status = start_as_model(t, *frame, camera, pose_of(view));
  return plain(status);
}

pliant_status pliant_update(pliant_tracker* t, const pliant_frame* frame, pliant_result* result) {
  if (t == nullptr || frame == nullptr || result == nullptr) return PLIANT_BAD_ARGUMENT;
  if (!t->is_started) return PLIANT_NOT_STARTED;
  FrameResult found;
  const Status status = t->tracker.update(view_of(*frame), &found);
  if (status == Status::ok) fill(t, found, result);
  return plain(status);
}

pliant_status pliant_get_result(pliant_tracker* t, pliant_result* result) {
  if (t == nullptr || result == nullptr) return PLIANT_BAD_ARGUMENT;
  if (!t->is_started) return PLIANT_NOT_STARTED;
  fill(t, t->tracker.result(), result);
  return PLIANT_OK;
}

pliant_status pliant_get_parameters(pliant_tracker* t, const float** values, size_t* count) {
  if (t == nullptr) return PLIANT_BAD_ARGUMENT;
  if (!t->is_started) return PLIANT_NOT_STARTED;
  const Span<const float> q = t->tracker.estimator().parameters();
  if (values != nullptr) *values = q.data;
  if (count != nullptr) *count = q.count;
  return PLIANT_OK;
}

pliant_status pliant_find_parameter(const pliant_tracker* t, const char* name, size_t* index) {
  if (t == nullptr || name == nullptr || index == nullptr) return PLIANT_BAD_ARGUMENT;
  const std::uint16_t k = t->model.find_parameter(name);
  if (k == kNone) return PLIANT_NOT_FOUND;
  *index = k;
  return PLIANT_OK;
}

pliant_status pliant_get_landmark(pliant_tracker* t, const char* name, float* x, float* y) {
  if (t == nullptr || name == nullptr || x == nullptr || y == nullptr) return PLIANT_BAD_ARGUMENT;
  if (!t->is_started) return PLIANT_NOT_STARTED;
  const std::uint16_t k = t->model.find_landmark(name);
  if (k == kNone) return PLIANT_NOT_FOUND;
  Vec2 at;
  const Landmark& l = t->model.landmarks()[k];
  if (!project_beside(t->tracker.estimator(), {l.u, l.v}, t->landmark_offsets[k], &at))
    return PLIANT_UNDERDETERMINED;
  *x = at.x;
  *y = at.y;
  return PLIANT_OK;
}
