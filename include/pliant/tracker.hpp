#pragma once
/// \file tracker.hpp
/// The composition: frames + vision + core -> pose, expression and surface points, frame by frame.
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "pliant/arena.hpp"
#include "pliant/camera.hpp"
#include "pliant/coarse_translation.hpp"
#include "pliant/estimator.hpp"
#include "pliant/frame.hpp"
#include "pliant/model.hpp"
#include "pliant/tracker_options.hpp"
#include "pliant/tracker_profiles.hpp"

namespace pliant {

/// create_in refuses limits without room for the model's base mesh (arena.hpp).
inline bool are_usable(const Model& model, const TrackerLimits& limits) {
  return is_usable(model) && is_usable(limits) && limits.vertices >= model.base_uv().count;
}

/// Tracks one model through a stream of frames of one size. All memory is taken at creation; `lay_out` is called by
/// `create_in` and `measured_bytes` (arena.hpp).
///
/// Templates are captured at surface points in frame 0 and in key frames. Each is matched in every frame,
/// warped as the model predicts, so that it does not drift. A point whose template is not found is tracked
/// from the previous frame, for some frames and with less weight. A key frame is kept when the track is good
/// and the head has turned away from all key frames, or is 1.5 times as large or as small: newly visible surface gets
/// templates, and points that are still found get a second one. Frame 0's templates stay.
///
/// With a model that has learnt tables (pliant learn), or a print (the keypoints of its albedo), no start is
/// needed: while there is no track, `update` searches the frame for the face, or the printed surface, and
/// starts by itself. A running track is verified every few frames. A track that is lost, or that is wrong, is
/// given up, and the next frames are searched. Where the same person is found, identity, landmark offsets,
/// markers and camera stay; templates and key frames are new. Another person has no markers. Not every person is told from
/// another; where an alignment takes several frames (profile S), hardly any is (docs/algorithms.md, section 7.15).
///
/// Every other start needs a frame, which becomes frame 0. A start checks frame, counts, names, arrays and
/// options first. If one of those is wrong, nothing changes. If the start fails later (in the fit, the camera, the pose or
/// the texture), the tracker is not started, `is_started` is false, and the next frame may have any time. Where there is detection,
/// that frame is searched with the camera and the options of this start; if this one returned bad_argument, of the start before.
///
/// Costs as multiples of a tracked frame's instructions, with profiles M and S on a PC: a start from a pose or a state 4 and 8,
/// from a box about 8 and 13, from 68 landmarks 13 and 31, a frame that is searched 8 and 3.
/// `pliant plan` has the instructions of frames that are searched and of starts by search.
class Tracker {
 public:
  Tracker() = default;
  Tracker(const Tracker&) = delete;
  Tracker& operator=(const Tracker&) = delete;

  /// Takes its memory from the arena; called by create_in and measured_bytes (arena.hpp).
  void lay_out(Arena& arena, const Model& model, const TrackerLimits& limits);

  /// Ends the track, if there is one, and forgets the person: the next `update` searches for the face or
  /// printed surface. A new tracker does so with default options. The next frame may have any time.
  /// \param start    camera or focal length, if known.
  /// \param options  of the tracks that follow.
  /// \return not_found (the limits name no detection, or the model has no tables for it), bad_argument (the
  ///         camera, the focal length or an option): nothing has changed.
  Status start_by_detection(const StartOptions& start = {}, const TrackerOptions& options = {});

  /// Starts from a known pose.
  /// \param q        all parameters, in the model's order, which are clamped to their limits; null: all 0.
  /// \param markers  image positions in `frame`, px, at most TrackerLimits::markers. Each is cast onto the posed mesh;
  ///                 one that misses it keeps its offset from the nearest surface point.
  /// \return bad_argument, size_mismatch, capacity (markers), too_few_points (fewer than 6 templates found texture,
  ///         or fewer than 8 with the points on edges: no frame would be tracked), or a status of Estimator::start.
  Status start_from_pose(const FrameView& frame, const Camera& camera, const Pose& pose, const float* q,
                         const TrackerOptions& options = {}, Span<const Vec2> markers = {});

  /// Starts from landmarks, at least 4 and at most TrackerLimits::start_points. Person, pose and, where it is
  /// unknown, the focal length are fitted to them. Residuals of the fit that noise does not explain become
  /// landmark offsets: `landmark` then gives the place that this person has. With learnt tables and fewer than 12 points the face
  /// is aligned in the frame from there; where that is verified, pose, person and landmarks are those of the alignment.
  /// \return not_found (a name that the model does not have), capacity, too_few_points, underdetermined (points on one
  ///         line, or within 4 px), the other statuses of Fitter::fit, and those of start_from_pose.
  Status start_from_landmarks(const FrameView& frame, Span<const NamedPoint> points,
                              const StartOptions& start = {}, const TrackerOptions& options = {},
                              Span<const Vec2> markers = {});

  /// Starts with the neutral model, frontal, in a face detector's box: upper left corner and size, px
  /// (StartOptions::box). With learnt tables the face is then aligned in the frame. A box tells no roll: of a head that is turned
  /// in the picture by more than about 40 degrees start from landmarks, a pose or by detection.
  /// \return bad_argument (a size that is not positive, a corner or size beyond a million px), and the
  ///         statuses of start_from_pose.
  Status start_from_box(const FrameView& frame, Vec2 corner, Vec2 size, const StartOptions& start = {},
                        const TrackerOptions& options = {}, Span<const Vec2> markers = {});

  /// Starts from what `save` wrote. Without landmark offsets (count 0) landmarks are where the model has them. Where limits have
  /// second looks and there are no markers, the face, which may have moved a little, is aligned in the frame, as the state's person
  /// with its offsets. Else the frame must show it where it was saved.
  /// \return bad_argument (arrays of another size than the model's, an offset beyond 10^7 mm), and the statuses of
  ///         start_from_pose.
  Status start_from_state(const FrameView& frame, const SavedState& state, const TrackerOptions& options = {},
                          Span<const Vec2> markers = {});
  /// Copies the state of the last frame; while lost, that of the last good frame. The caller gives the arrays;
  /// landmark_offsets may have count 0 and is then left out.
  /// \return not_started, bad_argument (null, or arrays of another size than the model's): nothing is written.
  Status save(SavedState* state) const;

  /// Tracks the next frame, or searches it while there is no track (FrameResult::is_searching). A face that is found is
  /// tracked from this frame on.
  /// \return not_started (no track and no detection), bad_table, bad_checksum and their like (detector, aligner or print is
  ///         damaged; bad_table also for a model that lacks landmarks of the aligner), bad_argument, size_mismatch,
  ///         stale_frame (neither the time nor the sequence number is later than the last frame's): nothing has changed then. Or
  ///         capacity: what was found cannot be tracked within the limits (free_parameters, samples_per_point, mesh_following).
  Status update(const FrameView& frame, FrameResult* result);

  // Preconditions of what follows: the tracker was laid out, and pointers for results are not null. Without a layout, what returns
  // a Status returns not_started, and is_started is false.
  const TrackerLimits& limits() const;  ///< Limits of the layout.
  /// Names of parameters and landmarks, and how many there are.
  const Model& model() const;
  /// True while there is a track: after a start of any kind, until the track is given up.
  bool is_started() const;
  /// Counts the tracks, from 1: another number where a track has begun, by a start, after a loss, or in the middle of a film
  /// (docs/algorithms.md, section 7.15). What a program gathers over frames, as a neutral gaze, may begin anew there. 0 before the
  /// first.
  std::uint32_t track_number() const;
  /// Counts the persons, from 1: the same number where a track begins as the same person. A start of the caller's counts as of
  /// another one, and so does a track that has found the shape of the same person anew. A print that is found by itself does not
  /// count.
  std::uint32_t person_number() const;
  /// Of the last frame; after a start that of frame 0: tracking at the start's pose, or degraded if that is turned far or shows no
  /// face. Before the first frame and after a start that failed: lost, and whether the next frame is searched.
  const FrameResult& result() const;
  /// Loops of the last frame; 0 for one without a track. `pliant plan` prints the bounds.
  const FrameWork& work() const;
  /// The camera of the start, with the focal length that it found. Its focal length is 0 while there is no track.
  const Camera& camera() const;
  /// The estimator, for access to its full state. Only while there is a track. Between frames Estimator::predict and
  /// Estimator::refresh_vertices change what the next frames take as hidden, and so their results; other queries change nothing.
  Estimator& estimator();

  /// All parameters at the state of the last frame, in the model's order. Valid until the next call that
  /// changes it. While there is no track: those of the last one, or of a start that failed since.
  Span<const float> parameters() const;
  /// Parameter at the state of the last frame, in the model's unit, from Parameter::minimum to maximum (`jawOpen`: 0 to 0.45 rad).
  /// ARKit's coefficient is the value over the maximum; its `browInnerUp` and `cheekPuff` are two parameters each, ...Left and
  /// ...Right. \return not_started, not_found.
  Status parameter(const char* name, float* value) const;
  /// Image position (px) of a landmark at the state of the last frame, with its offset.
  /// \return not_started, not_found, underdetermined (behind the camera): x is untouched.
  Status landmark(const char* name, Vec2* x);
  Status landmark(std::size_t index, Vec2* x);  ///< The same by index.
  /// The same: a literal 0 is an index, not a null name.
  template <class Integer, class = std::enable_if_t<std::is_integral_v<Integer>>>
  Status landmark(Integer index, Vec2* x) {
    return landmark(static_cast<std::size_t>(index), x);
  }
  /// Gives landmarks the offsets that put them at these image positions in the last frame. Landmarks at the
  /// same (u,v) get the same offset; others keep theirs. No second look (TrackerLimits::second_look) changes them from then on; a
  /// later start of the caller or of another person does.
  /// \return not_started, not_found, bad_argument: nothing has changed then.
  Status place_landmarks(Span<const NamedPoint> points);

  /// Image position (px) of marker k at the present state; false when there is no such marker or it is behind the camera.
  bool marker(std::size_t k, Vec2* x);

  /// Templates that there is room for, used or not.
  std::size_t patch_count() const;
  /// Where template k was found in the last frame, px; false when it was not or was rejected, and for k >= patch_count().
  bool patch(std::size_t k, Vec2* x) const;
  /// Key frames kept, frame 0 included; 0 while there is no track.
  std::size_t key_frame_count() const;
  /// Part of the last frame in which templates were matched, px.
  PixelBox region() const;

 private:
  struct Impl;
  Impl* impl_ = nullptr;  // in the arena
};

}  // namespace pliant
