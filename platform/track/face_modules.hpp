#pragma once
/// \file face_modules.hpp
/// What FaceSearch and FaceChecks ask of detection and alignment, as a table of functions: a test gives it functions of its own.
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/face_aligner.hpp"
#include "pliant/face_detector.hpp"
#include "pliant/frame.hpp"
#include "pliant/model.hpp"

namespace pliant {

/// The calls of FaceDetector and FaceAligner that a tracker makes.
struct FaceModules {
  /// Whether the model has the learnt tables, usable or not.
  bool (*is_available)(const Model& model);
  /// Takes a detector or an aligner from the arena. \return null if the arena measures or is exhausted.
  /// \param expected  rotation of the face that the search is for, if known. \param aspect  as Camera::aspect.
  FaceDetector* (*lay_out_detector)(Arena& arena, const Model& model, const FaceDetectorLimits& limits,
                                    const Quat& expected, float aspect);
  FaceAligner* (*lay_out_aligner)(Arena& arena, const Model& model);
  FaceAligner* (*lay_out_for_known_person)(Arena& arena, const Model& model);  ///< as FaceAligner
  /// What the two say of their tables.
  Status (*status)(const FaceDetector& detector, const FaceAligner& aligner);
  /// As the functions of RolledDetector, or FaceDetector, and FaceAligner of these names.
  Status (*search)(FaceDetector& detector, const FrameView& frame, std::uint32_t work,
                   Span<DetectedFace> room, std::size_t* count, bool* is_complete);
  Status (*search_near)(FaceDetector& detector, const FrameView& frame, const FaceBox& box,
                        DetectedFace* face);
  Status (*begin)(FaceAligner& aligner, const FrameView& frame, const FaceBox& box, const Camera& camera,
                  const AlignOptions& options, const float* q, int* steps);
  Status (*advance)(FaceAligner& aligner, const FrameView& frame, int steps, AlignedFace* face, float* q,
                    Span<Vec2> landmarks);
  Status (*refine)(FaceAligner& aligner, const FrameView& frame, const Camera& camera, const Pose& start,
                   const AlignOptions& options, AlignedFace* face, float* q, Span<Vec2> landmarks);
  Status (*verify)(FaceAligner& aligner, const FrameView& frame, const Camera& camera, const Pose& pose,
                   const float* q, AlignedFace* face);
};

/// FaceDetector and FaceAligner.
extern const FaceModules kFaceModules;
/// The same with a RolledDetector (rolled_detector.hpp).
extern const FaceModules kRolledFaces;

/// Where an alignment writes its results.
struct AlignmentRoom {
  float* q;  ///< all parameters
  Span<Vec2> landmarks;
};

/// Aligns the mean face in a box, in all steps at once. \param roll  as AlignOptions.
inline Status align_in_box(const FaceModules& modules, FaceAligner& aligner, const FrameView& frame,
                           const FaceBox& box, float roll, const Camera& camera, AlignmentRoom room,
                           AlignedFace* face) {
  int steps = 0;
  const Status status = modules.begin(aligner, frame, box, camera, {nullptr, roll}, room.q, &steps);
  return status == Status::ok ? modules.advance(aligner, frame, steps, face, room.q, room.landmarks) : status;
}

}  // namespace pliant
