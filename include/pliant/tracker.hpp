#pragma once
/// \file tracker.hpp
/// The composition: frames + vision + core -> pose, expression and surface points, frame by frame.
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/coarse_translation.hpp"
#include "pliant/corners.hpp"
#include "pliant/estimator.hpp"
#include "pliant/frame.hpp"
#include "pliant/model.hpp"
#include "pliant/patch_tracker.hpp"
#include "pliant/pyramid.hpp"
#include "pliant/tracker_limits.hpp"

namespace pliant {

class EdgeSearch;

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

/// A landmark by the model's name for it (`ibug30`, `nose_tip`, ...), and where it is seen.
struct NamedPoint {
  const char* name = nullptr;
  Vec2 x;  ///< px
};

/// What is known of a start besides landmarks or a box.
struct StartOptions {
  float focal_px = 0;  ///< focal length, px; 0: unknown, then landmarks fit it and a box assumes it
  const Camera* camera = nullptr;  ///< intrinsics and lens, if known; they replace focal_px
  bool keeps_landmark_offsets =
      true;  ///< false: `landmark` tells where the model has a landmark, not the person
};

/// A tracker's state for another start: after a pause, or in another process. The arrays are the caller's.
struct SavedState {
  Camera camera;
  Pose pose;
  Span<float> parameters;       ///< all of the model's, in its order
  Span<Vec3> landmark_offsets;  ///< mm, one for each of the model's landmarks, in its order
};

/// Tracks one model through a stream of frames of one size. All memory is taken at creation; `lay_out` is called by
/// `create_in` and `measured_bytes` (arena.hpp).
///
/// Templates are captured at surface points in frame 0 and in key frames. Each is matched in every frame, warped as the
/// model predicts, so that it does not drift. A point whose template is not found is tracked from the previous frame, for
/// some frames and with less weight. A key frame is kept when the track is good and the head has turned away from all
/// key frames: newly visible surface gets templates, and points that are still found get a second one. Frame 0's templates
/// stay.
///
/// Every start needs a frame, which becomes frame 0. A start checks frame, counts, names and arrays first: if one of
/// those is wrong, nothing has changed. If it fails later (the fit, the pose, the texture), the tracker is not started;
/// `is_started` tells.
class Tracker {
 public:
  Tracker() = default;
  Tracker(const Tracker&) = delete;
  Tracker& operator=(const Tracker&) = delete;

  void lay_out(Arena& arena, const Model& model, const TrackerLimits& limits);

  /// Starts from a known pose.
  /// \param q        all parameters, in the model's order; null: all 0.
  /// \param markers  image positions in `frame`, px, at most TrackerLimits::markers. Each is cast onto the posed mesh;
  ///                 one that misses it keeps its offset from the nearest surface point.
  /// \return bad_argument, size_mismatch, capacity (markers), too_few_points (fewer than 6 templates found texture), or a
  ///         status of Estimator::start.
  Status start_from_pose(const FrameView& frame, const Camera& camera, const Pose& pose, const float* q,
                         const TrackerOptions& options = {}, Span<const Vec2> markers = {});

  /// Starts from landmarks, at least 4 and at most TrackerLimits::start_points. Person, pose and, where it is unknown, the
  /// focal length are fitted to them. Residuals of the fit that noise does not explain become landmark offsets: `landmark`
  /// then gives the place that this person has.
  /// \return not_found (a name that the model does not have), capacity, too_few_points, underdetermined (points on one
  ///         line, or within 4 px), the other statuses of Fitter::fit, and those of start_from_pose.
  Status start_from_landmarks(const FrameView& frame, Span<const NamedPoint> points,
                              const StartOptions& start = {}, const TrackerOptions& options = {},
                              Span<const Vec2> markers = {});

  /// Starts with the neutral model, frontal, in a face detector's box: upper left corner and size, px.
  /// \return bad_argument (a size that is not positive), and the statuses of start_from_pose.
  Status start_from_box(const FrameView& frame, Vec2 corner, Vec2 size, const StartOptions& start = {},
                        const TrackerOptions& options = {}, Span<const Vec2> markers = {});

  /// Starts from what `save` wrote. Without landmark offsets (count 0) landmarks are where the model has them.
  /// \return bad_argument (arrays of another size than the model's), and the statuses of start_from_pose.
  Status start_from_state(const FrameView& frame, const SavedState& state, const TrackerOptions& options = {},
                          Span<const Vec2> markers = {});
  /// Copies the state of the last frame; while lost, that of the last trusted frame. The caller gives the arrays;
  /// landmark_offsets may have count 0 and is then left out.
  /// \return not_started, bad_argument (null, or arrays of another size than the model's): nothing is written.
  Status save(SavedState* state) const;

  /// The next frame.
  /// \return not_started, bad_argument, size_mismatch, stale_frame (neither its time nor its sequence number is beyond the
  ///         last frame's: it came twice, or late). Nothing has changed then.
  Status update(const FrameView& frame, FrameResult* result);

  const TrackerLimits& limits() const { return limits_; }
  /// Names of parameters and landmarks, and how many there are.
  const Model& model() const { return estimator_.model(); }
  bool is_started() const { return started_; }
  /// Of the last frame; after a start that of frame 0: tracking, at the pose of the start.
  const FrameResult& result() const { return result_; }
  /// The camera of the start, with the focal length that it found.
  const Camera& camera() const { return estimator_.camera(); }
  Estimator& estimator() { return estimator_; }

  /// All parameters at the state of the last frame, in the model's order. Valid until the next call that changes it.
  Span<const float> parameters() const { return estimator_.parameters(); }
  /// Parameter at the state of the last frame. \return not_started, not_found.
  Status parameter(const char* name, float* value) const;
  /// Image position (px) of a landmark at the state of the last frame, with its offset.
  /// \return not_started, not_found, underdetermined (behind the camera): x is untouched.
  Status landmark(const char* name, Vec2* x);
  Status landmark(std::size_t index, Vec2* x);
  /// Gives landmarks the offsets that put them at these image positions in the last frame. Landmarks at the same (u,v) get
  /// the same offset; others keep theirs. \return not_started, not_found, bad_argument: nothing has changed then.
  Status place_landmarks(Span<const NamedPoint> points);

  /// Image position (px) of marker k at the present state; false when it is behind the camera.
  bool marker(std::size_t k, Vec2* x);

  /// Templates that there is room for, used or not.
  std::size_t patch_count() const { return slot_count_; }
  /// Where template k was found in the last frame, px; false when it was not, or was rejected.
  bool patch(std::size_t k, Vec2* x) const;
  /// Key frames kept, frame 0 included.
  std::size_t key_frame_count() const;
  /// Part of the last frame in which templates were matched.
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
         is_first_pass = false;     // not looked at in this frame yet; looked at ahead of the others
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

  // starts.cpp
  bool fits_model(const SavedState& state) const;
  Status check_start(const FrameView& frame, Span<const Vec2> markers) const;
  Status check_landmarks(Span<const NamedPoint> points) const;
  Status start_tracking(const FrameView& frame, const Camera& camera, const Pose& pose, const float* q,
                        const TrackerOptions& options, Span<const Vec2> markers);
  Status fit_to_landmarks(Span<const NamedPoint> points, const StartOptions& start, Camera* camera,
                          Pose* pose);
  void clear_offsets();

  void lay_out_tracking(Arena& arena, const Model& model);
  Status check_frame(const FrameView& frame) const;
  bool is_stale(const FrameView& frame) const;
  Status look_at_region(const FrameView& frame);

  // Last from start to start: what a start gave. The block is used by a start's fit, then by the tracking.
  float* start_q_ = nullptr;
  Vec3* landmark_offsets_ = nullptr;  // mm, a landmark
  unsigned char* block_ = nullptr;
  std::size_t block_bytes_ = 0;

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
