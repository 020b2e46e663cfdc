#pragma once
// The view that a face box stands for.
#include "pliant/camera.hpp"
#include "pliant/cascade.hpp"
#include "pliant/face_box.hpp"
#include "pliant/lens.hpp"

namespace pliant {

/// Frontal, with the middle of the outer eye corners and the mouth corners of the face q in the middle of the box.
/// \param roll  of the face in the image, clockwise, radians.
/// \pre the box and q are finite, side and camera.f > 0.
/// \return not_found if the model lacks one of these landmarks; `view` is then unchanged.
Status view_of_box(Cascade& cascade, const float* q, const FaceBox& box, float roll, const Camera& camera,
                   const Lens& lens, View* view);

}  // namespace pliant
