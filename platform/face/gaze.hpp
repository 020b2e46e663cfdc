#pragma once
// Where the eyes look, from where their pupils are seen (docs/algorithms.md, section 7.21).
#include "pliant/arena.hpp"
#include "pliant/camera.hpp"

namespace pliant {

/// Tuning of the gaze. Each constant: unit, reason, experiment.
struct GazeTuning {
  /// Middle of the left eyeball from the middle between the eye's corners, mm; the right one is mirrored.
  /// Across and along of the built-in face's eyeballs. Up so that 85 people left out of training, who look
  /// into the camera, look neither up nor down: with the built-in face's 1 mm they look up by 9 degrees.
  Vec3 ball_mm = {0.75f, 2.6f, -4.5f};
  /// The iris' middle from that of the eyeball, mm: a sphere of 12 mm, cut where it is 11.8 mm wide.
  float iris_mm = 10.4f;
  /// Pupils are not read between lids closer than this, mm: a third of an iris. Not tuned.
  float least_opening_mm = 4;
  /// Cosine of the head's turn away from the camera beyond which nothing is seen: the readers learnt from
  /// heads within 40 degrees.
  float least_facing = 0.766f;
  /// Part of the way to what is seen that the gaze goes in a frame: eyes jump, and 0.5 follows in two frames.
  /// Not tuned.
  float rate = 0.5f;
};
inline constexpr GazeTuning kGazeTuning{};

/// What is seen of one eye.
struct EyeSight {
  Vec2 pupil;            ///< px, without the lens
  Vec3 corners;          ///< the middle between the eye's corners, in the model, mm
  float opening_mm = 0;  ///< between the lids
};

/// The common direction of eyes: what each says, weighted alike.
/// \param eyes  x of `corners` is positive for the left one.
/// \return a unit vector in the model's axes; 0: no eye tells.
Vec3 find_gaze(Span<const EyeSight> eyes, const View& view);

/// \param gaze  of the frame before, 0: unknown. \param seen  of find_gaze.
/// \return a unit vector, or 0 where nothing is seen.
Vec3 smoothed_gaze(Vec3 gaze, Vec3 seen);

}  // namespace pliant
