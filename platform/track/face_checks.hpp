#pragma once
// Verification of a running track of a face (docs/algorithms.md, section 7.15).
#include <cstddef>

#include "pliant/tracker.hpp"
#include "track/face_modules.hpp"

namespace pliant {

/// Tuning of the checks. Each constant: unit, reason, experiment.
struct FaceChecksTuning {
  /// Frames from one check of a running track to the next: until the person is known, or while the estimated landmark error is
  /// above `doubtful_error`; and otherwise. After a bad check the next frame is checked. A check costs a fifth of a frame. The
  /// fault films are tracked alike with 2 and with 6 for the second number. With 6 whatever the error, up to 10 frames more passed
  /// until a face was right again.
  int check_interval_frames = 2, known_interval_frames = 6;
  /// Work of a check with the built-in face's learnt tables, instructions as WorkCosts, counted with profiles S and M.
  float check_work = 2.5e6f;
  /// Estimated landmark error above which checks stay frequent, fraction of the eyes' distance: half of `most_landmark_error`.
  float doubtful_error = 0.04f;
  /// Bad checks in a row after which a track is given up. Not tuned.
  int most_bad_checks = 2;
  /// Probability that an alignment is right, below which a check is bad; and the same until the person counts as known. Round
  /// values, not tuned.
  float least_check = 0.1f, least_first_check = 0.5f;
  /// Good checks after which the person counts as known. Not tuned.
  int checks_of_known_person = 3;
  /// Fraction by which a check moves the estimate of the landmark error. Round value, not tuned.
  float error_rate = 0.3f;
  /// Estimated landmark error above which a tracked frame is degraded, fraction of the eyes' distance. Round
  /// value, not tuned.
  float most_landmark_error = 0.08f;
  /// AlignedFace::least_part below which a part of the face may be covered, standard deviations. What was covered at the start is a
  /// guess: a track that an alignment began is degraded until a check sees all parts, or estimates the landmark error at
  /// `doubtful_error` at most. Chosen on twelve people (docs/experiments.md, Covered parts).
  float least_part = -2;
  /// Checks in a row that leave a track degraded, after which it is given up where the limits have no second looks: what covered
  /// the face at the start may be gone, or the face is larger now. After each such track the number doubles, up to the most, until
  /// a check finds the track good. Of 4, 8, 16 and 32 chosen by films of portraits
  /// (docs/experiments.md, Searches and first checks).
  int poor_checks = 8, most_poor_checks = 256;
  /// Cosine of the head's turn away from the camera beyond which a tracked frame is degraded: 50 degrees. Of the built-in face's
  /// landmarks on the far side that a frontal face shows, a third are then seen; 11 of 19 at 40 degrees, 1 of 19 at 60.
  float least_facing = 0.643f;
  /// Bad frames in a row after which a track is given up, besides one for each key frame that there is room for: three until it
  /// counts as lost, one for the last good frame.
  int most_bad_frames = 4;
  /// Blind frames since the last good one, in which the pose had no inliers, after which a track is given up, besides one for each
  /// key frame in use: two from the last good frame, one from each key frame, one more from the last good frame. After a cut to
  /// another picture all are blind. With as many bad frames of any kind a track in changing exposure ended in the brightest frames
  /// and began anew on what was left of the face (docs/experiments.md, Films of portraits with faults).
  int most_blind_frames = 3;
};
inline constexpr FaceChecksTuning kFaceChecksTuning{};

/// Decides in which frames a track is checked, what its landmarks are worth, and when it is given up.
class FaceChecks {
 public:
  /// Precondition: the limits name a detection, and the model has its tables.
  void lay_out(const TrackerLimits& limits);

  /// Poor checks and tracks before do not count: the track is good, or the next one may be of somebody else, elsewhere.
  void forget_poor() {
    poor_ = 0;
    patience_ = kFaceChecksTuning.poor_checks;
  }
  /// A track has begun. `conclude` follows in the same frame.
  /// \param landmark_error  estimate; 0: unknown. \param is_of_known_person  whose shape an earlier start has found.
  void begin_track(float landmark_error, bool is_of_known_person);
  /// Ends a good frame of a track: checks it if told to, and writes landmark_error and whether it is degraded.
  /// \param checks  a check is due, and the frame has room for it. \param scratch  unused memory.
  /// \return false: the track is given up.
  bool conclude(const FrameView& frame, Estimator& estimator, bool checks, Span<unsigned char> scratch,
                FrameResult* result);
  /// Ends a bad frame of a track. \param bad_frames  in a row, this one included. \param key_frames  in use.
  /// \return false: the track is given up.
  bool endure(const FrameResult& result, int bad_frames, std::size_t key_frames);
  /// The face was seen in this frame: bad frames before it are not of the same row. `begin_track` and `conclude` do so too.
  void see() { blind_frames_ = 0; }
  /// Whether a good frame is to be checked.
  bool is_due() const;
  /// Whether the check that is due comes before other rare work: the last one was bad, or the alignment made this start and it
  /// is not confirmed yet. Where such checks wait too, 47 rendered heads with faults (docs/experiments.md) are wrong in
  /// 742 instead of 637 frames with profile S; where those of a start from the caller's landmarks hurry as well, heads
  /// that turn have 2.4 instead of 2.0 degrees at 95 %.
  bool is_urgent() const { return bad_ > 0 || (is_aligned_ && !has_confirmed() && is_due()); }
  /// Whether so many checks in a row have left the track degraded that another start may be better.
  bool has_stayed_poor() const { return poor_ >= patience_; }
  /// Whether the last check was bad: no face is seen where the track is.
  bool is_refuted() const { return bad_ > 0; }
  /// Whether enough checks were good for the person to be known.
  bool has_confirmed() const { return good_ >= kFaceChecksTuning.checks_of_known_person; }

 private:
  // Inlined: a call is 24 bytes more of a microcontroller's program.
  [[gnu::always_inline]] inline bool check(const FrameView& frame, Estimator& estimator,
                                           Span<unsigned char> scratch);

  const FaceModules* modules_ = nullptr;
  int most_bad_frames_ = 0, blind_frames_ = 0;
  int frames_since_ = 0, bad_ = 0, good_ = 0, poor_ = 0, patience_ = kFaceChecksTuning.poor_checks;
  bool is_aligned_ = false;  // the track began where an alignment put it, not at the caller's landmarks
  // No check since the alignment that gave the person's shape has seen all parts of the face.
  bool is_doubtful_ = false;
  float landmark_error_ = 0;
};

/// Bytes that a check, or the alignment of a bad frame without second looks, takes of unused memory.
std::size_t check_bytes(const Model& model, const TrackerLimits& limits);

}  // namespace pliant
