// Queries on the half-edge mesh that walk.
#include "pliant/mesh.hpp"

namespace pliant {

int Mesh::find_valence(VertexId v) const {
  int edges = is_boundary_vertex(v) ? 1 : 0;  // the fan's last edge leaves no half-edge
  for (const HalfEdgeId h : star(v)) {
    (void)h;
    ++edges;
  }
  return edges;
}

HalfEdgeId Mesh::find_half_edge(VertexId a, VertexId b) const {
  for (const HalfEdgeId h : star(a))
    if (destination(h) == b) return h;
  return kNone;
}

// A loop is counted at its lowest half-edge; a walk that meets a lower one stops, which is soon for most.
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
    const HalfEdgeId outer = faces_[f].twin[k];
    t.corner[k] = faces_[f].corner[k];
    t.across[k] = outer == kNone ? kNone : origin(previous(outer));
  }
  t.level = face_level(f);
  return t;
}

int Mesh::find_parents(VertexId v, Triangle parents[2]) const {
  // On either side of the split edge: faces (z,x,v) and (y,z,v) of parent (x,y,z).
  const FaceId g = face_of(out(v)), f = face_of(faces_[g].twin[1]);
  const HalfEdgeId t = faces_[g].twin[2];
  const FaceId b = t == kNone ? kNone : face_of(t);
  const FaceId first[2] = {f, b};
  const FaceId second[2] = {g, b == kNone ? kNone : face_of(faces_[b].twin[2])};
  const int count = b == kNone ? 1 : 2;
  for (int i = 0; i < count; ++i) {
    const Face& low = faces_[first[i]];
    const Face& high = faces_[second[i]];
    const HalfEdgeId yz = high.twin[0], zx = low.twin[0];
    parents[i] =
        Triangle{{low.corner[1], high.corner[0], low.corner[0]},
                 {count == 1 ? kNone : corner(first[1 - i], 0), yz == kNone ? kNone : origin(previous(yz)),
                  zx == kNone ? kNone : origin(previous(zx))},
                 level(v) - 1};
  }
  return count;
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
    const Vec2 a = uv(corner(f, 0)), ab = uv(corner(f, 1)) - a, ac = uv(corner(f, 2)) - a;
    if (ab.x * ac.y - ab.y * ac.x < 0) ++s.folded_faces;
  }
  return s;
}

}  // namespace pliant
