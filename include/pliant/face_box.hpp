#pragma once
/// \file face_box.hpp
/// Where a face is in an image: the result of detection and the input of alignment.
#include "pliant/camera.hpp"

namespace pliant {

/// An upright square around a face. The box of a frontal face reaches from the middle of the forehead to just above the chin: of
/// the mean face from 14 mm above the brows to 9 mm above the chin. Roll does not change it.
struct FaceBox {
  Vec2 center;     ///< px: midway between the middle of the outer eye corners and the middle of the mouth corners
  float side = 0;  ///< px: kFaceBoxMm at the image scale of the face; 0: no face
};

/// Side of a face box on the face, mm.
constexpr float kFaceBoxMm = 150;

/// The face box of a face whose landmarks are known.
/// \param eye_right, eye_left      outer eye corners in the image, px (ibug36 and ibug45).
/// \param mouth_right, mouth_left  mouth corners in the image, px (ibug48 and ibug54).
/// \param scale  of the face in the image, px per mm (View::s).
constexpr FaceBox face_box_of(Vec2 eye_right, Vec2 eye_left, Vec2 mouth_right, Vec2 mouth_left, float scale) {
  return {0.25f * (eye_right + eye_left + mouth_right + mouth_left), kFaceBoxMm * scale};
}

}  // namespace pliant
