// Queries that walk over the half-edge mesh.
#include "pliant/mesh.hpp"
#include "pliant/mesh_star.hpp"

namespace pliant {

namespace {

/// The third corner of the face beyond a half-edge; kNone on the boundary.
VertexId across(const Mesh& mesh, HalfEdgeId h) {
  const HalfEdgeId outer = mesh.twin(h);
  return outer == kNone ? kNone : mesh.origin(Mesh::previous(outer));
}

}  // namespace

int Mesh::find_valence(VertexId v) const {
  int edges = is_boundary_vertex(v) ? 1 : 0;  // the fan's last edge leaves no half-edge
  for (const HalfEdgeId h : star(*this, v)) {
    (void)h;
    ++edges;
  }
  return edges;
}

HalfEdgeId Mesh::find_half_edge(VertexId a, VertexId b) const {
  for (const HalfEdgeId h : star(*this, a))
    if (destination(h) == b) return h;
  return kNone;
}

// A loop is counted at its lowest half-edge. A walk stops when it meets a lower one, for most starts soon.
int Mesh::find_boundary_loops(Span<HalfEdgeId> loops) const {
  int count = 0;
  for (const FaceId f : faces())
    for (int k = 0; k < 3; ++k) {
      const HalfEdgeId first = half_edge(f, k);
      if (twin(first) != kNone) continue;
      HalfEdgeId h = next_on_boundary(first);
      for (int step = 0; h > first && step < boundary_edges_; ++step) h = next_on_boundary(h);
      if (h != first) continue;
      if (static_cast<std::size_t>(count) < loops.count) loops[static_cast<std::size_t>(count)] = first;
      ++count;
    }
  return count;
}

Triangle Mesh::triangle(FaceId f) const {
  Triangle t;
  for (int k = 0; k < 3; ++k) {
    t.corner[k] = corner(f, k);
    t.across[k] = across(*this, half_edge(f, k));
  }
  t.level = face_level(f);
  return t;
}

int Mesh::find_parents(VertexId v, Triangle parents[2]) const {
  // On either side of the split edge: faces (z,x,v) and (y,z,v) of parent (x,y,z).
  FaceId faces[4];
  const int count = find_star_faces(v, faces) / 2;
  for (int i = 0; i < count; ++i) {
    const FaceId low = faces[2 * i], high = faces[2 * i + 1];
    parents[i] = Triangle{{corner(low, 1), corner(high, 0), corner(low, 0)},
                          {count == 1 ? kNone : corner(faces[2 - 2 * i], 0),
                           across(*this, half_edge(high, 0)), across(*this, half_edge(low, 0))},
                          level(v) - 1};
  }
  return count;
}

int Mesh::find_star_faces(VertexId v, FaceId faces[4]) const {
  PLIANT_ASSERT(is_weldable(v));
  const HalfEdgeId h = vertices_[v].out;
  faces[1] = face_of(h);
  faces[0] = face_of(twin_[3 * faces[1] + 1]);
  const HalfEdgeId t = twin_[h];
  if (t == kNone) return 2;
  faces[2] = face_of(t);
  faces[3] = face_of(twin_[3 * faces[2] + 2]);
  return 4;
}

MeshStatistics Mesh::compute_statistics() const {
  MeshStatistics s;
  s.vertices = vertex_count();
  s.edges = edge_count();
  s.faces = face_count();
  s.boundary_edges = boundary_edges_;
  s.boundary_loops = find_boundary_loops({});
  s.euler = s.vertices - s.edges + s.faces;
  for (const VertexId v : vertices()) {
    const int valence = find_valence(v);
    if (valence > s.largest_valence) s.largest_valence = valence;
    if (level(v) > s.deepest) s.deepest = level(v);
  }
  for (const FaceId f : faces()) {
    const int l = face_level(f);
    if (l <= MeshLimits::kDeepest) ++s.faces_at_level[l];
    if (doubled_area(uv(corner(f, 0)), uv(corner(f, 1)), uv(corner(f, 2))) < 0) ++s.folded_faces;
  }
  return s;
}

}  // namespace pliant
