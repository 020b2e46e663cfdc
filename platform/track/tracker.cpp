// The life of a tracker: memory, start, and what is done with a frame.
#include "pliant/tracker.hpp"

#include "track/edge_search.hpp"
#include "track/surface_offset.hpp"
#include "track/tracker_sizes.hpp"
#include "vision/thumbnail.hpp"

namespace pliant {

namespace {

constexpr std::uint32_t kTextureShare = 32;    // one face in so many is looked at for texture, a frame
constexpr std::size_t kLongestRow = 1u << 24;  // bytes, of a frame that is used in place

PatchLimits patch_limits(const TrackerLimits& limits) {
  PatchLimits p;
  p.slots = static_cast<int>(all_slots(limits));
  p.window = limits.patch_window;
  p.levels = limits.pyramid_levels;
  p.margin = limits.patch_margin;
  p.keeps_templates = limits.keeps_templates;
  return p;
}

PyramidLimits pyramid_limits(const TrackerLimits& limits) {
  PyramidLimits p;
  p.width = region_width(limits);
  p.height = region_height(limits);
  p.levels = limits.pyramid_levels;
  p.copies_frame = limits.copies_frame || limits.keeps_previous;
  return p;
}

EstimatorLimits estimator_limits(const TrackerLimits& limits) {
  EstimatorLimits e = without_rejection(EstimatorLimits{});
  e.points = static_cast<std::uint16_t>(all_points(limits));
  e.silhouette_points = limits.silhouette_points;
  e.vertices = limits.vertices;
  e.free_parameters = limits.free_parameters;
  e.samples_per_point = limits.samples_per_point;
  e.samples_vertices = limits.samples_vertices;
  e.rejection_sample = limits.rejection_sample;
  e.rejection = limits.rejection;
  e.personal_field = limits.personal_field;
  return e;
}

/// The nearest place for a window of `size` around `centre` inside 0 .. all, on the grid of the coarsest pyramid level.
int placed(float centre, int size, int all, int grid) {
  const float first = centre - 0.5f * static_cast<float>(size);
  const int at = static_cast<int>(clamp(first, 0, static_cast<float>(all - size)));
  return at / grid * grid;
}

}  // namespace

/// Everything that tracking uses; also again after the fit of a start has used the same memory.
void Tracker::lay_out_tracking(Arena& arena, const Model& model) {
  slot_count_ = all_slots(limits_);
  estimator_.lay_out(arena, model, estimator_limits(limits_));
  arena.count_as(Purpose::pyramid);
  current_.lay_out(arena, pyramid_limits(limits_));
  if (limits_.keeps_previous) previous_.lay_out(arena, pyramid_limits(limits_));
  arena.count_as(Purpose::patches);
  patches_.lay_out(arena, patch_limits(limits_));
  arena.count_as(Purpose::points);
  slots_ = arena.take<Slot>(slot_count_);
  observations_ = arena.take<Observation>(slot_count_ + EdgeSearch::kAlternatives * edge_points(limits_));
  prediction_of_ = arena.take<std::uint16_t>(all_points(limits_));
  EdgeSearch measured;
  edges_ = arena.take<EdgeSearch>(1);
  (edges_ != nullptr ? *edges_ : measured).lay_out(arena, edge_points(limits_));
  marker_ids_ = arena.take<std::uint16_t>(limits_.markers);
  marker_offsets_ = arena.take<Vec3>(limits_.markers);
  arena.count_as(Purpose::corners);
  corners_ = arena.take<Corner>(limits_.patches);
  const CornerOptions corners = corner_options(limits_);
  cells_ = arena.take<std::uint8_t>(
      static_cast<std::size_t>(corner_cells(region_width(limits_), corners.cell_px)) *
      static_cast<std::size_t>(corner_cells(region_height(limits_), corners.cell_px)));
  scratch_bytes_ = corner_scratch_bytes(region_width(limits_), region_height(limits_), corners);
  scratch_ = arena.take<std::uint8_t>(scratch_bytes_);
  arena.count_as(Purpose::adaptation);
  texture_ = arena.take<std::uint8_t>(std::size_t{limits_.texture_cells} * limits_.texture_cells);
  thumbnail_factor_ = thumbnail_factor(limits_.width, limits_.thumbnail_width);
  thumbnail_width_ = limits_.width / thumbnail_factor_;
  thumbnail_height_ = limits_.height / thumbnail_factor_;
  const std::size_t small =
      static_cast<std::size_t>(thumbnail_width_) * static_cast<std::size_t>(thumbnail_height_);
  arena.count_as(Purpose::thumbnails);
  thumbnail_line_ = arena.take<std::uint16_t>(static_cast<std::size_t>(thumbnail_width_ * thumbnail_factor_));
  thumbnail_ = arena.take<std::uint8_t>(small);
  trusted_thumbnail_ = arena.take<std::uint8_t>(small);
  key_thumbnails_ = arena.take<std::uint8_t>((std::size_t{limits_.key_frames} + 1) * small);
}

Status Tracker::check_frame(const FrameView& frame) const {
  const Status status = check(frame);
  if (status != Status::ok) return status;
  if (frame.width != limits_.width || frame.height != limits_.height) return Status::size_mismatch;
  const bool is_copied = limits_.copies_frame || limits_.keeps_previous;
  const bool is_usable = is_copied || (frame.pixel_step_bytes == 1 && frame.stride_bytes <= kLongestRow);
  return is_usable ? Status::ok : Status::bad_argument;
}

/// Builds the pyramid of the region around where the model is expected.
Status Tracker::look_at_region(const FrameView& frame) {
  const int width = region_width(limits_), height = region_height(limits_);
  const int grid = 1 << (limits_.pyramid_levels - 1);
  int x = 0, y = 0;
  if (width < frame.width || height < frame.height) {
    const PixelBox box = model_box();
    const float half = 0.5f * static_cast<float>(thumbnail_factor_);
    const Vec2 centre =
        Vec2{half * static_cast<float>(box.x0 + box.x1), half * static_cast<float>(box.y0 + box.y1)} +
        expected_shift_;
    x = placed(centre.x, width, frame.width, grid);
    y = placed(centre.y, height, frame.height, grid);
  }
  FrameView part = frame;
  part.width = width;
  part.height = height;
  part.data += static_cast<std::size_t>(y) * frame.stride_bytes +
               static_cast<std::size_t>(x) * static_cast<std::size_t>(frame.pixel_step_bytes);
  const Status status = current_.build(part);
  if (status == Status::ok) origin_ = {static_cast<float>(x), static_cast<float>(y)};
  return status;
}

PixelBox Tracker::region() const {
  const int x = static_cast<int>(origin_.x), y = static_cast<int>(origin_.y);
  return {x, y, x + region_width(limits_), y + region_height(limits_)};
}

/// A clock may be set back and a sequence number may be left out, but not both.
bool Tracker::is_stale(const FrameView& frame) const {
  const bool is_next = frame.sequence != last_sequence_ && frame.sequence - last_sequence_ < 0x80000000u;
  return frame.time_ns <= last_time_ns_ && !is_next;
}

Status Tracker::start_from_pose(const FrameView& frame, const Camera& camera, const Pose& pose,
                                const float* q, const TrackerOptions& options, Span<const Vec2> markers) {
  const Status status = check_start(frame, markers);
  if (status != Status::ok) return status;
  clear_offsets();
  for (std::size_t k = 0; q == nullptr && k < model().parameters().count; ++k) start_q_[k] = 0;
  return start_tracking(frame, camera, pose, q == nullptr ? start_q_ : q, options, markers);
}

/// Frame 0. Its arguments have been checked.
Status Tracker::start_tracking(const FrameView& frame, const Camera& camera, const Pose& pose, const float* q,
                               const TrackerOptions& options, Span<const Vec2> markers) {
  started_ = false;
  options_ = options;
  start_texture();
  Status status =
      estimator_.start(camera, frame.width, frame.height, pose, q, options.is_free, options_.estimator);
  if (status != Status::ok) return status;
  expected_shift_ = {};
  status = look_at_region(frame);
  if (status != Status::ok) return status;
  make_thumbnail(frame, thumbnail_factor_, thumbnail_line_, thumbnail_);
  if (notes_texture_) note_texture(0, 1);
  estimator_.begin(frame.time_ns);
  status = place_markers(markers);
  if (status != Status::ok) return status;
  for (std::size_t k = 0; k < slot_count_; ++k) slots_[k].is_used = false;
  for (KeyFrame& key : keys_) key.is_used = false;
  seed_patches(0, limits_.patches);
  std::uint16_t seeded = 0;
  for (std::size_t k = 0; k < limits_.patches; ++k)
    seeded = static_cast<std::uint16_t>(seeded + slots_[k].is_used);
  if (seeded < 6) return Status::too_few_points;
  result_ = {TrackState::tracking,
             pose_of(estimator_.view()),
             seeded,
             seeded,
             0,
             0,
             static_cast<std::uint16_t>(estimator_.mesh().vertex_count())};
  last_time_ns_ = frame.time_ns;
  last_sequence_ = frame.sequence;
  edges_->place(estimator_, options.curve_spacing_mm, limits_.silhouette_points);
  edges_->anchor(estimator_, current_, origin_);
  frame_ = 0;
  describe_key(0);
  last_box_ = keys_[0].box;
  std::uint8_t* const empty = trusted_thumbnail_;
  trusted_thumbnail_ = thumbnail_;
  thumbnail_ = empty;
  bad_frames_ = 0;
  moved_px_ = left_px_ = shift_px_ = 1e9f;
  started_ = true;
  return Status::ok;
}

Status Tracker::update(const FrameView& frame, FrameResult* result) {
  if (!started_) return Status::not_started;
  if (result == nullptr) return Status::bad_argument;
  Status status = check_frame(frame);
  if (status != Status::ok) return status;
  if (is_stale(frame)) return Status::stale_frame;
  last_time_ns_ = frame.time_ns;
  last_sequence_ = frame.sequence;
  ++frame_;
  make_thumbnail(frame, thumbnail_factor_, thumbnail_line_, thumbnail_);
  estimator_.begin(frame.time_ns);
  expect_motion();
  if (limits_.keeps_previous) {
    current_.swap(previous_);
    previous_origin_ = origin_;
  }
  status = look_at_region(frame);
  if (status != Status::ok) return status;
  has_first_pass_ = look_ahead();
  for (int round = has_first_pass_ ? 1 : 0; round < options_.rounds; ++round)
    if (look_and_solve(round) == 0) break;
  if (estimator_.needs_another_round()) look_and_solve(options_.rounds - 1);
  result_ = estimator_.end();
  note_seen();
  if (result_.state == TrackState::tracking) {
    bad_frames_ = 0;
    last_box_ = model_box();
    if (notes_texture_) note_texture(frame_ % kTextureShare, kTextureShare);
    keep_key_frame();
    std::uint8_t* const old = trusted_thumbnail_;
    trusted_thumbnail_ = thumbnail_;
    thumbnail_ = old;
  } else {
    ++bad_frames_;
  }
  *result = result_;
  return Status::ok;
}

bool Tracker::marker(std::size_t k, Vec2* x) {
  return k < marker_count_ &&
         project_beside(estimator_, estimator_.point_uv(marker_ids_[k]), marker_offsets_[k], x);
}

bool Tracker::patch(std::size_t k, Vec2* x) const {
  if (k >= slot_count_ || !slots_[k].is_used || !slots_[k].was_seen) return false;
  *x = slots_[k].seen;
  return true;
}

}  // namespace pliant
