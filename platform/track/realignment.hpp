#pragma once
/// \file realignment.hpp
/// Bad frames of a track in which alignment still sees the face (docs/algorithms.md, section 7.15).
#include "pliant/frame.hpp"
#include "track/face_checks.hpp"
#include "track/second_look.hpp"

namespace pliant {

struct TrackerParts;

/// Tuning of realignments. Each constant: unit, reason, experiment (docs/experiments.md, Bad frames).
struct RealignmentTuning {
  /// Landmark error that the alignment estimates, at most, fraction of the distance of the outer eye corners: above it a tracked
  /// frame would be degraded; and its probability to be right, at least.
  /// With 0.05 and 0.95 films of moving shadows are tracked in 87 instead of 97 % of the frames, and more of them are wrong, since
  /// tracks end and begin anew in shadow.
  float most_error = kFaceChecksTuning.most_landmark_error, least_score = 0.8f;
  /// Mean distance of the landmarks from the last good frame's above which another alignment has to confirm them, which begins with
  /// the mean face in their box; and from those of that one, at most; fractions of the distance of the outer eye corners. After a
  /// cut to another size the mouth may be aligned to the nose, which looks right from there (docs/experiments.md, Cuts; this and
  /// the following constants). Round values.
  float most_distance = 0.05f, most_disagreement = 0.12f;
  /// The same of the only alignment, where the limits name no second looks. Of 0.05, 0.1, 0.12, 0.15 and 0.2 chosen on five people
  /// (docs/experiments.md, Searches and first checks).
  float most_distance_alone = 0.1f;
  /// Where they are away from each other the second one is believed, if its probability is at least this, and its estimated error
  /// at most this fraction of the first one's. Those of a second look (SecondLookTuning).
  float least_sure_score = kSecondLookTuning.least_score,
        sure_error_ratio = kSecondLookTuning.sure_error_ratio;
  /// And if the box of its face stays in the next frame: shift, as a fraction of the side, and ratio of the sides, at most.
  float most_box_shift = 0.15f, most_box_ratio = 1.08f;
  /// Probability of the first alignment, at least, for a second one to be made: below it there is no face. That of a bad check.
  float least_seen_score = kFaceChecksTuning.least_check;
  /// Realigned frames since the last good one, bad frames between them not counted, after which a new track begins: the light stays
  /// as it is now, or it is another person. A second. With 6 or 12 a new track begins in light that has not settled yet.
  int most_frames = 25;
  /// A start from a saved state moves to where it is aligned if the landmarks are farther from there than this, fraction of the
  /// distance of the outer eye corners: what alignments err by (docs/experiments.md, Resumed tracks).
  float least_resumed = 0.01f;
};
inline constexpr RealignmentTuning kRealignmentTuning{};

/// Begins the frame after one that `realign` has made good, as long as no new track is due: aligns the face as `realign` does. If
/// it is where it was, templates are searched for from there, at full size: once instead of twice, and they come back sooner. If
/// the mean face had to be aligned, too, or the frame begins elsewhere (SecondLookState::suspected), they are left out: that
/// is work enough for a frame (docs/experiments.md, Alignment before templates). Takes half of the budget.
/// \pre nothing has taken memory of this frame. `realign` ends the frame if it is bad.
SearchFrom align_ahead(TrackerParts& tracker, const FrameView& frame);
/// Begins the searches where align_ahead has the face. \pre it has returned SearchFrom::alignment, and the estimator the frame.
void move_to_alignment(TrackerParts& tracker);

/// Ends a bad frame: aligns the face from the last good pose, with the person held. If that is right, the frame counts as
/// tracked; after many such frames a new track begins, of the same person or of another one. If it is not, but the mean face is
/// seen surely elsewhere in its box, the next bad frame begins there.
/// \pre the limits name second looks. \return false: the frame stays bad. Cost: 4.5 million instructions with the defaults,
/// 11.5 million where the mean face is aligned, too (with AVX2); where a new track begins a start besides.
bool realign(TrackerParts& tracker, const FrameView& frame);

/// The same where the limits name no second looks: one alignment from the last good pose, in memory that is unused between frames,
/// and no new track. \return false: the frame stays bad. Cost: 7.6 million instructions with profile S (x86-64 with AVX2).
bool realign_near(TrackerParts& tracker, const FrameView& frame);

/// Ends a start from a saved state: where the face has moved since, the track begins anew at its alignment, as the same person with
/// the same offsets. Nothing happens if the caller has given places of markers.
void resume(TrackerParts& tracker, const FrameView& frame);

/// Bytes that both take of memory that is unused between frames.
std::size_t alignment_bytes(const Model& model);

}  // namespace pliant
