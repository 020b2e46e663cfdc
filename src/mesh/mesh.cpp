// The four stellar operators and restricted refinement on a half-edge mesh (the paper, section 4).
//
// One rule makes every split invertible without a history. Of the two halves of a bisected face, the one at the origin of
// the subdivision edge keeps the face's id, and the new vertex is corner 2 of both halves. So when a vertex is corner 2 of
// all its faces, these are exactly as its split left them. The split sets out(v) along the split edge, and later operators
// keep its direction: it gives the edge to restore.
#include "pliant/mesh.hpp"

#include "pliant/mesh_star.hpp"

namespace pliant {
namespace {

VertexId narrow(std::uint32_t id) {
  return static_cast<VertexId>(id);
}

Vec2 midpoint(Vec2 a, Vec2 b) {
  return 0.5f * (a + b);
}

// The sum of three numbers in ascending order, so that it does not depend on the order of the arguments.
float ordered_sum(float a, float b, float c) {
  const float low = min(a, min(b, c)), high = max(a, max(b, c));
  const float middle = max(min(a, b), min(max(a, b), c));
  return low + middle + high;
}

Vec2 barycentre(Vec2 a, Vec2 b, Vec2 c) {
  return (1.0f / 3.0f) * Vec2{ordered_sum(a.x, b.x, c.x), ordered_sum(a.y, b.y, c.y)};
}

}  // namespace

void Mesh::lay_out(Arena& arena, const MeshLimits& limits) {
  limits_ = limits;
  if (limits_.vertices > MeshLimits::kMostVertices) limits_.vertices = MeshLimits::kMostVertices;
  if (limits_.faces > MeshLimits::kMostFaces) limits_.faces = MeshLimits::kMostFaces;
  if (limits_.max_level > MeshLimits::kDeepest) limits_.max_level = MeshLimits::kDeepest;
  corner_ = arena.take<VertexId>(3 * std::size_t{limits_.faces});
  twin_ = arena.take<HalfEdgeId>(3 * std::size_t{limits_.faces});
  vertices_ = arena.take<Vertex>(limits_.vertices);
  changes_ = arena.take<VertexId>(limits_.vertices);
  face_ids_.lay_out(arena, limits_.faces);
  vertex_ids_.lay_out(arena, limits_.vertices);
  if (!arena.is_measuring() && !arena.exhausted()) clear();
}

// --- Records ---

// Ids are 32 bits wide inside functions: the code is smaller and faster.

void Mesh::set_face(Wide f, Wide a, Wide b, Wide c) {
  VertexId* corner = corner_ + 3 * f;
  corner[0] = narrow(a);
  corner[1] = narrow(b);
  corner[2] = narrow(c);
}

void Mesh::link(Wide a, Wide b) {
  twin_[a] = narrow(b);
  twin_[b] = narrow(a);
}

// Makes `outer` (or the boundary) the twin of h.
void Mesh::attach(Wide h, Wide outer) {
  twin_[h] = narrow(outer);
  if (outer != kNone) twin_[outer] = narrow(h);
}

// Half-edge `from` becomes half-edge `to`.
void Mesh::move_out(Wide v, Wide from, Wide to) {
  const Wide out = vertices_[v].out;
  vertices_[v].out = narrow(out == from ? to : out);
}

void Mesh::note_change(VertexId v) {
  if (vertices_[v].changed != 0) return;
  vertices_[v].changed = 1;
  changes_[change_count_++] = v;
}

// Unused entries of the list are zero, so that equal meshes have equal bytes.
void Mesh::clear_changes() {
  for (std::size_t i = 0; i < change_count_; ++i) {
    vertices_[changes_[i]].changed = 0;
    changes_[i] = 0;
  }
  change_count_ = 0;
}

VertexId Mesh::insert_vertex(Vec2 uv, int level) {
  const VertexId v = vertex_ids_.take();
  vertices_[v].uv = uv;
  vertices_[v].level = static_cast<std::uint8_t>(level);
  note_change(v);
  return v;
}

void Mesh::remove_vertex(VertexId v) {
  note_change(v);
  vertices_[v] = Vertex{kNone, 0, vertices_[v].changed, {0, 0}};
  vertex_ids_.put_back(v);
}

void Mesh::remove_face(Wide f) {
  set_face(f, kNone, kNone, kNone);
  for (Wide k = 0; k < 3; ++k) twin_[3 * f + k] = kNone;
  face_ids_.put_back(narrow(f));
}

// --- Edge split and weld ---

// Half-edge h of face f runs from x to y, and z is opposite: f becomes (z,x,m); the new face is (y,z,m). The
// halves of the split edge, 3f+1 and 3g+2, are left open.
Mesh::Wide Mesh::bisect(Wide h, Wide m) {
  const Wide f0 = h / 3 * 3, g = face_ids_.take(), g0 = 3 * g;
  const Wide n = h == f0 + 2 ? f0 : h + 1, p = h == f0 ? f0 + 2 : h - 1;
  const Wide x = corner_[h], y = corner_[n], z = corner_[p], yz = twin_[n], zx = twin_[p];
  set_face(h / 3, z, x, m);
  set_face(g, y, z, m);
  attach(f0, zx);
  attach(g0, yz);
  link(f0 + 2, g0 + 1);
  move_out(z, p, f0);
  move_out(x, h, f0 + 1);
  move_out(y, n, g0);
  return g;
}

// The reverse of bisect: f = (z,x,m) and g = (y,z,m) become f = (x,y,z); its subdivision edge is left open.
void Mesh::join(Wide f, Wide g) {
  const Wide f0 = 3 * f, g0 = 3 * g;
  const Wide z = corner_[f0], x = corner_[f0 + 1], y = corner_[g0];
  const Wide yz = twin_[g0], zx = twin_[f0];
  set_face(f, x, y, z);
  attach(f0 + 1, yz);
  attach(f0 + 2, zx);
  move_out(z, f0, f0 + 2);
  move_out(x, f0 + 1, f0);
  move_out(y, g0, f0 + 1);
  remove_face(g);
}

VertexId Mesh::split_ready_edge(HalfEdgeId h) {
  PLIANT_ASSERT(face_ids_.free_count() >= (twin_[h] == kNone ? 1u : 2u) && vertex_ids_.free_count() >= 1);
  PLIANT_ASSERT(!restricted_ || (corner_of(h) == 0 && is_ready(face_of(h))));
  const Wide f = h / 3, t = twin_[h], y = corner_[next(narrow(h))];
  const VertexId m = insert_vertex(midpoint(vertices_[corner_[h]].uv, vertices_[y].uv), newest_level(f) + 1);
  const Wide g = bisect(h, m);
  if (t == kNone) {
    twin_[3 * f + 1] = twin_[3 * g + 2] = kNone;
    ++boundary_edges_;
  } else {
    const Wide b = t / 3, nb = bisect(t, m);
    link(3 * f + 1, 3 * nb + 2);
    link(3 * g + 2, 3 * b + 1);
  }
  vertices_[m].out = narrow(3 * g + 2);
  return m;
}

void Mesh::weld_weldable(VertexId v) {
  PLIANT_ASSERT(is_weldable(v));
  const Wide g = vertices_[v].out / 3u, f = twin_[3 * g + 1] / 3u, t = twin_[3 * g + 2];
  if (t == kNone) {
    join(f, g);
    twin_[3 * f] = kNone;
    --boundary_edges_;
  } else {
    const Wide b = t / 3;
    join(b, twin_[3 * b + 2] / 3u);
    join(f, g);
    link(3 * f, 3 * b);
  }
  remove_vertex(v);
}

// Corner 2 has the highest level of a face of a restricted mesh. On a free mesh any corner may have it.
int Mesh::newest_level(Wide f) const {
  int newest = vertices_[corner_[3 * f + 2]].level;
  for (Wide k = 0; !restricted_ && k < 2; ++k)
    if (vertices_[corner_[3 * f + k]].level > newest) newest = vertices_[corner_[3 * f + k]].level;
  return newest;
}

Status Mesh::split_edge(HalfEdgeId h, VertexId& inserted) {
  const FaceId f = face_of(h);
  if (h == kNone || !is_live_face(f)) return Status::not_ready;
  const HalfEdgeId t = twin(h);
  if (restricted_) {
    if (corner_of(h) != 0 || !is_ready(f) || face_level(f) >= limits_.max_level) return Status::not_ready;
  } else {
    if (newest_level(f) == 255) return Status::not_ready;
  }
  if (vertex_ids_.free_count() < 1 || face_ids_.free_count() < (t == kNone ? 1u : 2u))
    return Status::capacity;
  inserted = split_ready_edge(h);
  return Status::ok;
}

bool Mesh::is_weldable(VertexId v) const {
  if (!is_live_vertex(v) || level(v) == 0) return false;
  int faces = 0;
  for (const HalfEdgeId h : star(*this, v))
    if (corner_of(h) != 2 || ++faces > 4) return false;
  return restricted_ || faces == (is_boundary_vertex(v) ? 2 : 4);
}

Status Mesh::weld_edge(VertexId v) {
  if (!is_weldable(v)) return Status::not_ready;
  weld_weldable(v);
  return Status::ok;
}

// --- Face split and weld ---

Status Mesh::split_face(FaceId f, VertexId& inserted) {
  if (restricted_ || !is_live_face(f)) return Status::not_ready;
  const int top = newest_level(f);
  if (top == 255) return Status::not_ready;
  if (vertex_ids_.free_count() < 1 || face_ids_.free_count() < 2) return Status::capacity;
  const VertexId a = corner(f, 0), b = corner(f, 1), c = corner(f, 2);
  const HalfEdgeId bc = twin(half_edge(f, 1)), ca = twin(half_edge(f, 2));
  const VertexId m = insert_vertex(barycentre(uv(a), uv(b), uv(c)), top + 1);
  const FaceId g = face_ids_.take(), h = face_ids_.take();
  set_face(f, a, b, m);
  set_face(g, b, c, m);
  set_face(h, c, a, m);
  attach(half_edge(g, 0), bc);
  attach(half_edge(h, 0), ca);
  link(half_edge(f, 1), half_edge(g, 2));
  link(half_edge(g, 1), half_edge(h, 2));
  link(half_edge(h, 1), half_edge(f, 2));
  if (vertices_[b].out == half_edge(f, 1)) vertices_[b].out = half_edge(g, 0);
  if (vertices_[c].out == half_edge(f, 2)) vertices_[c].out = half_edge(h, 0);
  vertices_[m].out = half_edge(f, 2);
  inserted = m;
  return Status::ok;
}

Status Mesh::weld_face(VertexId v) {
  if (restricted_ || !is_live_vertex(v) || level(v) == 0 || is_boundary_vertex(v)) return Status::not_ready;
  int faces = 0;
  for (const HalfEdgeId e : star(*this, v))
    if (corner_of(e) != 2 || ++faces > 3) return Status::not_ready;
  if (faces != 3) return Status::not_ready;
  const FaceId f = face_of(out(v)), g = face_of(twin(half_edge(f, 1))), h = face_of(twin(half_edge(f, 2)));
  const VertexId a = corner(f, 0), b = corner(g, 0), c = corner(h, 0);
  set_face(f, a, b, c);
  attach(half_edge(f, 1), twin(half_edge(g, 0)));
  attach(half_edge(f, 2), twin(half_edge(h, 0)));
  if (vertices_[b].out == half_edge(g, 0)) vertices_[b].out = half_edge(f, 1);
  if (vertices_[c].out == half_edge(h, 0)) vertices_[c].out = half_edge(f, 2);
  remove_face(h);
  remove_face(g);
  remove_vertex(v);
  return Status::ok;
}

// --- Restricted refinement and simplification ---

// Where f's subdivision edge is not its neighbour's, the neighbour is one level coarser and must be split
// first. Levels fall along the chain, so it ends.
int Mesh::find_refinement_chain(FaceId f, FaceId* chain, int* new_faces) const {
  int count = 0;
  *new_faces = 0;
  for (;;) {
    chain[count++] = f;
    const HalfEdgeId t = twin_[3 * f];
    *new_faces += t == kNone ? 1 : 2;
    if (t == kNone || corner_of(t) == 0) return count;
    f = face_of(t);
    PLIANT_ASSERT(count <= limits_.max_level);
  }
}

Status Mesh::refine(FaceId f) {
  if (!restricted_ || !is_live_face(f) || face_level(f) >= limits_.max_level) return Status::not_ready;
  FaceId chain[MeshLimits::kDeepest + 1];
  int new_faces = 0;
  int count = find_refinement_chain(f, chain, &new_faces);
  if (vertex_ids_.free_count() < static_cast<std::size_t>(count) ||
      face_ids_.free_count() < static_cast<std::size_t>(new_faces))
    return Status::capacity;
  while (count > 0) split_ready_edge(half_edge(chain[--count], 0));
  return Status::ok;
}

// A face around v with a newer vertex at corner 2 prevents the weld: that vertex is welded first. Levels rise along the
// stack, so it is not deeper than the number of levels. Each turn pushes a vertex or removes one.
Status Mesh::simplify(VertexId v) {
  if (!restricted_ || !is_live_vertex(v) || level(v) == 0) return Status::not_ready;
  VertexId stack[MeshLimits::kDeepest + 1];
  int depth = 0;
  stack[depth++] = v;
  while (depth > 0) {
    const VertexId w = stack[depth - 1];
    VertexId newer = kNone;
    for (const HalfEdgeId h : star(*this, w))
      if (corner_of(h) != 2) {
        newer = corner(face_of(h), 2);
        break;
      }
    if (newer != kNone) {
      stack[depth++] = newer;
    } else {
      weld_weldable(w);
      --depth;
    }
  }
  return Status::ok;
}

void Mesh::simplify_all() {
  if (!restricted_) return;
  for (std::size_t v = static_cast<std::size_t>(base_vertices_); v < vertex_ids_.capacity(); ++v)
    if (is_live_vertex(static_cast<VertexId>(v))) (void)simplify(static_cast<VertexId>(v));
}

}  // namespace pliant
