// The C interface: converts the arguments and calls the Tracker. The caller's block holds the handle, then the arena of
// the tracker.
#include <cstddef>
#include <cstdint>
#include <new>
#include <type_traits>

#include "pliant/pliant.h"
#include "pliant/tracker.hpp"

using namespace pliant;

struct pliant_tracker {
  Tracker tracker;
};

namespace {

static_assert(static_cast<int>(Status::stale_frame) == PLIANT_STALE_FRAME);
static_assert(static_cast<int>(Status::isolated_vertex) == PLIANT_ISOLATED_VERTEX);
static_assert(static_cast<int>(Status::not_found) == PLIANT_NOT_FOUND);
static_assert(static_cast<int>(TrackState::lost) == PLIANT_LOST);
static_assert(static_cast<int>(BoxConvention::face_box) == PLIANT_BOX_FACE);
/// Whether arrays of one type may be read as arrays of the other, if their members have the same types at the same places.
template <class A, class B>
constexpr bool have_one_layout() {
  return sizeof(A) == sizeof(B) && alignof(A) == alignof(B) && std::is_standard_layout_v<A> &&
         std::is_standard_layout_v<B> && std::is_trivially_copyable_v<A> && std::is_trivially_copyable_v<B>;
}
// The caller's arrays are of any length and are handed on as they are: there is no memory for copies of them. To the standard
// they stay arrays of the C types. A NamedPoint may alias them (may_alias), and a Vec3 is read and written as the floats that it
// is made of.
static_assert(have_one_layout<NamedPoint, pliant_point>());
static_assert(std::is_same_v<decltype(NamedPoint::name), decltype(pliant_point::landmark)> &&
              std::is_same_v<decltype(Vec2::x), decltype(pliant_point::x)>);
static_assert(offsetof(NamedPoint, name) == offsetof(pliant_point, landmark) &&
              offsetof(NamedPoint, x) + offsetof(Vec2, x) == offsetof(pliant_point, x) &&
              offsetof(NamedPoint, x) + offsetof(Vec2, y) == offsetof(pliant_point, y));
static_assert(have_one_layout<Vec3, float[3]>() && std::is_same_v<decltype(Vec3::x), float>);
static_assert(offsetof(Vec3, x) == 0 && offsetof(Vec3, y) == sizeof(float) &&
              offsetof(Vec3, z) == 2 * sizeof(float));

pliant_status plain(Status status) {
  return static_cast<pliant_status>(status);
}

bool is_aligned(const void* memory) {
  return memory != nullptr && reinterpret_cast<std::uintptr_t>(memory) % Arena::kAlignment == 0;
}

FrameView view_of(const pliant_frame& f) {
  return {f.pixels, f.width, f.height, f.stride_bytes, f.pixel_step_bytes, f.time_ns, f.sequence};
}

Camera camera_of(const pliant_camera& c) {
  return {c.f, c.cx, c.cy, c.k1, c.k2, c.aspect == 0 ? 1 : c.aspect};
}

pliant_camera plain(const Camera& c) {
  return {c.f, c.cx, c.cy, c.k1, c.k2, c.aspect};
}

Pose pose_of(const pliant_pose& p) {
  return {{p.q[0], p.q[1], p.q[2], p.q[3]}, {p.t[0], p.t[1], p.t[2]}};
}

pliant_pose plain(const Pose& p) {
  return {{p.q.w, p.q.x, p.q.y, p.q.z}, {p.t.x, p.t.y, p.t.z}};
}

pliant_result result_of(const Tracker& tracker) {
  const FrameResult& r = tracker.result();
  return {plain(r.pose),
          plain(tracker.camera()),
          r.rms_px,
          r.tracked,
          r.inliers,
          static_cast<std::int32_t>(r.state),
          r.landmark_error,
          r.is_searching ? 1 : 0,
          {r.gaze.x, r.gaze.y, r.gaze.z},
          tracker.track_number(),
          tracker.person_number()};
}

Span<const NamedPoint> points_of(const pliant_point* points, std::size_t count) {
  return {reinterpret_cast<const NamedPoint*>(points), count};
}

/// The arrays of a state, and its camera and pose.
SavedState state_of(const pliant_state& s) {
  return {camera_of(s.camera),
          pose_of(s.pose),
          {s.parameters, s.parameter_count},
          {reinterpret_cast<Vec3*>(s.landmark_offsets), s.landmark_count}};
}

/// The options of a start. `camera` is room for the one that they name.
StartOptions options_of(const pliant_start_options* from, Camera* camera) {
  StartOptions to;
  if (from == nullptr) return to;
  to.focal_px = from->focal_px;
  to.box = static_cast<BoxConvention>(from->box <= PLIANT_BOX_FACE ? from->box : 255);  // another is refused
  if (from->camera == nullptr) return to;
  *camera = camera_of(*from->camera);
  to.camera = camera;
  return to;
}

TrackerOptions tracker_options_of(const pliant_start_options* from) {
  TrackerOptions to;
  to.keeps_landmark_offsets = from == nullptr || from->drops_landmark_offsets == 0;
  return to;
}

TrackerLimits profile_named(std::uint16_t name) {
  return name == 'S' ? profile_s() : name == 'L' ? profile_l() : profile_m();
}

bool is_profile(std::uint16_t name) {
  return name == 'S' || name == 'M' || name == 'L';
}

/// Opens the table and converts the limits.
Status open(const void* table, std::size_t table_bytes, const pliant_limits* from, Model* model,
            TrackerLimits* limits) {
  if (from == nullptr || !is_profile(from->profile)) return Status::bad_argument;
  *limits = profile_named(from->profile);
  limits->width = from->width;
  limits->height = from->height;
  limits->region_width = from->region_width;
  limits->region_height = from->region_height;
  limits->patches = from->patches;
  limits->key_patches = from->key_patches;
  limits->vertices = from->vertices;
  limits->start_points = from->start_points;
  limits->smallest_face_px = from->smallest_face_px;
  limits->search_work = from->search_work;
  // As without_detection and without_person, which copy all limits.
  if (from->leaves_out > (PLIANT_NO_DETECTION | PLIANT_NO_PERSON)) return Status::bad_argument;
  if ((from->leaves_out & PLIANT_NO_DETECTION) != 0) limits->detection = nullptr, limits->second_look = nullptr;
  if ((from->leaves_out & PLIANT_NO_PERSON) != 0) limits->person = nullptr;
  const Status status = check(*limits);
  return status == Status::ok ? Model::open(table, table_bytes, model) : status;
}

template <class Named>
pliant_status name_at(const Span<const Named>& all, std::size_t index, const char** name) {
  if (index >= all.count) return PLIANT_NOT_FOUND;
  *name = all[index].name;
  return PLIANT_OK;
}

pliant_status place(Status status, Vec2 found, float* x, float* y) {
  if (status != Status::ok) return plain(status);
  *x = found.x;
  *y = found.y;
  return PLIANT_OK;
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
  const auto profile = static_cast<std::uint16_t>(name);
  if (!is_profile(profile)) return {};
  const TrackerLimits l = profile_named(profile);
  return {l.width,    l.height,       l.region_width, l.region_height,    l.patches,    l.key_patches,
          l.vertices, l.start_points, profile,        l.smallest_face_px, l.search_work, 0};
}

pliant_status pliant_required_bytes(const void* table, size_t table_bytes, const pliant_limits* limits,
                                    size_t* bytes) {
  if (bytes == nullptr) return PLIANT_BAD_ARGUMENT;
  Model model;
  TrackerLimits own;
  const Status status = open(table, table_bytes, limits, &model, &own);
  if (status != Status::ok) return plain(status);
  if (!are_usable(model, own)) return PLIANT_BAD_ARGUMENT;
  Arena trial;
  trial.take<pliant_tracker>(1);
  Tracker().lay_out(trial, model, own);
  *bytes = trial.used_bytes();
  return PLIANT_OK;
}

pliant_status pliant_create(void* memory, size_t bytes, const void* table, size_t table_bytes,
                            const pliant_limits* limits, pliant_tracker** tracker) {
  if (!is_aligned(memory) || tracker == nullptr) return PLIANT_BAD_ARGUMENT;
  Model model;
  TrackerLimits own;
  Status status = open(table, table_bytes, limits, &model, &own);
  if (status != Status::ok) return plain(status);
  Arena arena(memory, bytes);
  void* const room = arena.take<pliant_tracker>(1);
  if (room == nullptr) return PLIANT_OUT_OF_MEMORY;
  auto* const handle = new (room) pliant_tracker();
  status = create_in(arena, handle->tracker, model, own);
  if (status == Status::ok) *tracker = handle;
  return plain(status);
}

pliant_status pliant_start_by_detection(pliant_tracker* t, const pliant_start_options* options) {
  if (t == nullptr) return PLIANT_BAD_ARGUMENT;
  Camera camera;
  return plain(t->tracker.start_by_detection(options_of(options, &camera), tracker_options_of(options)));
}

pliant_status pliant_start_from_pose(pliant_tracker* t, const pliant_frame* frame,
                                     const pliant_camera* camera, const pliant_pose* pose,
                                     const float* parameters) {
  if (t == nullptr || frame == nullptr || camera == nullptr || pose == nullptr) return PLIANT_BAD_ARGUMENT;
  return plain(t->tracker.start_from_pose(view_of(*frame), camera_of(*camera), pose_of(*pose), parameters));
}

pliant_status pliant_start_from_landmarks(pliant_tracker* t, const pliant_frame* frame,
                                          const pliant_point* points, size_t count,
                                          const pliant_start_options* options) {
  if (t == nullptr || frame == nullptr || points == nullptr) return PLIANT_BAD_ARGUMENT;
  Camera camera;
  return plain(t->tracker.start_from_landmarks(view_of(*frame), points_of(points, count),
                                               options_of(options, &camera), tracker_options_of(options)));
}

pliant_status pliant_start_from_box(pliant_tracker* t, const pliant_frame* frame, float x, float y,
                                    float width, float height, const pliant_start_options* options) {
  if (t == nullptr || frame == nullptr) return PLIANT_BAD_ARGUMENT;
  Camera camera;
  return plain(t->tracker.start_from_box(view_of(*frame), {x, y}, {width, height},
                                         options_of(options, &camera), tracker_options_of(options)));
}

pliant_status pliant_start_from_state(pliant_tracker* t, const pliant_frame* frame,
                                      const pliant_state* state) {
  if (t == nullptr || frame == nullptr || state == nullptr) return PLIANT_BAD_ARGUMENT;
  return plain(t->tracker.start_from_state(view_of(*frame), state_of(*state)));
}

pliant_status pliant_save(const pliant_tracker* t, pliant_state* state) {
  if (t == nullptr || state == nullptr) return PLIANT_BAD_ARGUMENT;
  // Camera and pose are output: the caller need not have set them.
  SavedState saved{{},
                   {},
                   {state->parameters, state->parameter_count},
                   {reinterpret_cast<Vec3*>(state->landmark_offsets), state->landmark_count}};
  const Status status = t->tracker.save(&saved);
  if (status != Status::ok) return plain(status);
  state->camera = plain(saved.camera);
  state->pose = plain(saved.pose);
  return PLIANT_OK;
}

pliant_status pliant_update(pliant_tracker* t, const pliant_frame* frame, pliant_result* result) {
  if (t == nullptr || frame == nullptr || result == nullptr) return PLIANT_BAD_ARGUMENT;
  FrameResult found;
  const Status status = t->tracker.update(view_of(*frame), &found);
  if (status == Status::ok) *result = result_of(t->tracker);
  return plain(status);
}

pliant_status pliant_get_result(const pliant_tracker* t, pliant_result* result) {
  if (t == nullptr || result == nullptr) return PLIANT_BAD_ARGUMENT;
  if (!t->tracker.is_started() && !t->tracker.result().is_searching) return PLIANT_NOT_STARTED;
  *result = result_of(t->tracker);
  return PLIANT_OK;
}

pliant_status pliant_parameter_count(const pliant_tracker* t, size_t* count) {
  if (t == nullptr || count == nullptr) return PLIANT_BAD_ARGUMENT;
  *count = t->tracker.model().parameters().count;
  return PLIANT_OK;
}

pliant_status pliant_parameter_name(const pliant_tracker* t, size_t index, const char** name) {
  if (t == nullptr || name == nullptr) return PLIANT_BAD_ARGUMENT;
  return name_at(t->tracker.model().parameters(), index, name);
}

pliant_status pliant_parameter_range(const pliant_tracker* t, size_t index, float* minimum, float* maximum) {
  if (t == nullptr || minimum == nullptr || maximum == nullptr) return PLIANT_BAD_ARGUMENT;
  const auto parameters = t->tracker.model().parameters();
  if (index >= parameters.count) return PLIANT_NOT_FOUND;
  *minimum = parameters[index].minimum;
  *maximum = parameters[index].maximum;
  return PLIANT_OK;
}

pliant_status pliant_landmark_count(const pliant_tracker* t, size_t* count) {
  if (t == nullptr || count == nullptr) return PLIANT_BAD_ARGUMENT;
  *count = t->tracker.model().landmarks().count;
  return PLIANT_OK;
}

pliant_status pliant_landmark_name(const pliant_tracker* t, size_t index, const char** name) {
  if (t == nullptr || name == nullptr) return PLIANT_BAD_ARGUMENT;
  return name_at(t->tracker.model().landmarks(), index, name);
}

pliant_status pliant_get_parameter(const pliant_tracker* t, const char* name, float* value) {
  if (t == nullptr || name == nullptr || value == nullptr) return PLIANT_BAD_ARGUMENT;
  return plain(t->tracker.parameter(name, value));
}

pliant_status pliant_get_parameters(const pliant_tracker* t, const float** values) {
  if (t == nullptr || values == nullptr) return PLIANT_BAD_ARGUMENT;
  if (!t->tracker.is_started()) return PLIANT_NOT_STARTED;
  *values = t->tracker.parameters().data;
  return PLIANT_OK;
}

pliant_status pliant_get_landmark(pliant_tracker* t, const char* name, float* x, float* y) {
  if (t == nullptr || name == nullptr || x == nullptr || y == nullptr) return PLIANT_BAD_ARGUMENT;
  Vec2 found;
  const Status status = t->tracker.landmark(name, &found);
  return place(status, found, x, y);
}

pliant_status pliant_get_landmark_at(pliant_tracker* t, size_t index, float* x, float* y) {
  if (t == nullptr || x == nullptr || y == nullptr) return PLIANT_BAD_ARGUMENT;
  Vec2 found;
  const Status status = t->tracker.landmark(index, &found);
  return place(status, found, x, y);
}

pliant_status pliant_place_landmarks(pliant_tracker* t, const pliant_point* points, size_t count) {
  if (t == nullptr || points == nullptr) return PLIANT_BAD_ARGUMENT;
  return plain(t->tracker.place_landmarks(points_of(points, count)));
}
