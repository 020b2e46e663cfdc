#include "pliant/tracker.hpp"

namespace pliant {

namespace {

constexpr std::uint8_t kMostFramesApart = 20;
constexpr float kFollowedShare = 0.25f;  // weight of a patch that was only followed from the frame before

/// Side of a corner cell, px: 8 at 320 x 240.
int cell_px_of(const TrackerLimits& limits) {
  const int side = (limits.width + 20) / 40;
  return side < 4 ? 4 : side > 64 ? 64 : side;
}

CornerOptions corner_options(const TrackerLimits& limits) {
  CornerOptions o;
  o.cell_px = cell_px_of(limits);
  o.min_score = 1;
  o.quality = 0;
  o.min_ratio = 0.02f;
  return o;
}

PatchLimits patch_limits(const TrackerLimits& limits) {
  PatchLimits p;
  p.slots = limits.patches;
  p.window = limits.patch_window;
  p.levels = limits.pyramid_levels;
  return p;
}

EstimatorLimits estimator_limits(const TrackerLimits& limits) {
  EstimatorLimits e;
  e.points = static_cast<std::uint16_t>(limits.patches + limits.markers);
  e.vertices = limits.vertices;
  return e;
}

Reason reason_of(PatchStatus status) {
  switch (status) {
    case PatchStatus::ok:
      return Reason::found;
    case PatchStatus::outside_image:
      return Reason::outside_image;
    case PatchStatus::flat:
    case PatchStatus::empty_slot:
      return Reason::no_texture;
    case PatchStatus::low_correlation:
    case PatchStatus::bad_light:
      return Reason::low_correlation;
    case PatchStatus::inconsistent:
      return Reason::forward_backward;
    case PatchStatus::bad_argument:
    case PatchStatus::diverged:
      break;
  }
  return Reason::diverged;
}

}  // namespace

void Tracker::lay_out(Arena& arena, const Model& model, const TrackerLimits& limits) {
  limits_ = limits;
  estimator_.lay_out(arena, model, estimator_limits(limits));
  PyramidLimits pyramid;
  pyramid.width = limits.width;
  pyramid.height = limits.height;
  pyramid.levels = limits.pyramid_levels;
  current_.lay_out(arena, pyramid);
  previous_.lay_out(arena, pyramid);
  patches_.lay_out(arena, patch_limits(limits));
  slots_ = arena.take<Slot>(limits.patches);
  observations_ = arena.take<Observation>(limits.patches);
  marker_ids_ = arena.take<std::uint16_t>(limits.markers);
  corners_ = arena.take<Corner>(limits.patches);
  const CornerOptions corners = corner_options(limits);
  cells_ = arena.take<std::uint8_t>(static_cast<std::size_t>(corner_cells(limits.width, corners.cell_px)) *
                                    static_cast<std::size_t>(corner_cells(limits.height, corners.cell_px)));
  scratch_bytes_ = corner_scratch_bytes(limits.width, limits.height, corners);
  scratch_ = arena.take<std::uint8_t>(scratch_bytes_);
  std::size_t small_width = limits.width, small_height = limits.height;
  for (int l = 1; l < limits.pyramid_levels; ++l) {
    small_width = (small_width + 1) / 2;
    small_height = (small_height + 1) / 2;
  }
  first_small_ = arena.take<std::uint8_t>(small_width * small_height);
  last_small_ = arena.take<std::uint8_t>(small_width * small_height);
  started_ = false;
}

Status Tracker::check_frame(const FrameView& frame) const {
  const Status status = check(frame);
  if (status != Status::ok) return status;
  return frame.width == limits_.width && frame.height == limits_.height ? Status::ok : Status::size_mismatch;
}

Status Tracker::start(const FrameView& frame, const Camera& camera, const Pose& pose, const float* q,
                      Span<const Vec2> markers, const TrackerOptions& options) {
  started_ = false;
  Status status = check_frame(frame);
  if (status != Status::ok) return status;
  if (markers.count > limits_.markers) return Status::capacity;
  status = estimator_.start(camera, frame.width, frame.height, pose, q, options.is_free, options.estimator);
  if (status != Status::ok) return status;
  status = current_.build(frame);
  if (status != Status::ok) return status;
  options_ = options;
  estimator_.begin(frame.time_ns);
  status = place_markers(markers);
  if (status != Status::ok) return status;
  seed_patches();
  if (patch_count_ < 6) return Status::too_few_points;
  result_ = {TrackState::tracking,
             pose_of(estimator_.view()),
             static_cast<std::uint16_t>(patch_count_),
             static_cast<std::uint16_t>(patch_count_),
             0,
             0,
             static_cast<std::uint16_t>(estimator_.mesh().vertex_count())};
  first_view_ = estimator_.view();
  first_box_ = last_box_ = model_box();
  keep_small(first_small_);
  keep_small(last_small_);
  bad_frames_ = 0;
  started_ = true;
  return Status::ok;
}

Status Tracker::place_markers(Span<const Vec2> markers) {
  marker_count_ = 0;
  for (Vec2 x : markers) {
    Vec2 uv;
    if (!is_finite(x) || estimator_.surface_at(x, &uv) < 0) return Status::bad_argument;
    const Status status = estimator_.add_point(uv, &marker_ids_[marker_count_]);
    if (status != Status::ok) return status;
    ++marker_count_;
  }
  return Status::ok;
}

bool Tracker::marker(std::size_t k, Vec2* x) {
  return k < marker_count_ && estimator_.project(estimator_.point_uv(marker_ids_[k]), x);
}

bool Tracker::patch(std::size_t k, Vec2* x) const {
  if (k >= patch_count_ || !slots_[k].was_seen) return false;
  *x = slots_[k].seen;
  return true;
}

/// Cells under the faces that turn to the camera.
void Tracker::mark_visible_cells(int cell_px) {
  const int across = corner_cells(limits_.width, cell_px), down = corner_cells(limits_.height, cell_px);
  for (int i = 0; i < across * down; ++i) cells_[i] = 0;
  const Mesh& mesh = estimator_.mesh();
  const Vec2* image = estimator_.vertex_images();
  const float per_cell = 1.0f / static_cast<float>(cell_px);
  const auto cell = [per_cell](float x, int count) {
    return static_cast<int>(clamp(x * per_cell, 0, static_cast<float>(count - 1)));
  };
  for (FaceId f : mesh.faces()) {
    if (!faces_camera(mesh, image, f)) continue;
    const Vec2 a = image[mesh.corner(f, 0)], b = image[mesh.corner(f, 1)], c = image[mesh.corner(f, 2)];
    const int i1 = cell(max(a.x, max(b.x, c.x)), across), j1 = cell(max(a.y, max(b.y, c.y)), down);
    for (int j = cell(min(a.y, min(b.y, c.y)), down); j <= j1; ++j)
      for (int i = cell(min(a.x, min(b.x, c.x)), across); i <= i1; ++i) cells_[j * across + i] = 1;
  }
}

/// Takes on the surface under x as a patch, if it is far enough from the others and from the markers.
bool Tracker::seed(Vec2 x, float min_distance) {
  const auto nearer = [x](Vec2 other, float distance) {
    return dot(x - other, x - other) < distance * distance;
  };
  for (std::size_t k = 0; k < patch_count_; ++k)
    if (nearer(slots_[k].seen, min_distance)) return false;
  for (std::size_t k = 0; k < marker_count_; ++k) {
    Vec2 marker_x;
    if (!marker(k, &marker_x) || nearer(marker_x, options_.marker_exclusion_px)) return false;
  }
  Vec2 uv;
  if (estimator_.surface_at(x, &uv) != 0 || !estimator_.model().is_on_surface(uv)) return false;
  std::uint16_t id;
  if (estimator_.add_point(uv, &id) != Status::ok) return false;
  const Prediction p = estimator_.predict(id);
  const int slot = static_cast<int>(patch_count_);
  if (!p.visible || patches_.capture(slot, current_, x) != PatchStatus::ok) {
    estimator_.remove_point(id);
    return false;
  }
  slots_[patch_count_++] = {id, p.jacobian, x, x, true, 0};
  return true;
}

void Tracker::seed_patches() {
  patch_count_ = 0;
  CornerOptions options = corner_options(limits_);
  mark_visible_cells(options.cell_px);
  const auto cells = static_cast<std::size_t>(corner_cells(limits_.width, options.cell_px)) *
                     static_cast<std::size_t>(corner_cells(limits_.height, options.cell_px));
  std::size_t marked = 0;
  for (std::size_t i = 0; i < cells; ++i) marked += cells_[i];
  // As far apart as the face allows, then closer, until all slots are used.
  const float area = static_cast<float>(marked) * static_cast<float>(options.cell_px * options.cell_px);
  float spacing = square_root(area / static_cast<float>(limits_.patches));
  for (int round = 0; round < 4 && patch_count_ < limits_.patches; ++round, spacing *= 0.7f) {
    options.min_distance_px = clamp(spacing, 2, 256);
    Arena scratch(scratch_, scratch_bytes_);
    int found = 0;
    if (find_corners(current_.level(0), options, {cells_, cells}, scratch, {corners_, limits_.patches},
                     found) != Status::ok)
      return;
    for (int i = 0; i < found && patch_count_ < limits_.patches; ++i) seed(corners_[i].x, spacing);
  }
}

Status Tracker::update(const FrameView& frame, FrameResult* result) {
  if (!started_) return Status::not_started;
  if (result == nullptr) return Status::bad_argument;
  const Status status = check_frame(frame);
  if (status != Status::ok) return status;
  current_.swap(previous_);
  const Status built = current_.build(frame);
  if (built != Status::ok) {
    current_.swap(previous_);
    return built;
  }
  estimator_.begin(frame.time_ns);
  expect_motion();
  for (int round = 0; round < options_.rounds; ++round) look_and_solve(round);
  result_ = estimator_.end();
  note_seen();
  if (result_.state == TrackState::tracking) {
    bad_frames_ = 0;
    last_box_ = model_box();
    keep_small(last_small_);
  } else {
    ++bad_frames_;
  }
  *result = result_;
  return Status::ok;
}

/// The model's bounding box in the pyramid's top level.
PixelBox Tracker::model_box() const {
  const int top = current_.levels() - 1;
  const float share = 1.0f / static_cast<float>(1 << top);
  const Vec2* image = estimator_.vertex_images();
  Vec2 low{1e9f, 1e9f}, high{-1e9f, -1e9f};
  for (VertexId v : estimator_.mesh().vertices()) {
    low = {min(low.x, image[v].x), min(low.y, image[v].y)};
    high = {max(high.x, image[v].x), max(high.y, image[v].y)};
  }
  const auto pixel = [share](float x) { return static_cast<int>(clamp(share * x, -1e4f, 1e4f)); };
  return {pixel(low.x), pixel(low.y), pixel(high.x) + 1, pixel(high.y) + 1};
}

void Tracker::keep_small(std::uint8_t* pixels) const {
  const ImageView& top = current_.level(current_.levels() - 1);
  for (int y = 0; y < top.height; ++y)
    for (int x = 0; x < top.width; ++x) pixels[y * top.width + x] = top.data[y * top.stride + x];
}

/// Moves the prediction by what the small pictures show: from the last trusted frame, or, every other frame after a
/// while without one, from the first frame over the whole picture.
void Tracker::expect_motion() {
  const int top = current_.levels() - 1;
  const ImageView& now = current_.level(top);
  const auto grow = static_cast<float>(1 << top);
  const bool from_first = bad_frames_ >= 2 && bad_frames_ % 2 == 0;
  const ImageView before{from_first ? first_small_ : last_small_, now.width, now.height, now.width};
  const int side = now.width > now.height ? now.width : now.height;
  const int range = from_first ? side / 2 : (bad_frames_ > 0 ? side / 8 : side / 16) + 1;
  const Shift shift = find_shift(before, from_first ? first_box_ : last_box_, now, range);
  if (shift.correlation < 0.5f) return;
  if (from_first) estimator_.propose(first_view_);
  estimator_.shift(grow * shift.by);
}

void Tracker::look_and_solve(int round) {
  const Span<const Prediction> predictions = estimator_.predict();
  std::size_t next = 0;  // predictions come in order of id; slots were given theirs in rising order too
  for (std::size_t k = 0; k < patch_count_; ++k) {
    while (next < predictions.count && predictions[next].id != slots_[k].id) ++next;
    if (next == predictions.count) break;
    observations_[k] = look(k, predictions[next], round);
    if (round == 0) slots_[k].expected = predictions[next].x;
  }
  estimator_.solve({observations_, patch_count_});
}

Observation Tracker::look(std::size_t k, const Prediction& p, int round) {
  Observation o;
  o.id = p.id;
  o.reason = Reason::not_visible;
  if (!p.visible) return o;
  const Slot& slot = slots_[k];
  PatchOptions options;
  const bool last = round + 1 == options_.rounds;
  options.min_correlation = last ? options_.min_correlation : options_.min_correlation - 0.1f;
  options.first_level = round == 0 ? -1 : 0;
  options.max_move_px = (round == 0 ? 16.0f : 3.0f) * static_cast<float>(limits_.width) / 320;
  const Mat2 warp = p.jacobian * inverse(slot.reference);
  const PatchResult found = patches_.track(static_cast<int>(k), current_, p.x, warp, options);
  o.reason = reason_of(found.status);
  if (found.status != PatchStatus::ok) return follow(k, p);
  o.x = found.x;
  o.information = found.information;
  o.score = found.correlation;
  return o;
}

/// From the frame before, when the patch no longer looks as in the first frame (a mouth that opens, a highlight).
Observation Tracker::follow(std::size_t k, const Prediction& p) {
  const Slot& slot = slots_[k];
  Observation o;
  o.id = p.id;
  o.reason = Reason::low_correlation;
  if (!slot.was_seen || slot.frames_apart >= kMostFramesApart) return o;
  PatchOptions options;
  options.max_return_px = options_.forward_backward_px * static_cast<float>(limits_.width) / 320;
  const PatchResult found = patches_.track_between(previous_, slot.seen, current_, p.x, options);
  o.reason = reason_of(found.status);
  if (found.status != PatchStatus::ok) return o;
  o.x = found.x;
  o.information = {kFollowedShare * found.information.xx, kFollowedShare * found.information.xy,
                   kFollowedShare * found.information.yy};
  o.cue = Cue::flow;
  o.score = found.correlation;
  return o;
}

void Tracker::note_seen() {
  for (std::size_t k = 0; k < patch_count_; ++k) {
    Slot& slot = slots_[k];
    const Observation& o = observations_[k];
    slot.was_seen = o.reason == Reason::found && result_.state == TrackState::tracking;
    if (!slot.was_seen) continue;
    slot.seen = o.x;
    if (o.cue == Cue::patch)
      slot.frames_apart = 0;
    else if (slot.frames_apart < kMostFramesApart)
      ++slot.frames_apart;
  }
}

}  // namespace pliant
