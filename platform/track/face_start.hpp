#pragma once
/// \file face_start.hpp
/// How a track begins and ends without help: search of the frame, alignment, verification of the running track
/// (docs/algorithms.md, section 7.15).
#include <cstddef>
#include <cstdint>

#include "pliant/tracker.hpp"
#include "track/face_modules.hpp"
#include "track/landmark_offsets.hpp"
#include "track/start_fit.hpp"

namespace pliant {

/// Tuning of starts and verification. Each constant: unit, reason, experiment.
struct FaceStartTuning {
  /// Probability that the detector gives a box, at least, for an alignment. Low: alignment and its own verification decide.
  float least_detection = 0.2f;
  /// Probability by the detector above which a search over several frames stops for an alignment before it is complete.
  float sure_detection = 0.9f;
  /// Probability that the alignment is right, at least, for a start. Round value, not tuned.
  float least_start = 0.7f;
  /// Odds of the detector times odds of the alignment, at least, for a start. Of 428 alignments on 172 photographs without
  /// faces, which were shown with drift and noise, the best has 83; of 170 held-out portraits the worst has 15,000.
  float least_start_odds = 150;
  /// Below these odds a start waits until the candidate has been accepted in so many frames. Round values, not tuned.
  float sure_start_odds = 10000;
  int doubtful_frames = 3;
  /// Estimated landmark error, at most, of an alignment with the identity of the last person, fraction of the eyes'
  /// distance. Above it another person is fitted.
  float most_known_error = 0.06f;
  /// Root mean square distance, in standard deviations of the parameters, between the identity as it was aligned first and as it
  /// is aligned now, from which on a face is another person's; and the cosine of the turn away from the camera up to which both
  /// alignments tell: 20 degrees. Of portraits, rendered heads and a recorded face below this angle (docs/experiments.md) 151
  /// pairs of one person have at most 0.21, and 87 % of 598 pairs of two people more than 0.23.
  float most_identity_distance = 0.23f, least_frontal = 0.94f;
  /// Work of the search in a frame, cells, from which on a frame has alignments besides.
  std::uint32_t cells_for_both = 12000;
  /// Cells of the search that cost as much as a step of an alignment. On the Cortex-M7 a step takes 5 million instructions and
  /// so many cells 4; on a PC half as much, where the default search of 24,000 cells leaves three alignments of six steps.
  std::uint32_t cells_a_step = 1300;
  /// Detections that wait for an alignment, count, at most. Round value, not tuned.
  std::size_t most_candidates = 8;
  /// Two boxes are of one face if their centres are nearer than this fraction of the larger side, and the larger side is below
  /// this multiple of the smaller one. Not tuned.
  float same_face_distance = 0.5f, same_face_ratio = 1.6f;
  /// Frames from a check of a running track to the next: until the person counts as known, or while the estimated landmark error
  /// is above `doubtful_error`; and else. After a bad check the next frame is checked. A check costs a fifth of a frame. With 6
  /// the fault films are as with 2, with 6 whatever the error it took up to 10 frames more until a face was right again.
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
  /// Cosine of the head's turn away from the camera beyond which a tracked frame is degraded: 50 degrees. Of the built-in face's
  /// landmarks on the far side that a frontal face shows, a third are then seen; 11 of 19 at 40 degrees, 1 of 19 at 60.
  float least_facing = 0.643f;
  /// Bad frames in a row after which a track is given up: three until it counts as lost, one for the last good frame, and one
  /// more for each key frame.
  int most_bad_frames = 4;
  /// Probability that an alignment is right, at least, for a start of the caller's to be moved there. Round value.
  float least_refined = 0.5f;
  /// Points of a start from landmarks from which on the picture is not asked, count.
  std::size_t enough_points = 12;
};
inline constexpr FaceStartTuning kFaceStartTuning{};

/// What a tracker is doing.
enum class FacePhase : std::uint8_t {
  searching,  ///< there is no track: a part of the frame is searched
  aligning,   ///< there is no track: candidates of the search are aligned
  tracking,   ///< there is a track: it is checked every few frames while it is good
};

/// The person whom the tracker knows. The arrays are the tracker's.
struct KnownPerson {
  bool is_known = false;
  Camera camera;
  float* q = nullptr;  // all parameters
  LandmarkOffsets* offsets = nullptr;
};

/// Input of a frame's search.
struct SearchInput {
  const FrameView& frame;
  Span<unsigned char> block;  // the memory of the tracking, which is not in use
  const StartOptions& options;
};

/// Searches, aligns and verifies, frame by frame. The tracker makes the tracks.
class FaceStart {
 public:
  /// Precondition: the limits name a detection, and the model has its tables.
  void lay_out(Arena& arena, const Model& model, const TrackerLimits& limits);

  /// Whether the work of searching and aligning is spread over frames, because the limits allow little a frame.
  bool spreads_work() const { return work_ < kFaceStartTuning.cells_for_both; }
  bool has_track() const { return phase_ == FacePhase::tracking; }

  /// The track has ended: the next frame is searched from the beginning.
  void begin_search();
  /// The track has been given up. \param last  where the face was in its last good frame. Where a search takes several frames,
  ///                                         the next one begins there: light that changes at once ends a track, and the face stays.
  void end_track(const FaceBox& last) { last_ = last; }
  /// A track has begun; the memory of the search is the track's now. `conclude` follows in the same frame.
  /// \param landmark_error  estimate; 0: unknown.
  void begin_track(float landmark_error);

  /// Searches in this frame, as much as the limits allow. If a face is found `start` and the person are set; the offsets
  /// are pending where the person is new.
  /// \return not_found: nothing yet; or what detector and aligner say of their tables.
  Status search(const SearchInput& input, KnownPerson* person, StartPose* start, float* landmark_error);

  /// A start of the caller's begins: it may be of another person.
  void forget_reference() { has_reference_ = false; }
  /// Moves a start of the caller's to where the picture shows the face, if that is verified; else nothing changes. The person's parameters are input
  /// and output.
  /// \param box  of the face, if the start is known roughly; null: it is near.
  void refine(const SearchInput& input, const FaceBox* box, KnownPerson* person, StartPose* start,
              float* landmark_error);

  /// Ends a frame of a track: checks it where a check is due, and writes landmark_error and whether
  /// it is degraded.
  /// \param bad_frames  of the track in a row, this one included. \param has_room  false: a check that is due
  ///                    waits. \param scratch  unused memory.
  /// \return false: the track is given up.
  bool conclude(const FrameView& frame, Estimator& estimator, int bad_frames, bool has_room,
                Span<unsigned char> scratch, FrameResult* result);
  /// Whether `conclude` checks the track if the frame is good and has room.
  bool is_check_due() const;
  /// Whether the check that is due comes before other rare work: the last one was bad, or the alignment made this start and it
  /// is not confirmed yet. Where such checks wait too, 47 rendered heads with faults (docs/experiments.md) are wrong in
  /// 742 instead of 637 frames with profile S; where those of a start from the caller's landmarks hurry as well, heads
  /// that turn have 2.4 instead of 2.0 degrees at 95 %.
  bool is_check_urgent() const {
    return bad_checks_ > 0 || (is_aligned_ && !has_confirmed() && is_check_due());
  }
  /// Whether enough checks were good for the person to be known.
  bool has_confirmed() const { return good_checks_ >= kFaceStartTuning.checks_of_known_person; }

 private:
  static constexpr std::size_t kMostCandidates = kFaceStartTuning.most_candidates;

  void begin_search_again() {
    phase_ = FacePhase::searching;
    candidate_count_ = next_candidate_ = 0;
    times_seen_ = steps_left_ = 0;
  }
  Status lay_out_search(Span<unsigned char> block);
  Status run_detector(const FrameView& frame);
  void add_candidate(const DetectedFace& face);
  enum class Answer : std::uint8_t { no, later, yes };
  enum class Whom : std::uint8_t { known, anybody, another };  // as whom a candidate is aligned
  Answer align(const SearchInput& input, int* steps, KnownPerson* person, StartPose* start,
               float* landmark_error);
  Status begin_alignment(const SearchInput& input, const KnownPerson& person);
  float evidence_of(const AlignedFace& face) const;
  bool is_accepted(const AlignedFace& face) const;
  void go_on();
  Whom first_question() const;
  static bool is_frontal(const AlignedFace& face);
  bool may_be_known(const AlignedFace& face) const;
  void set_person(const StartOptions& options, const AlignedFace& face, KnownPerson* person,
                  StartPose* start);
  void tell_worth(const View& view, FrameResult* result) const;
  bool check(const FrameView& frame, Estimator& estimator, Span<unsigned char> scratch);

  const FaceModules* modules_ = nullptr;
  Model model_;
  FaceDetectorLimits limits_;
  std::uint32_t work_ = 0;  // a frame, cells
  FacePhase phase_ = FacePhase::searching;

  FaceDetector* detector_ = nullptr;  // in the block, while there is no track
  FaceAligner* aligner_ = nullptr;
  bool is_search_complete_ = true;  // the next call begins anew
  bool is_of_one_frame_ = false;    // the candidates are, with all their sizes
  DetectedFace candidates_[kMostCandidates];
  std::size_t candidate_count_ = 0, next_candidate_ = 0;
  Whom whom_ = Whom::another;  // of the next candidate
  int steps_left_ = 0;         // of its alignment; 0: it has not begun
  int times_seen_ = 0;         // frames in which the next candidate was accepted
  float* q_ = nullptr;          // all parameters, of the last alignment
  float* reference_ = nullptr;  // the same of the known person's first one
  bool has_reference_ = false;  // which was frontal
  std::uint8_t* is_expression_ = nullptr;
  Span<Vec2> landmarks_;

  FaceBox last_;  // where the next search begins; side 0: with the smallest faces
  int most_bad_frames_ = 0;
  int frames_since_check_ = 0, bad_checks_ = 0, good_checks_ = 0;
  bool is_aligned_ = false;  // the track began where an alignment put it, not at the caller's landmarks
  float landmark_error_ = 0;
};

/// Bytes that a search takes of the memory of the tracking, and a check of unused memory.
std::size_t search_bytes(const Model& model, const TrackerLimits& limits);
std::size_t check_bytes(const Model& model, const TrackerLimits& limits);

}  // namespace pliant
