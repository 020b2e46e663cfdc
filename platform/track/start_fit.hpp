#pragma once
/// \file start_fit.hpp
/// What a start fits before the tracking begins: person and pose from landmarks, or a pose from a box. It works in an
/// arena over the memory that the tracking takes afterwards.
#include <cstddef>

#include "pliant/camera.hpp"
#include "pliant/tracker.hpp"
#include "track/landmark_offsets.hpp"

namespace pliant {

struct StartPose {
  Camera camera;
  Pose pose;
};

/// Bytes that fit_to_landmarks takes for a number of points.
std::size_t start_fit_bytes(const Model& model, std::size_t points);

/// \param points   names that the model has, and finite positions. \param size  of the frame, as limits.
/// \param q        all parameters, the result. \param offsets  pending ones where the person's differ, if wanted.
/// \return the statuses of LandmarkFit::fit.
Status fit_to_landmarks(Arena& arena, const Model& model, Span<const NamedPoint> points,
                        const FitOptions& options, float* q, StartPose* start, LandmarkOffsets* offsets);

/// The pose of the model with parameters q, frontal, in the box. Statuses of view_from_box.
Status fit_to_box(Arena& arena, const Model& model, Vec2 corner, Vec2 size, const float* q, StartPose* start);

}  // namespace pliant
