#pragma once
/// \file tracker.hpp
/// The composition: frames + vision + core -> pose, expression and surface points, frame by frame.
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/corners.hpp"
#include "pliant/estimator.hpp"
#include "pliant/frame.hpp"
#include "pliant/model.hpp"
#include "pliant/patch_tracker.hpp"
#include "pliant/pyramid.hpp"
#include "pliant/coarse_translation.hpp"

namespace pliant {

class EdgeSearch;

/// Capacities; they fix the arena's size. The defaults suit 320 x 240.
struct TrackerLimits {
  std::uint16_t width = 320, height = 240;  ///< of the frames, px
  /// Part of the frame that is looked at, px; it follows the model. 0: all of it. Otherwise at least 64 a side.
  std::uint16_t region_width = 0, region_height = 0;
  std::uint16_t patches = 128;     ///< surface patches captured in frame 0
  std::uint16_t key_patches = 64;  ///< captured in later key frames, all together
  std::uint8_t key_frames = 4;     ///< later key frames kept at a time, at most kMostKeyFrames
  std::uint16_t markers = 0;       ///< followed but never observed
  std::uint16_t curve_points = 0,
                silhouette_points = 0;  ///< at which edges are looked for: of curves, of the outline
  std::uint16_t vertices = 512;
  std::uint8_t pyramid_levels = 3;
  std::uint8_t patch_window = 11;  ///< px, odd
  std::uint8_t patch_margin = 4;   ///< px kept around it
  bool keeps_templates = true;     ///< as in PatchLimits: 1.6 kB a patch for a shorter search
  /// Keeps the frame before, in which a patch that no longer looks as it did is followed.
  bool keeps_previous = true;
  /// Keeps a copy of the frame; without it (and with keeps_previous off) the frame is read during `update` only, and
  /// must be planar.
  bool copies_frame = true;
  std::uint16_t thumbnail_width =
      96;  ///< of the small pictures in which a fast or a lost head is found, at most
  std::uint16_t free_parameters = 0, samples_per_point = 0;  ///< as in EstimatorLimits
  bool samples_vertices = true;                            ///< as in EstimatorLimits
  std::uint16_t rejection_sample = 256;                  ///< as in EstimatorLimits
  const ForceRejection* rejection = &kForceRejection;    ///< as in EstimatorLimits
  PersonalFieldLimits personal_field;                                       ///< as in EstimatorLimits
  /// A side, over the chart, in which texture is noted for a mesh that follows the view (EstimatorOptions::mesh_operations);
  /// a byte each. 0: it follows the view alone.
  std::uint8_t texture_cells = 0;

  static constexpr int kMostKeyFrames = 8;
};

/// For a microcontroller: 320 x 240, looked at through a moving region of 192 x 192 that is read from the caller's
/// frame during `update`, 64 patches. With the built-in face and its expressions free: 242 KiB.
constexpr TrackerLimits profile_s() {
  TrackerLimits l;
  l.region_width = l.region_height = 192;
  l.patches = 48;
  l.key_patches = 16;
  l.key_frames = 2;
  l.patch_margin = 2;
  l.keeps_previous = l.copies_frame = l.keeps_templates = false;
  l.thumbnail_width = 48;
  l.free_parameters = 40;
  l.samples_per_point = 44;
  l.samples_vertices = false;
  return without_rejection(l);
}

/// For a desktop or a fast board: 640 x 480, 300 patches, 2,048 vertices.
constexpr TrackerLimits profile_l() {
  TrackerLimits l;
  l.width = 640;
  l.height = 480;
  l.patches = 220;
  l.key_patches = 80;
  l.vertices = 2048;
  return l;
}

struct TrackerOptions {
  EstimatorOptions estimator;
  const std::uint8_t* is_free = nullptr;  ///< flag a parameter; null: the expressions
  float curve_spacing_mm = 4;             ///< of edge points along lids, lips and brows
  float marker_exclusion_px = 8;          ///< no patch is captured within this distance of a marker
  float min_correlation = 0.55f;          ///< with the captured patch, in the last round; 0.1 less before
  float forward_backward_px = 0.7f;       ///< at 320 px of width, for the steps from frame to frame
  /// Of predicting, looking and solving a frame. From two on some of many points may go ahead in the first (scouts), with
  /// one round more where these knew nothing of what the others saw.
  std::uint8_t rounds = 2;
  float key_angle_rad = 0.35f;  ///< a key frame is kept when the head has turned so far from all others
};

/// Follows one model through a stream of frames of one size. All memory is taken at creation. Each surface patch is
/// compared with what it looked like in the frame it was captured in, as the model predicts it to be warped, so that it
/// does not drift; where that fails it is followed from the frame before, for a while and with less weight.
///
/// Patches are captured in frame 0 and in key frames: whenever the head has turned away from all of them and the track
/// is good, newly visible surface gets patches, and points that are still found by their first template get a second
/// one, taken where the first one put it. Frame 0's patches stay for ever.
class Tracker {
 public:
  Tracker() = default;
  Tracker(const Tracker&) = delete;
  Tracker& operator=(const Tracker&) = delete;

  void lay_out(Arena& arena, const Model& model, const TrackerLimits& limits);

  /// Starts on `frame` (frame 0) from a known state; patches are captured in it. Markers are image points (px) of this
  /// frame, at most limits.markers of them, cast onto the posed mesh; one that misses keeps its distance from the
  /// nearest surface point.
  /// \return bad_argument, size_mismatch, capacity (markers), too_few_points (no texture to hold on to), or a status of
  ///         Estimator::start. The tracker is then not started.
  Status start(const FrameView& frame, const Camera& camera, const Pose& pose, const float* q,
               Span<const Vec2> markers, const TrackerOptions& options);

  /// The next frame. \return not_started, bad_argument, size_mismatch, stale_frame (neither its time nor its sequence
  ///         number is beyond the last frame's: it came twice, or late); the state is then as before.
  Status update(const FrameView& frame, FrameResult* result);

  const TrackerLimits& limits() const { return limits_; }
  /// Of the last frame; after `start` that of frame 0: tracking, at the pose given.
  const FrameResult& result() const { return result_; }
  Estimator& estimator() { return estimator_; }
  /// Image position of marker k at the present state; false when it is behind the camera.
  bool marker(std::size_t k, Vec2* x);

  /// Patches there may be, used or not.
  std::size_t patch_count() const { return slot_count_; }
  /// Where patch k was seen in the last frame; false when it was not, or was rejected.
  bool patch(std::size_t k, Vec2* x) const;
  /// Key frames kept, frame 0 included.
  std::size_t key_frame_count() const;
  /// What was looked at in the last frame.
  PixelBox region() const;

 private:
  static constexpr std::uint16_t kNoSlot = 0xFFFF;

  /// A template, and, if it is the first of its surface point, what was seen of that point.
  struct Slot {
    std::uint16_t id = 0;            // of its surface point
    std::uint16_t owner = 0;         // the first template of the same point: this slot, or it is a second one
    std::uint16_t second = kNoSlot;  // of an owner: its second template
    std::uint16_t observation = 0;   // of this round
    Mat2 reference;                  // dx/d(u,v) where the template was captured
    Vec2 seen, expected;             // last frame: where it was found, where the search for it began
    Vec2 residual;                   // what the model could not explain of that
    Vec2 looked_at;                  // the prediction when it was last looked for
    Mat2 looked_with;                // and its dx/d(u,v)
    bool is_used = false, was_seen = false;
    bool is_awaited = false,
         is_first_pass = false;          // not looked at in this frame yet; looked at ahead of the others
    std::uint8_t frames_apart = 0;  // since it last matched a template
  };

  struct KeyFrame {
    View view;
    Vec3 direction;           // to the camera, in the model's axes
    PixelBox box;             // of the model, in the small picture
    std::uint32_t last_near;  // the frame in which it was last the nearest
    bool is_used;
  };

  // seeding.cpp
  Status place_markers(Span<const Vec2> markers);
  void mark_visible_cells(int cell_px);
  void clear_cells_in_use(int cell_px);
  bool is_far_from_others(Vec2 x, float min_distance);
  bool seed(Vec2 x, float min_distance, std::size_t slot);
  void seed_patches(std::size_t first, std::size_t end);
  void release_slot(std::size_t slot);

  // key_frames.cpp
  void keep_key_frame();
  bool is_worth_keeping() const;
  std::size_t nearest_key(Vec3 direction, float* cosine) const;
  std::size_t free_key();
  void capture_key(std::size_t key);
  std::size_t refresh_templates(std::size_t first, std::size_t end);
  void describe_key(std::size_t key);
  std::uint8_t* thumbnail_of(std::size_t key) const;
  PixelBox model_box() const;
  void expect_motion();

  // looking.cpp
  enum class Look : std::uint8_t { none, full, follow_only };
  bool look_ahead();
  Look needed_look(const Slot& slot, const Prediction& p, int round) const;
  std::size_t look_and_solve(int round);
  void look_at(std::size_t k, const Prediction& p, int round);
  Observation look(std::size_t k, const Prediction& p, int round);
  Observation follow(std::size_t k, const Prediction& p);
  PatchResult match(std::size_t k, const Prediction& p, int round);
  bool is_in_region(Vec2 x) const;
  int first_level() const;
  void note_seen();

  // surface_texture.cpp
  void start_texture();
  std::uint8_t& texture_at(Vec2 uv) const;
  static float texture_score(void* context, Vec2 uv);
  void note_texture(std::uint32_t part, std::uint32_t parts);

  Status check_frame(const FrameView& frame) const;
  bool is_stale(const FrameView& frame) const;
  Status look_at_region(const FrameView& frame);

  Estimator estimator_;
  Pyramid current_, previous_;
  PatchTracker patches_;
  TrackerLimits limits_ = without_rejection(TrackerLimits{});
  TrackerOptions options_;
  FrameResult result_;
  Slot* slots_ = nullptr;
  std::size_t slot_count_ = 0;
  Observation* observations_ = nullptr;
  std::size_t observation_count_ = 0,
              point_observation_count_ = 0;  // all; those of patches, which come first
  EdgeSearch* edges_ = nullptr;
  std::uint16_t* prediction_of_ = nullptr;  // by id of a surface point
  std::uint16_t* marker_ids_ = nullptr;
  Vec3* marker_offsets_ = nullptr;  // from the surface, mm
  std::size_t marker_count_ = 0;
  Corner* corners_ = nullptr;
  std::uint8_t *cells_ = nullptr, *scratch_ = nullptr, *texture_ = nullptr;
  std::size_t scratch_bytes_ = 0;
  Vec2 expected_shift_;            // of the model since the last frame, or since the view proposed
  Vec2 origin_, previous_origin_;  // of the region in the frame, whole pixels
  int thumbnail_factor_ = 1, thumbnail_width_ = 0, thumbnail_height_ = 0;
  std::uint16_t* thumbnail_line_ = nullptr;
  // Small pictures of the whole frame: this one, the last that could be trusted, and the key frames'.
  std::uint8_t *thumbnail_ = nullptr, *trusted_thumbnail_ = nullptr, *key_thumbnails_ = nullptr;
  PixelBox last_box_;
  KeyFrame keys_[TrackerLimits::kMostKeyFrames + 1] = {};
  std::uint32_t frame_ = 0;
  int bad_frames_ = 0;
  // How far points were from where they were looked for in the last frame: by the prediction, and after scouts.
  float moved_px_ = 0, left_px_ = 0;
  bool has_first_pass_ = false;
  float shift_px_ = 0;  // how far the small pictures say the model has moved
  std::int64_t last_time_ns_ = 0;
  std::uint32_t last_sequence_ = 0;
  bool started_ = false, notes_texture_ = false;
};

}  // namespace pliant
