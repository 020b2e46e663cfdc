#pragma once
/// \file second_look.hpp
/// A second alignment while a track runs: it may see more of the face than the start did (docs/algorithms.md, section 7.15). Bad
/// frames are aligned, too (realignment.hpp).
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/face_aligner.hpp"
#include "pliant/tracker_limits.hpp"
#include "track/face_modules.hpp"
#include "track/template_matcher.hpp"

namespace pliant {

struct FrameBudget;
struct PartPoints;
struct TrackerParts;

/// Tuning of second looks. Each constant: unit, reason, experiment (docs/experiments.md, Covered starts).
struct SecondLookTuning {
  /// Frames from the start to the first look. Each further one waits twice as long, up to the second number: then looks take
  /// 1.5 % of the time. After a start whose estimated landmark error is above `doubtful_error`, fraction of the eyes' distance,
  /// they wait up to the third number. Round values; the last was chosen on eleven people (docs/experiments.md, Expected error).
  std::uint32_t first_wait = 12, longest_wait = 96, longest_doubtful_wait = 24;
  float doubtful_error = 0.025f;
  /// Looks in a row that must find better landmarks, and frames from one to the next: a second, so that they see two expressions.
  /// With 4 a track began anew while its person spoke, with lips that were off from then on (docs/experiments.md, Means of
  /// alignments).
  int looks = 2;
  std::uint32_t wait_if_better = 25;
  /// Landmark error that the second alignment estimates, at most: over the larger of the start's estimate and the checks'. It must
  /// not be above the smaller one either. Below the second number one look is enough: chosen on eleven people (docs/experiments.md,
  /// Expected error). A start that was turned (is_frontal, known_person.hpp) gives way to the first frontal look that estimates no
  /// larger error, and to a turned one that is sure. Heads that are found turned by 60 degrees (docs/experiments.md, Covered
  /// starts) then have a rotation error of 2.4 instead of 3.2 degrees (median).
  float most_error_ratio = 0.95f, sure_error_ratio = 0.8f;
  /// Mean distance of the landmarks from the tracked ones, at least, fraction of the eyes' distance: below, little is gained.
  float least_distance = 0.02f;
  /// Probability that the second alignment is right, at least. Round value, not tuned.
  float least_score = 0.95f;
  /// Other looks count for the mean of the landmarks: cosine of the turn away from the camera, at least (26 degrees, as of a face
  /// above the camera of a laptop); estimated landmark error, at most, fraction of the eyes' distance and of the start's. The start
  /// counts as two looks, since a look's distances from the track have the track's own errors, too; and a look for a tenth, at
  /// least, so that slow changes are followed. docs/experiments.md, Means of alignments.
  float least_average_frontal = 0.9f, most_average_error = 0.04f, most_average_ratio = 1.2f;
  float looks_of_start = 2, least_gain = 0.1f;
  /// Work of a step with the built-in face's learnt tables, instructions as WorkCosts. With profile M 1.5 to 2.9 million were
  /// counted, and 0.8 in the mean to follow the face.
  float step_work = 4e6f;
};
inline constexpr SecondLookTuning kSecondLookTuning{};

/// A track that is to begin where an alignment during another one has the face.
struct NextTrack {
  AlignedFace face;
  bool is_same_person = false;  // it begins where the track is
  std::int64_t time_ns = 0;     // of the frame
};

/// Result of the alignments of a bad frame: none was made; no face; the tracked person; another person, whose track has begun.
enum class Realigned : std::uint8_t { untried, nowhere, here, begun_anew };

/// What a tracker keeps for its second looks. In the arena, if the limits name them.
struct SecondLookState {
  const FaceModules* modules = nullptr;
  FaceAligner* aligner = nullptr;
  // Landmark error that the alignment of this person's start estimated; 0: there was no alignment.
  float start_error = 0;
  bool began_turned = false;                // that alignment's face was not frontal (is_frontal)
  std::uint32_t wait = 0, frames_left = 0;  // from one look to the next, and of that
  int steps_left = 0;                       // of the alignment; 0: none is under way
  int agreed = 0;                           // looks in a row that found better landmarks
  int averaged = 0;                         // looks in the mean of the landmarks, beside the start
  int realigned = 0;                        // frames since the last good one that `realign` has made good
  Realigned ahead = Realigned::untried;     // what this frame's alignment gave before its templates
  AlignedFace face_ahead;                   // whose parameters are in the room of the search
  FaceBox suspected;  // where `realign` goes on after the bad frame before; side 0: at the last good place
  NextTrack next;     // which the next frame begins
  // FaceDetectionState::parts; that is null until a new track has all its templates.
  PartPoints* readers = nullptr;
  bool is_captured = false;  // it has got them: the readers begin in the next good frame

  void lay_out(Arena& arena, const Model& model, const TrackerLimits& limits);
  /// The aligner, for calls of one frame.
  FaceAligner& in(Arena& scratch);
  FaceAligner& in_scratch_of(const TrackerParts& t);
  /// Drops the alignment that is under way, and what the budget keeps for it.
  void stop(FrameBudget& budget);
};

/// The calls of a tracker. It makes them through TrackerLimits::second_look only, so that a program whose limits
/// name none does not link what is behind it.
struct SecondLook {
  /// \return null if the arena measures, or is exhausted.
  SecondLookState* (*lay_out)(Arena& arena, const Model& model, const TrackerLimits& limits);
  /// Bytes that an alignment of one frame takes of memory that is unused between frames.
  std::size_t (*bytes)(const Model& model);
  /// A track has begun.
  void (*begin_track)(TrackerParts& tracker);
  /// Ends a frame of a track. After a good one it takes a step of the alignment, if one is due and the frame has room, and where
  /// the alignment has found better landmarks a new track begins with this frame. A bad one is aligned at once (realignment.hpp).
  /// \return true: nothing else is to be done in this frame, since the bad one is tracked after all, or a new track has begun, or
  /// has failed to.
  bool (*conclude)(TrackerParts& tracker, const FrameView& frame);
  /// Ends a start from a saved state (realignment.hpp).
  void (*resume)(TrackerParts& tracker, const FrameView& frame);
  /// Whether a bad frame that was not tracked after all comes after a cut (KeyFrames::is_lasting_cut): the track is over.
  bool (*is_over)(const TrackerParts& tracker);
  /// Whether this frame shows another picture than the last good one, which templates have matched: they would match by chance, and
  /// `conclude` aligns the frame.
  bool (*is_after_cut)(const TrackerParts& tracker);
  /// Begins a frame of a track, before it takes memory: align_ahead and move_to_alignment of realignment.hpp.
  SearchFrom (*begin_frame)(TrackerParts& tracker, const FrameView& frame);
  void (*move_to_alignment)(TrackerParts& tracker);
};

}  // namespace pliant
