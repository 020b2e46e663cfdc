#pragma once
/// \file tracker_options.hpp
/// What a Tracker is told at a start: options, landmarks, boxes and saved states.
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/camera.hpp"
#include "pliant/estimator_options.hpp"
#include "pliant/geometry.hpp"

namespace pliant {

/// Options of a start. They take no memory.
struct TrackerOptions {
  EstimatorOptions estimator;  ///< of the estimator
  /// One flag a parameter of the model: nonzero, it is estimated in every frame; else it keeps the start's value, but for the
  /// identity, which TrackerLimits::person estimates besides (without_person holds it). Null: the expressions. Read during the
  /// start.
  const std::uint8_t* is_free = nullptr;
  /// No template is captured within this distance of a marker, px, at least 0.
  float marker_exclusion_px = 8;
  /// If false, `landmark` gives the positions of the model, without the offsets of a person, until landmarks are placed
  /// (Tracker::place_landmarks).
  bool keeps_landmark_offsets = true;
};

/// `ok`, or `bad_argument` for an option out of its bounds.
inline Status check(const TrackerOptions& o) {
  return o.marker_exclusion_px >= 0 ? check(o.estimator) : Status::bad_argument;
}

/// A landmark by the model's name for it (`ibug30`, `nose_tip`, ...), and where it is seen. It may alias the pliant_point of a
/// caller in C: without that, optimisation of a whole program may leave out what that caller has written.
struct [[gnu::may_alias]] NamedPoint {
  const char* name = nullptr;  ///< of a landmark
  Vec2 x;                      ///< px
};

/// What a face detector's box encloses.
enum class BoxConvention : std::uint8_t {
  landmarks = 0,  ///< brows to chin, ear to ear
  /// The square that OpenCV's cascades give: from the middle of the forehead to just above the chin.
  opencv = 1,
  face_box = 2,  ///< a FaceBox: corner = center - side / 2, size = side
};

/// Options of a start besides landmarks or a box.
struct StartOptions {
  /// Focal length, px. 0: unknown. A start from landmarks then estimates it, all others take 1.4 times the larger side.
  float focal_px = 0;
  /// Intrinsics and lens, if known, which replace focal_px. May be Tracker::camera.
  const Camera* camera = nullptr;
  /// Of start_from_box. A box of FaceDetector or of `pliant detect` is a `face_box`.
  BoxConvention box = BoxConvention::landmarks;
};

/// A tracker's state for another start: after a pause, or in another process. The arrays are the caller's.
struct SavedState {
  Camera camera;                ///< intrinsics and lens
  Pose pose;                    ///< of the model
  Span<float> parameters;       ///< all of the model's, in its order
  Span<Vec3> landmark_offsets;  ///< mm, one for each of the model's landmarks, in its order
};

}  // namespace pliant
