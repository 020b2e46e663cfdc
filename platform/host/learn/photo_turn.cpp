#include "host/learn/photo_turn.hpp"

namespace pliant::host::learn {

float relit(Vec3 n, Vec3 light) {
  const float strength = length(light);
  if (!(strength > 0)) return 1;
  const float lambert = max(0, (dot(n, light) / strength + 0.25f) / 1.25f);
  return 1 - strength + strength * 1.6f * lambert;
}

Mat3 model_to_camera(Quat q) {
  Mat3 m = rotation_matrix(q);
  for (auto& row : m.m) row[1] = -row[1], row[2] = -row[2];
  return m;
}

}  // namespace pliant::host::learn
