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

  /// Begins matches to the contour of the base mesh at one pose. It is found for the first landmark that needs it.
  /// \param position  of its vertices, mm; must stay until the last match.
  void begin(const Vec3* position);
  /// The place of a landmark. Cost: O(contour points), once O(faces); little where its own place faces the camera.
  SilhouetteMatch match(Cascade& cascade, const float* q, const Projector& projector,
                        const Correspondence& landmark);

 private:
  void find_contour(const Projector& projector);

  Mesh mesh_;
  DepthBuffer depth_;
  SilhouetteFinder finder_;
  Vec2* image_ = nullptr;  // a vertex
  float* vertex_depth_ = nullptr;
  Span<SilhouettePoint> contour_;
  std::size_t found_ = 0;
  const Vec3* position_ = nullptr;
  bool is_found_ = false;  // the contour of position_; before the first `begin` there is none to find
};

}  // namespace pliant
