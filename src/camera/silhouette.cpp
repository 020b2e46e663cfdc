#include "pliant/silhouette.hpp"

namespace pliant {

void SilhouetteFinder::lay_out(Arena& arena, std::size_t vertices) {
  normal_ = arena.take<Vec3>(vertices);
  facing_ = arena.take<float>(vertices);
  capacity_ = vertices;
}

void SilhouetteFinder::compute_facing(const PosedMesh& posed, const Projector& projector) {
  const Mesh& mesh = posed.mesh;
  for (VertexId v : mesh.vertices()) normal_[v] = {};
  for (FaceId f : mesh.faces()) {
    const VertexId c[3] = {mesh.corner(f, 0), mesh.corner(f, 1), mesh.corner(f, 2)};
    // The outer side is where v points down and u to the right, whatever the orientation of the mesh's faces.
    const Vec3 n =
        cross(posed.position[c[1]] - posed.position[c[0]], posed.position[c[2]] - posed.position[c[0]]);
    const float side = doubled_area(mesh.uv(c[0]), mesh.uv(c[1]), mesh.uv(c[2])) > 0 ? -1.0f : 1.0f;
    for (VertexId v : c) normal_[v] = normal_[v] + side * n;
  }
  for (VertexId v : mesh.vertices()) {
    normal_[v] = projector.rotated(normalised(normal_[v]));
    facing_[v] = -dot(normal_[v], normalised(projector.to_camera(posed.position[v])));
  }
}

/// The middle of boundary edge k of face f. \return false if the face is not visible.
bool SilhouetteFinder::border_point(const PosedMesh& posed, FaceId f, int k, SilhouettePoint* p) const {
  const Mesh& mesh = posed.mesh;
  const HalfEdgeId h = Mesh::half_edge(f, k);
  const VertexId a = mesh.origin(h), b = mesh.destination(h), c = mesh.origin(Mesh::previous(h));
  if (!(posed.depth[c] > 0) || !faces_camera(mesh, posed.image, f)) return false;
  const Vec2 along = posed.image[b] - posed.image[a], across{along.y, -along.x};
  const float size = length(across);
  if (!(size > 0)) return false;
  const float outwards = dot(across, posed.image[c] - posed.image[a]) > 0 ? -1.0f : 1.0f;
  *p = {0.5f * (mesh.uv(a) + mesh.uv(b)), 0.5f * (posed.image[a] + posed.image[b]),
        (outwards / size) * across, 0.5f * (posed.depth[a] + posed.depth[b]), true};
  return true;
}

/// The point at which the occluding contour crosses the edge from a to b. One end is turned to the camera, the other away.
bool SilhouetteFinder::contour_point(const PosedMesh& posed, const Projector& projector, VertexId a,
                                     VertexId b, SilhouettePoint* p) const {
  const float t = facing_[a] / (facing_[a] - facing_[b]);
  const Vec3 n = normal_[a] + t * (normal_[b] - normal_[a]);
  const float size = length(Vec2{n.x, n.y});
  if (!(size > 0)) return false;
  const Vec2 uv = posed.mesh.uv(a) + t * (posed.mesh.uv(b) - posed.mesh.uv(a));
  *p = {uv, {}, {n.x / size, n.y / size}, posed.depth[a] + t * (posed.depth[b] - posed.depth[a]), false};
  return projector.project(posed.position[a] + t * (posed.position[b] - posed.position[a]), &p->x);
}

std::size_t SilhouetteFinder::find(const PosedMesh& posed, const Projector& projector,
                                   const DepthBuffer* hidden, float margin, Span<SilhouettePoint> points) {
  const Mesh& mesh = posed.mesh;
  PLIANT_ASSERT(mesh.limits().vertices <= capacity_);
  compute_facing(posed, projector);
  std::size_t found = 0;
  const auto add = [&](const SilhouettePoint& p) {
    if (hidden != nullptr && hidden->hides(p.x + hidden->cell_px() * p.normal, p.depth, margin)) return;
    if (found < points.count) points[found] = p;
    ++found;
  };
  for (FaceId f : mesh.faces())
    for (int k = 0; k < 3; ++k) {
      const HalfEdgeId h = Mesh::half_edge(f, k);
      const VertexId a = mesh.origin(h), b = mesh.destination(h);
      if (!mesh.represents_edge(h) || !(posed.depth[a] > 0 && posed.depth[b] > 0)) continue;
      SilhouettePoint p;
      if (mesh.is_boundary_edge(h) && border_point(posed, f, k, &p)) add(p);
      const bool crosses = (facing_[a] >= 0) != (facing_[b] >= 0);
      if (crosses && contour_point(posed, projector, a, b, &p)) add(p);
    }
  return found;
}

}  // namespace pliant
