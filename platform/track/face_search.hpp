#pragma once
// How a track begins without help: search of the frame, alignment of what it finds (docs/algorithms.md, section 7.15).
#include <cstddef>
#include <cstdint>

#include "pliant/tracker.hpp"
#include "track/face_candidates.hpp"
#include "track/face_modules.hpp"
#include "track/known_person.hpp"
#include "track/start_fit.hpp"

namespace pliant {

/// Tuning of the search. Each constant: unit, reason, experiment.
struct FaceSearchTuning {
  /// Probability by the detector above which a search over several frames stops for an alignment before it is complete. Round
  /// value, not tuned.
  float sure_detection = 0.9f;
  /// Probability that the alignment is right, at least, for a start. Round value, not tuned.
  float least_start = 0.7f;
  /// Odds of the detector times odds of the alignment, at least, for a start. Of 428 alignments on 172 photographs without
  /// faces, which were shown with drift and noise, the best has 83; of 170 held-out portraits the worst has 15,000.
  float least_start_odds = 150;
  /// Below these odds a start waits until the candidate has been accepted in so many frames. Round values, not tuned. A face that
  /// is turned in the picture must reach them: the verification has learnt upright text alone. Of 300 pages of text, turned, the
  /// best has 5,000 (docs/experiments.md, Faces at any roll).
  float sure_start_odds = 10000;
  int doubtful_frames = 3;
  /// Least probability of the contrary, so that odds are finite: 10,000 at most. Round value, not tuned.
  float least_contrary = 1e-4f;
  /// Estimated landmark error, at most, of an alignment with the identity of the last person, fraction of the eyes'
  /// distance. Above it another person is fitted. Round value, not tuned.
  float most_known_error = 0.06f;
  /// Work of the search in a frame, cells, from which on a frame has alignments besides: one of six steps takes two thirds of them.
  /// Round value, not tuned.
  std::uint32_t cells_for_both = 12000;
  /// Cells of the search that cost as much as a step of an alignment: so many take 2.0 million instructions on a PC, and a step at
  /// most 1.8 (`pliant plan`); on a Cortex-M7 4 and at most 3.4 (docs/evaluation.md, Work on a Cortex-M7). The default search of
  /// 24,000 cells leaves three alignments of six steps.
  std::uint32_t cells_a_step = 1300;
  /// The same where a frame has either: profile S, with 4,000 cells, then has all stages of an alignment and its first score in one
  /// frame, up to 22.6 million instructions on a Cortex-M7, where a part of the search takes up to 17.1 and the frame of the start
  /// 28. With 1,300 an alignment takes three frames, in which light and face change (docs/experiments.md, Searches and first
  /// checks).
  std::uint32_t cells_a_step_alone = 660;
  /// Probability that an alignment is right, at least, for a start of the caller's to be moved there. Round value.
  float least_refined = 0.5f;
  /// Alignments of a start from a box, count, at most, until one does not leave its box: shift, as a fraction of the side, and
  /// ratio of the sides, at most. Round values, not tuned (docs/experiments.md, Boxes of others).
  int most_box_alignments = 4;
  float most_box_shift = 0.1f, most_box_ratio = 1.15f;
  /// Points of a start from landmarks from which on the face is not aligned in the picture, count. Round value, not tuned.
  std::size_t enough_points = 12;
};
inline constexpr FaceSearchTuning kFaceSearchTuning{};

/// Whether the work of searching and aligning is spread over frames, because this work of a frame is little.
constexpr bool is_spread(std::uint32_t work) {
  return work < kFaceSearchTuning.cells_for_both;
}

/// Steps of alignments in a frame of this work.
constexpr int steps_of(std::uint32_t work) {
  const FaceSearchTuning& t = kFaceSearchTuning;
  const std::uint32_t steps = work / (is_spread(work) ? t.cells_a_step_alone : t.cells_a_step);
  return steps == 0 ? 1 : static_cast<int>(steps);
}

/// Input of a frame's search.
struct SearchInput {
  const FrameView& frame;
  Span<unsigned char> block;  // the memory of the tracking, which is not in use
  const StartOptions& options;
};

/// Searches and aligns, frame by frame. The tracker makes the tracks.
class FaceSearch {
 public:
  /// Precondition: the limits name a detection, and the model has its tables.
  void lay_out(Arena& arena, const Model& model, const TrackerLimits& limits);

  /// Whether the work of searching and aligning is spread over frames, because the limits allow little a frame.
  bool spreads_work() const { return is_spread(work_); }

  /// The next frame is searched from the beginning.
  void begin();
  /// Where a track that was given up had the face in its last good frame. Where a search takes several frames, the next one begins
  /// there: light that changes at once ends a track, and the face stays.
  /// \param rotation  of the face: a RolledDetector searches most frames at its turn.
  void expect(const FaceBox& last, const Quat& rotation) {
    last_ = last;
    last_rotation_ = rotation;
  }
  /// The face that was found is expected there once more: blur, or too much light, has left no templates for a track.
  void expect_again(const Quat& rotation) { expect(candidates_.next().box, rotation); }

  /// Searches in this frame, as much as the limits allow. If a face is found `start` and the person are set; the offsets
  /// are pending where the person is new.
  /// \return not_found: nothing yet; or what detector and aligner say of their tables.
  Status search(const SearchInput& input, KnownPerson* person, StartPose* start, float* landmark_error);

  /// For an alignment that somebody else makes while a track runs; and its options where the identity is held.
  AlignmentRoom room() { return {q_, landmarks_}; }
  AlignOptions of_known_person() const { return {is_expression_}; }
  /// Whether that alignment, which was one without a known identity, is of another person than the reference.
  bool is_another(const AlignedFace& face) const {
    return reference_.tells() && !reference_.may_be(face, q_);
  }
  /// The person and the start of that alignment, as of somebody new.
  void set_new_person(const AlignedFace& face, KnownPerson* person, StartPose* start) {
    whom_ = Whom::another;
    set_person(face, person, start);
  }

  /// A start of the caller's begins: it may be of another person, elsewhere, at another roll.
  void forget() {
    reference_.forget();
    expect({}, {});
  }
  /// Moves a start of the caller's to where the picture shows the face, if that is verified; else nothing changes. The
  /// person's parameters are input and output.
  /// \param box  of the face, if the start is known roughly; null: it is near.
  void refine(const SearchInput& input, const FaceBox* box, KnownPerson* person, StartPose* start,
              float* landmark_error);

 private:
  enum class Answer : std::uint8_t { no, later, yes };
  enum class Whom : std::uint8_t { known, anybody, another };  // as whom a candidate is aligned

  void begin_again();
  Status lay_out_search(const SearchInput& input);
  Status run_detector(const FrameView& frame);
  Answer align(const SearchInput& input, int* steps, KnownPerson* person, StartPose* start,
               float* landmark_error);
  Status align_in(const FaceBox& box, const FrameView& frame, const Camera& camera, AlignedFace* face,
                  FaceBox* found);
  Status align_near(FaceBox box, const FrameView& frame, const Camera& camera, AlignedFace* face);
  Status begin_alignment(const SearchInput& input, const KnownPerson& person);
  Status advance(const FrameView& frame, int* steps, AlignedFace* face);
  bool is_accepted(const AlignedFace& face, float evidence) const;
  void go_on();
  Whom first_whom() const;
  void set_person(const AlignedFace& face, KnownPerson* person, StartPose* start);

  const FaceModules* modules_ = nullptr;
  Model model_;
  FaceDetectorLimits limits_;
  std::uint32_t work_ = 0;  // a frame, cells
  float* q_ = nullptr;      // all parameters, of the last alignment
  std::uint8_t* is_expression_ = nullptr;
  Span<Vec2> landmarks_;
  IdentityReference reference_;
  FaceBox last_;        // side 0: none
  Quat last_rotation_;  // the last one's

  FaceDetector* detector_ = nullptr;  // in the block, while there is no track
  FaceAligner* aligner_ = nullptr;
  bool is_complete_ = true;       // the search is: the next call begins anew
  bool is_of_one_frame_ = false;  // the candidates are, with all their sizes
  FaceCandidates candidates_;

  bool is_aligning_ = false;   // candidates, else a part of the frame is searched
  Whom whom_ = Whom::another;  // of the next candidate
  int steps_left_ = 0;         // of its alignment; 0: it has not begun
  int times_seen_ = 0;         // frames in which it was accepted
};

/// Odds of detector and alignment that a candidate is a face, each at most 10,000.
float evidence_of(const DetectedFace& candidate, const AlignedFace& face);

/// Bytes that a search takes of the memory of the tracking.
std::size_t search_bytes(const Model& model, const TrackerLimits& limits);

}  // namespace pliant
