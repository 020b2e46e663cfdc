// Makes a half-edge mesh of triangles and checks them, without memory besides the mesh's own.
#include "base/arrays.hpp"
#include "pliant/mesh.hpp"
#include "pliant/mesh_star.hpp"

namespace pliant {

void Mesh::clear() {
  for (std::size_t h = 0; h < 3 * std::size_t{limits_.faces}; ++h) corner_[h] = twin_[h] = kNone;
  for (std::size_t v = 0; v < limits_.vertices; ++v) {
    vertices_[v] = Vertex{kNone, 0, 0, {0, 0}};
    changes_[v] = 0;
  }
  face_ids_.reset(0);
  vertex_ids_.reset(0);
  change_count_ = 0;
  boundary_edges_ = base_vertices_ = base_faces_ = base_euler_ = base_loops_ = 0;
  restricted_ = false;
}

Status Mesh::check_triangles(Span<const Vec2> uv, Span<const std::uint16_t> corners,
                             const MeshLimits& limits) {
  if (uv.data == nullptr || corners.data == nullptr || corners.count == 0 || corners.count % 3 != 0)
    return Status::bad_argument;
  if (uv.count > limits.vertices || corners.count / 3 > limits.faces) return Status::capacity;
  for (const Vec2 p : uv)
    if (!is_finite(p)) return Status::bad_argument;
  for (const std::uint16_t v : corners)
    if (v >= uv.count) return Status::bad_index;
  for (std::size_t i = 0; i < corners.count; i += 3) {
    const std::uint16_t* c = corners.data + i;
    const float area = doubled_area(uv[c[0]], uv[c[1]], uv[c[2]]);
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0] || !is_finite(area) || !(area < 0 || area > 0))
      return Status::degenerate_face;
  }
  return Status::ok;
}

// While twins are being found, the half-edges that leave a vertex and have no twin yet form a list: out(v) is its head,
// twin(h) the next entry. A half-edge whose twin is found leaves the list, so its twin entry can hold the result.
bool Mesh::take_from_bucket(HalfEdgeId h) {
  HalfEdgeId* at = &vertices_[origin(h)].out;
  while (*at != kNone && *at != h) at = &twin_[*at];
  if (*at == kNone) return false;
  *at = twin(h);
  return true;
}

// Finds the twin of h among all half-edges between its ends. \return the defect, if there is one.
Status Mesh::find_twin(HalfEdgeId h) {
  if (!take_from_bucket(h)) return Status::ok;
  const VertexId a = origin(h), b = destination(h);
  constexpr int kEnough = 4;  // more faces on one edge than this need no looking at
  HalfEdgeId others[kEnough];
  int count = 0;
  for (HalfEdgeId e = out(a); e != kNone && count < kEnough; e = twin(e))
    if (destination(e) == b) others[count++] = e;
  const bool winds_alike = count > 0;
  for (HalfEdgeId e = out(b); e != kNone && count < kEnough; e = twin(e))
    if (destination(e) == a) others[count++] = e;

  for (int i = 0; i < count; ++i)
    for (int j = i; j < count; ++j) {
      const HalfEdgeId other = j == i ? h : others[j];
      if (origin(previous(others[i])) == origin(previous(other))) return Status::duplicate_face;
    }
  if (count > 1) return Status::non_manifold_edge;
  if (winds_alike) return Status::non_orientable;
  if (count == 0) {
    twin_[h] = kNone;
    ++boundary_edges_;
  } else {
    (void)take_from_bucket(others[0]);
    link(h, others[0]);
  }
  return Status::ok;
}

Status Mesh::find_twins() {
  const int half_edges = 3 * face_count();
  for (int h = half_edges - 1; h >= 0; --h) {
    const auto id = static_cast<HalfEdgeId>(h);
    twin_[id] = vertices_[origin(id)].out;
    vertices_[origin(id)].out = id;
  }
  for (int h = 0; h < half_edges; ++h) {
    const Status status = find_twin(static_cast<HalfEdgeId>(h));
    if (status != Status::ok) return status;
  }
  return Status::ok;
}

// Gives every vertex its outgoing half-edge, and checks that its faces form one fan. Counts faces a vertex in changes_.
Status Mesh::find_fans() {
  for (const FaceId f : faces())
    for (int k = 0; k < 3; ++k) {
      const HalfEdgeId h = half_edge(f, k);
      Vertex& vertex = vertices_[corner(f, k)];
      if (vertex.out == kNone || (twin(h) == kNone && twin(vertex.out) != kNone)) vertex.out = h;
      ++changes_[corner(f, k)];
    }
  for (const VertexId v : vertices()) {
    if (changes_[v] == 0) return Status::isolated_vertex;
    int faces_met = 0;
    for (const HalfEdgeId h : star(*this, v)) {
      (void)h;
      ++faces_met;
    }
    if (faces_met != changes_[v]) return Status::non_manifold_vertex;
    changes_[v] = 0;
  }
  return Status::ok;
}

bool Mesh::is_basic_blocks() const {
  for (const FaceId f : faces())
    for (int k = 0; k < 3; ++k) {
      const HalfEdgeId t = twin(half_edge(f, k));
      if (t != kNone && (k == 0) != (corner_of(t) == 0)) return false;
    }
  return true;
}

Status Mesh::set_triangles(Span<const Vec2> uv, Span<const std::uint16_t> corners) {
  if (vertices_ == nullptr) return Status::bad_argument;
  clear();
  Status status = check_triangles(uv, corners, limits_);
  if (status != Status::ok) return status;
  copy(corners.data, corners.count, corner_);
  for (std::size_t v = 0; v < uv.count; ++v) vertices_[v].uv = uv[v];
  face_ids_.reset(corners.count / 3);
  vertex_ids_.reset(uv.count);
  status = find_twins();
  if (status == Status::ok) status = find_fans();
  if (status != Status::ok) clear();
  return status;
}

Status Mesh::make_base() {
  if (restricted_ || face_count() == 0) return Status::not_ready;
  // Base ids have to be the lowest ones. They are, unless the free mesh was welded in another order than it was split.
  const auto vertex_total = static_cast<std::size_t>(vertex_count()),
             face_total = static_cast<std::size_t>(face_count());
  if (vertex_ids_.next_used(vertex_total) != vertex_ids_.capacity() ||
      face_ids_.next_used(face_total) != face_ids_.capacity())
    return Status::not_ready;
  if (!is_basic_blocks()) return Status::not_basic_blocks;
  for (const VertexId v : vertices()) vertices_[v].level = 0;
  clear_changes();
  base_vertices_ = vertex_count();
  base_faces_ = face_count();
  base_euler_ = vertex_count() - edge_count() + face_count();
  base_loops_ = find_boundary_loops({});
  restricted_ = true;
  return Status::ok;
}

Status Mesh::set_base(Span<const Vec2> uv, Span<const std::uint16_t> corners) {
  Status status = set_triangles(uv, corners);
  if (status == Status::ok) {
    status = make_base();
    if (status != Status::ok) clear();
  }
  return status;
}

Status Mesh::copy_from(const Mesh& other) {
  if (vertices_ == nullptr || other.vertices_ == nullptr || other.limits_.vertices != limits_.vertices ||
      other.limits_.faces != limits_.faces || other.limits_.max_level != limits_.max_level)
    return Status::bad_argument;
  const std::size_t half_edges = 3 * std::size_t{limits_.faces};
  copy(other.corner_, half_edges, corner_);
  copy(other.twin_, half_edges, twin_);
  copy(other.vertices_, limits_.vertices, vertices_);
  copy(other.changes_, limits_.vertices, changes_);
  face_ids_.copy_from(other.face_ids_);
  vertex_ids_.copy_from(other.vertex_ids_);
  change_count_ = other.change_count_;
  boundary_edges_ = other.boundary_edges_;
  base_vertices_ = other.base_vertices_;
  base_faces_ = other.base_faces_;
  base_euler_ = other.base_euler_;
  base_loops_ = other.base_loops_;
  restricted_ = other.restricted_;
  return Status::ok;
}

}  // namespace pliant
