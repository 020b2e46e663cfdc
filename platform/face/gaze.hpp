#pragma once
// Where the eyes look, from where their pupils are seen (docs/algorithms.md, section 7.21).
#include "pliant/arena.hpp"
#include "pliant/camera.hpp"

namespace pliant {

/// Tuning of the gaze. Each constant: unit, reason, experiment.
struct GazeTuning {
  /// Middle of the left eyeball from the middle between the eye's corners, mm; the right one is mirrored.
  /// Across and along of the built-in face's eyeballs. Up so that people left out of training look neither
  /// up nor down: by 2.4 degrees up on portraits, down by 2 on films made of them. With the built-in face's
  /// 1 mm they look up by 9 degrees more.
  Vec3 ball_mm = {0.75f, 2.6f, -4.5f};
  /// The iris' middle from that of the eyeball, mm: a sphere of 12 mm, cut where it is 11.8 mm wide.
  float iris_mm = 10.4f;
  /// Fraction of the way, up and down, that an eye's corners go from where the model has them to where its crop is, which is
  /// where they are read. 0 is the model's place, and its error the gaze's; 1 is the readings' place, and their noise.
  /// Portraits and films of people left out of training, docs/experiments.md, Gaze: sd 6.7, 5.3, 4.9 and 4.6 degrees on
  /// portraits with 0, 0.5, 0.75 and 1; correlations on films 0.922, 0.924, 0.920 and 0.913.
  float corner_weight = 0.75f;
  /// The upper lid follows the eye: fraction of its height that counts, the rest is the pupil's. On the same portraits, with
  /// corner_weight 0.75, sd 4.9 degrees with 0, 4.6 with 0.5, 4.7 with 0.6; on the films correlations of 0.920, 0.934, 0.932.
  float lid_weight = 0.5f;
  /// Height of the upper lid over the pupil of eyes that look ahead, mm: the mean of those portraits.
  float lid_mm = 3.2f;
  /// The most that it counts as higher or lower, mm: lids also widen, narrow and blink. Portraits and films:
  /// the same with 9; with 1 the rendered head looks down by 7.2 degrees instead of 5.0.
  float most_lid_mm = 2;
  /// Pupils are not read between lids closer than this, mm: a third of an iris. Not tuned.
  float least_opening_mm = 4;
  /// Cosine of the head's turn away from the camera beyond which nothing is seen: the readers learnt from
  /// heads within 40 degrees.
  float least_facing = 0.766f;
  /// Time of a frame in which the gaze goes half of the way to what is seen, s: of 25 frames a second. Eyes jump, and it follows
  /// in two frames. Not tuned.
  float half_way_s = 0.04f;
};
inline constexpr GazeTuning kGazeTuning{};

/// What is seen of one eye.
struct SeenEye {
  Vec2 pupil;                         ///< px, without the lens
  Vec3 corners;                       ///< the middle between the eye's corners, in the model, mm
  float opening_mm = 0;               ///< between the lids
  float lid_mm = kGazeTuning.lid_mm;  ///< of the upper lid over the pupil
};

/// The common direction of eyes: what each says, weighted alike.
/// \param eyes  x of `corners` is positive for the left one.
/// \return a unit vector in the model's axes; 0: no eye tells.
Vec3 find_gaze(Span<const SeenEye> eyes, const View& view);

/// \param gaze  of the frame before, 0: unknown. \param seen  of find_gaze. \param seconds  since the frame before.
/// \return a unit vector, or 0 where nothing is seen.
Vec3 smoothed_gaze(Vec3 gaze, Vec3 seen, float seconds);

}  // namespace pliant
