#pragma once
// Matches the landmarks of jaw and cheeks to the silhouette of the model.
//
// People and detectors annotate such a landmark on the edge of the face in the image, whatever part of the surface makes
// that edge. While the landmark's own place faces the camera the landmark stays there. Once that turns away, the landmark
// takes the nearest point of the model's contour within reach, and only its distance across the contour counts.
#include "pliant/cascade.hpp"
#include "pliant/fit.hpp"
#include "pliant/mesh.hpp"
#include "pliant/silhouette.hpp"
#include "pliant/visibility.hpp"

namespace pliant {

/// The place of a silhouette landmark at one pose.
struct SilhouetteMatch {
  Vec2 uv;
  Vec2 normal;  ///< of the contour in the image, unit; zero while the landmark is at its own place
};

class SilhouetteMatcher {
 public:
  void lay_out(Arena& arena, const Model& model);

  /// \return the statuses of Mesh::set_base.
  Status start(const Model& model);

  /// Whether a landmark's own place has turned away from the camera.
  static bool is_turned_away(Cascade& cascade, const float* q, const Projector& projector, Vec2 uv);

  /// Finds the contour of the base mesh at one pose. \param position  of its vertices, mm. Cost: O(faces).
  void find_contour(const Vec3* position, const Projector& projector);
  /// The place of a landmark whose own one has turned away; that one where the contour has no point within reach. Cost:
  /// O(contour points).
  SilhouetteMatch nearest(const Correspondence& landmark) const;

 private:
  Mesh mesh_;
  DepthBuffer depth_;
  SilhouetteFinder finder_;
  Vec2* image_ = nullptr;  // a vertex
  float* vertex_depth_ = nullptr;
  Span<SilhouettePoint> contour_;
  std::size_t found_ = 0;
};

}  // namespace pliant
