#pragma once
/// \file outline.hpp
/// The outline of a posed mesh: where the surface turns away from the camera, and where the mesh ends (ALGORITHMS:
/// section 7.4). Edge trackers look there for image edges; a fit matches landmarks of the jaw to it.
#include <cstddef>

#include "pliant/arena.hpp"
#include "pliant/camera.hpp"
#include "pliant/mesh.hpp"
#include "pliant/visibility.hpp"

namespace pliant {

/// One point of the outline, on a mesh edge.
struct SilhouettePoint {
  Vec2 uv;
  Vec2 x;                  ///< px
  Vec2 normal;             ///< unit, in the image, away from the surface
  float depth = 0;         ///< as in PosedMesh
  bool is_border = false;  ///< the middle of an open border's edge; else a point of the apparent contour
};

/// A mesh as a camera sees it; the arrays are indexed by vertex id. The three are what DepthBuffer::draw takes and
/// Estimator keeps.
struct PosedMesh {
  const Mesh& mesh;
  const Vec3* position;  ///< mm, model axes
  const Vec2* image;     ///< px
  const float*
      depth;  ///< mm along the optical axis from any origin; 0 or less where not in front of the camera
};

/// Walks a posed mesh for its outline. Bytes: 16 a vertex.
///
/// The apparent contour is where the normal is square to the viewing ray. Both are taken at the vertices (normals as the
/// mean of the faces', by area) and the change of sign is placed along each mesh edge by linear interpolation, so
/// there is one point on every edge that the contour crosses, and faces that it crosses have exactly two. With the
/// rays of the pinhole camera and the normal n of the surface there, the image normal is (n_x, n_y) up to length.
class SilhouetteFinder {
 public:
  /// \param vertices  ids of the meshes to come are below this.
  void lay_out(Arena& arena, std::size_t vertices);

  /// Writes the outline's points in rising order of half-edges, as many as fit; those that `hidden` covers are left out.
  /// \param hidden  the same mesh drawn at the same pose; null: nothing hides anything. A point counts as hidden when a
  ///                cell further out something lies nearer than the point by `margin` mm: at the point itself
  ///                the surface is steep and shares its cell with nearer parts of its own.
  /// \return how many there are. Cost: O(faces).
  std::size_t find(const PosedMesh& posed, const Projector& projector, const DepthBuffer* hidden,
                   float margin, Span<SilhouettePoint> points);

 private:
  void compute_facing(const PosedMesh& posed, const Projector& projector);
  bool border_point(const PosedMesh& posed, FaceId f, int k, SilhouettePoint* p) const;
  bool contour_point(const PosedMesh& posed, const Projector& projector, VertexId a, VertexId b,
                     SilhouettePoint* p) const;

  Vec3* normal_ = nullptr;   // a vertex: outward unit normal in camera axes
  float* facing_ = nullptr;  // a vertex: cosine between its normal and the ray to the camera
  std::size_t capacity_ = 0;
};

}  // namespace pliant
