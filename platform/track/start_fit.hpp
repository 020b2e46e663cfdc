#pragma once
/// \file start_fit.hpp
/// What a start fits before the tracking begins: person and pose from landmarks, or a pose from a box. It works in an
/// arena over the memory that the tracking takes afterwards.
#include <cstddef>

#include "pliant/camera.hpp"
#include "pliant/face_box.hpp"
#include "pliant/tracker.hpp"
#include "track/landmark_offsets.hpp"

namespace pliant {

/// Tuning of starts. Each constant: unit, reason, experiment.
struct StartFitTuning {
  /// Brows to chin and ear to ear in a box of OpenCV's cascades: left, top and size as fractions of the box's
  /// width. Measured on photographs with landmarks.
  float opencv_left = 0.08f, opencv_top = 0.23f, opencv_size = 0.85f;
};
inline constexpr StartFitTuning kStartFitTuning{};

struct StartPose {
  Camera camera;
  Pose pose;
};

/// Bytes that fit_to_landmarks takes for a number of points. \param samples_base_mesh  as in FitLimits.
std::size_t start_fit_bytes(const Model& model, std::size_t points, bool samples_base_mesh);

/// \param points   names that the model has, and finite positions. \param samples_base_mesh  as in FitLimits.
/// \param options  with the frame's size and what is known of the camera. \param q  all parameters, the result.
/// \param offsets  out: pending ones where the person's differ.
/// \return the statuses of LandmarkFit::fit.
Status fit_to_landmarks(Arena& arena, const Model& model, Span<const NamedPoint> points,
                        bool samples_base_mesh, const FitOptions& options, float* q, StartPose* start,
                        LandmarkOffsets* offsets);

/// A box in the picture.
struct GivenBox {
  Vec2 corner, size;  // px
  BoxConvention convention;
};

/// The pose of the model with parameters q, frontal, in the box of a picture of this size, and its face box (side 0 for a model
/// without eye and mouth corners). Statuses of Lens::make and view_from_box.
Status fit_to_box(Cascade& cascade, GivenBox given, int width, int height, const float* q, StartPose* start,
                  FaceBox* box);

}  // namespace pliant
