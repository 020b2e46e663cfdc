#pragma once
/// \file silhouette.hpp
/// The silhouette of a posed mesh: the occluding contour, where the surface turns away from the camera, and
/// the open boundary of the mesh (docs/algorithms.md, section 7.4). The edge tracker searches for image edges
/// there; a fit matches landmarks of the jaw to it.
#include <cstddef>

#include "pliant/arena.hpp"
#include "pliant/camera.hpp"
#include "pliant/mesh.hpp"
#include "pliant/visibility.hpp"

namespace pliant {

/// A point of the silhouette. It lies on a mesh edge.
struct SilhouettePoint {
  Vec2 uv;          ///< place on the surface
  Vec2 x;           ///< px
  Vec2 normal;      ///< unit, in the image, away from the surface
  float depth = 0;  ///< as in PosedMesh
  /// True: the middle of a boundary edge of the mesh. False: a point of the occluding contour.
  bool is_border = false;
};

/// A mesh as a camera sees it. The arrays are indexed by vertex id.
struct PosedMesh {
  const Mesh& mesh;      ///< topology and (u,v)
  const Vec3* position;  ///< mm, model axes
  const Vec2* image;     ///< px
  /// Millimetres along the optical axis, from any origin; 0 or less for vertices that are not in front of the camera.
  const float* depth;
};

/// Finds the silhouette of a posed mesh. Bytes: 16 a vertex.
///
/// On the silhouette the normal is perpendicular to the viewing ray. The cosine between them is
/// computed at the vertices, with the mean of the face normals weighted by area. Its zero on each mesh edge
/// is found by linear interpolation: one point on each edge that it crosses, two on each face. With
/// the normal n of the surface there, in camera axes, the image normal of a pinhole camera is parallel to
/// (n_x, n_y).
class SilhouetteFinder {
 public:
  /// \param vertices  capacity of the meshes to come, count.
  void lay_out(Arena& arena, std::size_t vertices);

  /// Writes the visible points of the silhouette in rising order of half-edges, as many as fit.
  /// \param hidden  the same mesh drawn at the same pose; null: no point is hidden. A point is hidden if the
  ///                surface one cell further out is nearer to the camera by `margin` (mm). The cell of the
  ///                point itself is not used: the surface is steep there, and the cell contains parts of it
  ///                that are nearer to the camera.
  /// \return how many visible points there are. Cost: O(faces).
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
