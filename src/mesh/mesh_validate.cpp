// Checks of the invariants of the half-edge mesh; MeshFault lists their numbers.
#include <cstring>

#include "pliant/mesh.hpp"
#include "pliant/mesh_star.hpp"

namespace pliant {
namespace {

// FNV-1a, a 32-bit word at a time.
struct Digest {
  std::uint32_t value = 2166136261u;
  void add(std::uint32_t word) { value = (value ^ word) * 16777619u; }
  void add(float x) {
    std::uint32_t word;
    std::memcpy(&word, &x, sizeof word);
    add(word);
  }
};

}  // namespace

MeshFault Mesh::check_half_edges() const {
  for (const FaceId f : faces())
    for (int k = 0; k < 3; ++k)
      if (!is_live_vertex(corner(f, k)) || corner(f, k) == corner(f, (k + 1) % 3))
        return {1, half_edge(f, k)};
  for (const FaceId f : faces())
    for (int k = 0; k < 3; ++k) {
      const HalfEdgeId h = half_edge(f, k), t = twin(half_edge(f, k));
      const VertexId a = corner(f, k), b = corner(f, (k + 1) % 3);
      if (t == kNone) continue;
      if (t == h || !is_live_face(face_of(t)) || twin(t) != h) return {2, h};
      if (origin(t) != b || destination(t) != a) return {3, h};
    }
  return {};
}

MeshFault Mesh::check_stars() const {
  int met = 0, boundary = 0;
  for (const FaceId f : faces())
    for (int k = 0; k < 3; ++k)
      if (twin(half_edge(f, k)) == kNone) {
        ++boundary;
        if (out(corner(f, k)) != half_edge(f, k)) return {4, corner(f, k)};
      }
  for (const VertexId v : vertices()) {
    if (out(v) == kNone || !is_live_face(face_of(out(v))) || origin(out(v)) != v) return {4, v};
    int here = 0;
    for (const HalfEdgeId h : star(*this, v)) {
      if (origin(h) != v || ++here > face_count()) return {5, v};
    }
    met += here;
  }
  if (met != 3 * face_count()) return {5, met};
  if (boundary != boundary_edges_) return {7, boundary};
  return {};
}

MeshFault Mesh::check_dead() const {
  for (std::size_t i = 0; i < face_ids_.capacity(); ++i)
    if (!is_live_face(static_cast<FaceId>(i)))
      for (int k = 0; k < 3; ++k)
        if (corner_[3 * i + static_cast<std::size_t>(k)] != kNone ||
            twin_[3 * i + static_cast<std::size_t>(k)] != kNone)
          return {8, static_cast<int>(i)};
  for (std::size_t i = 0; i < vertex_ids_.capacity(); ++i) {
    const Vertex& v = vertices_[i];
    if (!is_live_vertex(static_cast<VertexId>(i)) &&
        (v.out != kNone || v.level != 0 || v.uv.x < 0 || v.uv.x > 0 || v.uv.y < 0 || v.uv.y > 0))
      return {8, static_cast<int>(i)};
  }
  return {};
}

MeshFault Mesh::check_geometry() const {
  for (const FaceId f : faces()) {
    const float area = doubled_area(uv(corner(f, 0)), uv(corner(f, 1)), uv(corner(f, 2)));
    if (!(area < 0 || area > 0)) return {9, f};
  }
  return {};
}

MeshFault Mesh::check_levels() const {
  for (const VertexId v : vertices())
    if (v < base_vertices_ ? level(v) != 0 : level(v) < 1 || level(v) > limits_.max_level) return {10, v};
  for (const FaceId f : faces()) {
    const int top = face_level(f);
    if (level(corner(f, 0)) > top || level(corner(f, 1)) > top) return {10, f};
    for (int k = 0; k < 3; ++k) {
      const HalfEdgeId t = twin(half_edge(f, k));
      if (t == kNone) continue;
      const int other = face_level(face_of(t)), subdivided = (k == 0 ? 1 : 0) + (corner_of(t) == 0 ? 1 : 0);
      const bool fits = subdivided == 1 ? top - other == (k == 0 ? 1 : -1) : top == other;
      if (!fits) return {11, half_edge(f, k)};
    }
  }
  return {};
}

MeshFault Mesh::check_inserted() const {
  for (std::size_t i = static_cast<std::size_t>(base_vertices_); i < vertex_ids_.capacity(); ++i) {
    const auto v = static_cast<VertexId>(i);
    if (!is_live_vertex(v)) continue;
    int around = 0;
    for (const HalfEdgeId h : star(*this, v)) {
      (void)h;
      ++around;
    }
    if (around > 8) return {12, v};
    if (!is_weldable(v)) continue;
    Triangle parents[2];
    (void)find_parents(v, parents);
    const Vec2 middle = 0.5f * (uv(parents[0].corner[0]) + uv(parents[0].corner[1])), d = uv(v) - middle;
    if (d.x < 0 || d.x > 0 || d.y < 0 || d.y > 0) return {13, v};
  }
  return {};
}

MeshFault Mesh::validate() const {
  MeshFault fault = check_half_edges();
  if (fault.invariant == 0) fault = check_stars();
  if (fault.invariant == 0 && restricted_ &&
      (vertex_count() - edge_count() + face_count() != base_euler_ || find_boundary_loops({}) != base_loops_))
    fault = {6, vertex_count() - edge_count() + face_count()};
  if (fault.invariant == 0) fault = check_dead();
  if (fault.invariant == 0) fault = check_geometry();
  if (fault.invariant == 0 && restricted_) fault = check_levels();
  if (fault.invariant == 0 && restricted_) fault = check_inserted();
  return fault;
}

std::uint32_t Mesh::compute_digest() const {
  Digest digest;
  for (const VertexId v : vertices()) {
    digest.add(std::uint32_t{v} << 16 | out(v));
    digest.add(static_cast<std::uint32_t>(level(v)));
    digest.add(uv(v).x);
    digest.add(uv(v).y);
  }
  for (const FaceId f : faces()) {
    digest.add(std::uint32_t{f});
    for (int k = 0; k < 3; ++k) digest.add(std::uint32_t{corner(f, k)} << 16 | twin(half_edge(f, k)));
  }
  return digest.value;
}

}  // namespace pliant
