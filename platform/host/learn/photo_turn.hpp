#pragma once
/// \file photo_turn.hpp
/// How a photograph is rendered again as a surface in space.
#include <vector>

#include "pliant/camera.hpp"

namespace pliant::host::learn {

class PhotoMesh;

/// How a photograph is rendered again.
struct PhotoTurn {
  Camera camera;
  Pose pose;             ///< of the face
  std::vector<float> q;  ///< of the face
  /// Of what is far from the head; it is joined to the head at the pivot.
  Quat body;
  Vec3 light;  ///< direction to a light in camera axes, times its strength; 0: as photographed
  /// Another person, whose skin is mixed in. Null: none.
  const PhotoMesh* second = nullptr;
  float second_weight = 0;  ///< of that person's skin, 0 to 1
  Vec2 gaze_mm;             ///< by which the irises are moved in the photograph: to the right and down
  float cover_mm = 1e9f;    ///< what is farther from the face fades into the background
};

/// Factor on the brightness of a surface with unit normal n (camera axes) under PhotoTurn::light: about 1 on average.
float relit(Vec3 n, Vec3 light);

/// R(q) diag(1,-1,-1): from model to camera axes.
Mat3 model_to_camera(Quat q);

/// From 0 at `low` to 1 at `high`.
constexpr float smooth_step(float low, float high, float x) {
  const float t = clamp((x - low) / (high - low), 0, 1);
  return t * t * (3 - 2 * t);
}

}  // namespace pliant::host::learn
