// The C interface: the caller's block holds the handle, then what the tracker takes.
#include <cstdint>
#include <new>

#include "pliant/pliant.h"
#include "pliant/tracker.hpp"

using namespace pliant;

struct pliant_tracker {
  Tracker tracker;
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
  to->start_points = from.start_points;
  return from.width >= 64 && from.height >= 64 && (!has_region || region_fits) && from.patches >= 6 &&
         from.start_points >= 4 && from.start_points <= kMostStartPoints;
}

bool is_aligned(const void* memory) {
  return memory != nullptr && reinterpret_cast<std::uintptr_t>(memory) % Arena::kAlignment == 0;
}

constexpr std::size_t kScratchBytes = PLIANT_SCRATCH_BYTES;
static_assert(sizeof(Tracker) <= kScratchBytes);

/// What creating and asking for the size have in common.
Status read(const void* table, std::size_t table_bytes, const pliant_limits* from, Model* model,
            TrackerLimits* limits) {
  if (from == nullptr || !read_limits(*from, limits)) return Status::bad_argument;
  return Model::open(table, table_bytes, model);
}

FrameView view_of(const pliant_frame& f) {
  return {f.pixels, f.width, f.height, f.stride_bytes, f.pixel_step_bytes, f.time_ns, f.sequence};
}

void fill(const Tracker& tracker, pliant_result* to) {
  const FrameResult& from = tracker.result();
  const Camera& camera = tracker.camera();
  const Pose& p = from.pose;
  *to = {{{p.q.w, p.q.x, p.q.y, p.q.z}, {p.t.x, p.t.y, p.t.z}},
         {camera.f, camera.cx, camera.cy},
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
  trial.take<pliant_tracker>(1);
  (new (scratch) Tracker())->lay_out(trial, model, own);
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
  if (bytes < sizeof(pliant_tracker) + Arena::kAlignment) return PLIANT_OUT_OF_MEMORY;
  Arena arena(memory, bytes);
  auto* const handle = new (arena.take<pliant_tracker>(1)) pliant_tracker();
  if (create_in(arena, handle->tracker, model, own) != Status::ok) return PLIANT_OUT_OF_MEMORY;
  *tracker = handle;
  return PLIANT_OK;
}

pliant_status pliant_start_pose(pliant_tracker* t, const pliant_frame* frame, const pliant_camera* camera,
                                const pliant_pose* pose, const float* parameters) {
  if (t == nullptr || frame == nullptr || camera == nullptr || pose == nullptr) return PLIANT_BAD_ARGUMENT;
  return plain(t->tracker.start_from_pose(
      view_of(*frame), {camera->f, camera->cx, camera->cy},
      {{pose->q[0], pose->q[1], pose->q[2], pose->q[3]}, {pose->t[0], pose->t[1], pose->t[2]}}, parameters));
}

pliant_status pliant_start_points(pliant_tracker* t, const pliant_frame* frame, float focal_px,
                                  const pliant_point* points, size_t count) {
  static_assert(sizeof(NamedPoint) == sizeof(pliant_point) &&
                offsetof(NamedPoint, x) == offsetof(pliant_point, x));
  if (t == nullptr || frame == nullptr || points == nullptr) return PLIANT_BAD_ARGUMENT;
  StartOptions start;
  start.focal_px = focal_px;
  return plain(t->tracker.start_from_landmarks(view_of(*frame),
                                               {reinterpret_cast<const NamedPoint*>(points), count}, start));
}

pliant_status pliant_start_box(pliant_tracker* t, const pliant_frame* frame, float focal_px, float x, float y,
                               float width, float height) {
  if (t == nullptr || frame == nullptr) return PLIANT_BAD_ARGUMENT;
  StartOptions start;
  start.focal_px = focal_px;
  return plain(t->tracker.start_from_box(view_of(*frame), {x, y}, {width, height}, start));
}

pliant_status pliant_update(pliant_tracker* t, const pliant_frame* frame, pliant_result* result) {
  if (t == nullptr || frame == nullptr || result == nullptr) return PLIANT_BAD_ARGUMENT;
  FrameResult found;
  const Status status = t->tracker.update(view_of(*frame), &found);
  if (status == Status::ok) fill(t->tracker, result);
  return plain(status);
}

pliant_status pliant_get_result(pliant_tracker* t, pliant_result* result) {
  if (t == nullptr || result == nullptr) return PLIANT_BAD_ARGUMENT;
  if (!t->tracker.is_started()) return PLIANT_NOT_STARTED;
  fill(t->tracker, result);
  return PLIANT_OK;
}

pliant_status pliant_get_parameters(pliant_tracker* t, const float** values, size_t* count) {
  if (t == nullptr) return PLIANT_BAD_ARGUMENT;
  if (!t->tracker.is_started()) return PLIANT_NOT_STARTED;
  const Span<const float> q = t->tracker.estimator().parameters();
  if (values != nullptr) *values = q.data;
  if (count != nullptr) *count = q.count;
  return PLIANT_OK;
}

pliant_status pliant_find_parameter(const pliant_tracker* t, const char* name, size_t* index) {
  if (t == nullptr || name == nullptr || index == nullptr) return PLIANT_BAD_ARGUMENT;
  const std::uint16_t k = t->tracker.model().find_parameter(name);
  if (k == kNone) return PLIANT_NOT_FOUND;
  *index = k;
  return PLIANT_OK;
}

pliant_status pliant_get_landmark(pliant_tracker* t, const char* name, float* x, float* y) {
  if (t == nullptr || name == nullptr || x == nullptr || y == nullptr) return PLIANT_BAD_ARGUMENT;
  Vec2 at;
  const Status status = t->tracker.landmark(name, &at);
  if (status != Status::ok) return plain(status);
  *x = at.x;
  *y = at.y;
  return PLIANT_OK;
}
