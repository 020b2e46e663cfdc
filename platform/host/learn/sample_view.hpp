#pragma once
/// \file sample_view.hpp
/// Poses and cameras of training samples, and the truth that follows from them.
#include <vector>

#include "pliant/camera.hpp"
#include "pliant/face_box.hpp"
#include "pliant/model.hpp"

namespace pliant::host::learn {

/// R = Rz(roll) Ry(yaw) Rx(pitch), angles in radians.
Quat rotation_of(float yaw, float pitch, float roll);

/// Image positions of points of the model, px. One that is behind the camera stays at (0, 0).
std::vector<Vec2> projected(const std::vector<Vec3>& points, const Pose& pose, const Camera& camera);

/// The face box of landmarks in a view. \return a side of 0 if the model lacks one of the four landmarks it needs.
FaceBox face_box_in(const Model& model, const std::vector<Vec2>& landmarks, const Pose& pose,
                    const Camera& camera);

/// Where a face is put.
struct FacePlacement {
  int picture_px = 0;       ///< side of the picture
  FaceBox box;              ///< in it
  float distance_mm = 600;  ///< to the camera
};
/// The centred camera and the translation that put the face, turned by `rotation`, into its box.
/// \param landmarks  of the model, mm.
void place_face(const Model& model, const std::vector<Vec3>& landmarks, Quat rotation,
                const FacePlacement& placement, Camera* camera, Pose* pose);

}  // namespace pliant::host::learn
