// The four stellar operators and restricted refinement on a half-edge mesh (the paper, section 4).
//
// One rule makes every split invertible without a history: of the two halves of a bisected face, the one at
// the origin of the subdivision edge keeps the face's id, and in both halves the new vertex is corner 2. A
// vertex all of whose faces still have it at corner 2 is therefore exactly as its split left it, and out(v),
// which the split put on the split edge and which every later operator leaves in its direction, tells which
// diagonal to restore.
#include "pliant/mesh.hpp"

namespace pliant {
namespace {

Vec2 midpoint(Vec2 a, Vec2 b) {
  return 0.5f * (a + b);
}

// The sum of three in rising order, so that it does not depend on which comes first.
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
  if (limits_.vertices > 65534) limits_.vertices = 65534;
  if (limits_.faces > 21845) limits_.faces = 21845;
  if (limits_.max_level > MeshLimits::kDeepest) limits_.max_level = MeshLimits::kDeepest;
  faces_ = arena.take<Face>(limits_.faces);
  vertices_ = arena.take<Vertex>(limits_.vertices);
  changes_ = arena.take<VertexId>(limits_.vertices);
  face_ids_.lay_out(arena, limits_.faces);
  vertex_ids_.lay_out(arena, limits_.vertices);
  if (!arena.is_measuring() && !arena.exhausted()) clear();
}

// --- Records ---

void Mesh::link(HalfEdgeId a, HalfEdgeId b) {
  faces_[face_of(a)].twin[corner_of(a)] = b;
  faces_[face_of(b)].twin[corner_of(b)] = a;
}

// Makes `outer` (or the boundary) the twin of h.
void Mesh::attach(HalfEdgeId h, HalfEdgeId outer) {
  faces_[face_of(h)].twin[corner_of(h)] = outer;
  if (outer != kNone) faces_[face_of(outer)].twin[corner_of(outer)] = h;
}

void Mesh::note_change(VertexId v) {
  if (vertices_[v].changed != 0) return;
  vertices_[v].changed = 1;
  changes_[change_count_++] = v;
}

// Unused entries of the list are zero, so that the same mesh is the same bytes.
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

void Mesh::remove_face(FaceId f) {
  faces_[f] = Face{{kNone, kNone, kNone}, {kNone, kNone, kNone}};
  face_ids_.put_back(f);
}

// --- Edge split and weld ---

// f = (x,y,z) becomes (z,x,m); the new face is (y,z,m). The halves of the split edge, 3f+1 and 3g+2, are left
// open.
FaceId Mesh::bisect(FaceId f, VertexId middle) {
  const FaceId g = face_ids_.take();
  Face& face = faces_[f];
  const VertexId x = face.corner[0], y = face.corner[1], z = face.corner[2];
  const HalfEdgeId yz = face.twin[1], zx = face.twin[2];
  const HalfEdgeId f0 = half_edge(f, 0), g0 = half_edge(g, 0);
  face = Face{{z, x, middle}, {zx, kNone, static_cast<HalfEdgeId>(g0 + 1)}};
  faces_[g] = Face{{y, z, middle}, {yz, static_cast<HalfEdgeId>(f0 + 2), kNone}};
  if (zx != kNone) faces_[face_of(zx)].twin[corner_of(zx)] = f0;
  if (yz != kNone) faces_[face_of(yz)].twin[corner_of(yz)] = g0;
  if (vertices_[z].out == f0 + 2) vertices_[z].out = f0;
  if (vertices_[x].out == f0) vertices_[x].out = static_cast<HalfEdgeId>(f0 + 1);
  if (vertices_[y].out == f0 + 1) vertices_[y].out = g0;
  return g;
}

// The reverse of bisect: f = (z,x,m) and g = (y,z,m) become f = (x,y,z); its subdivision edge is left open.
void Mesh::join(FaceId f, FaceId g) {
  Face& face = faces_[f];
  const VertexId z = face.corner[0], x = face.corner[1], y = faces_[g].corner[0];
  const HalfEdgeId yz = faces_[g].twin[0], zx = face.twin[0];
  const HalfEdgeId f0 = half_edge(f, 0), g0 = half_edge(g, 0);
  face = Face{{x, y, z}, {kNone, yz, zx}};
  if (zx != kNone) faces_[face_of(zx)].twin[corner_of(zx)] = static_cast<HalfEdgeId>(f0 + 2);
  if (yz != kNone) faces_[face_of(yz)].twin[corner_of(yz)] = static_cast<HalfEdgeId>(f0 + 1);
  if (vertices_[z].out == f0) vertices_[z].out = static_cast<HalfEdgeId>(f0 + 2);
  if (vertices_[x].out == f0 + 1) vertices_[x].out = f0;
  if (vertices_[y].out == g0) vertices_[y].out = static_cast<HalfEdgeId>(f0 + 1);
  remove_face(g);
}

// Splits the subdivision edge of f, which is ready; there is room.
VertexId Mesh::split_ready(FaceId f) {
  const HalfEdgeId t = faces_[f].twin[0];
  const Vec2 middle = midpoint(uv(faces_[f].corner[0]), uv(faces_[f].corner[1]));
  int top = face_level(f);
  if (!restricted_)  // the levels of a free mesh follow no rule but that a new vertex is the newest
    for (int k = 0; k < 2; ++k) top = level(corner(f, k)) > top ? level(corner(f, k)) : top;
  const VertexId m = insert_vertex(middle, top + 1);
  const FaceId g = bisect(f, m);
  if (t == kNone) {
    ++boundary_edges_;
  } else {
    const FaceId b = face_of(t);
    const FaceId nb = bisect(b, m);
    link(half_edge(f, 1), half_edge(nb, 2));
    link(half_edge(g, 2), half_edge(b, 1));
  }
  vertices_[m].out = half_edge(g, 2);
  return m;
}

void Mesh::weld_star(VertexId v) {
  const FaceId g = face_of(out(v));
  const FaceId f = face_of(faces_[g].twin[1]);
  const HalfEdgeId t = faces_[g].twin[2];
  if (t == kNone) {
    join(f, g);
    --boundary_edges_;
  } else {
    const FaceId b = face_of(t);
    join(b, face_of(faces_[b].twin[2]));
    join(f, g);
    link(half_edge(f, 0), half_edge(b, 0));
  }
  remove_vertex(v);
}

// Turns the corners of a face so that h becomes its half-edge 0.
void Mesh::rotate_to_front(HalfEdgeId h) {
  const FaceId f = face_of(h);
  const int k = corner_of(h);
  if (k == 0) return;
  const Face old = faces_[f];
  bool is_out[3];
  for (int i = 0; i < 3; ++i) is_out[i] = vertices_[old.corner[i]].out == half_edge(f, i);
  for (int i = 0; i < 3; ++i) {
    const int from = (i + k) % 3;
    faces_[f].corner[i] = old.corner[from];
    attach(half_edge(f, i), old.twin[from]);
    if (is_out[from]) vertices_[old.corner[from]].out = half_edge(f, i);
  }
}

Status Mesh::split_edge(HalfEdgeId h, VertexId& inserted) {
  const FaceId f = face_of(h);
  if (h == kNone || !is_live_face(f)) return Status::not_ready;
  const HalfEdgeId t = twin(h);
  if (restricted_) {
    if (corner_of(h) != 0 || !is_ready(f) || face_level(f) >= limits_.max_level) return Status::not_ready;
  } else {
    for (int k = 0; k < 3; ++k)
      if (level(corner(f, k)) == 255 || (t != kNone && level(corner(face_of(t), k)) == 255))
        return Status::not_ready;
  }
  if (vertex_ids_.free_count() < 1 || face_ids_.free_count() < (t == kNone ? 1u : 2u))
    return Status::capacity;
  if (!restricted_) {
    rotate_to_front(h);
    if (t != kNone) rotate_to_front(faces_[f].twin[0]);
  }
  inserted = split_ready(f);
  return Status::ok;
}

bool Mesh::is_weldable(VertexId v) const {
  if (!is_live_vertex(v) || level(v) == 0) return false;
  int faces = 0;
  for (const HalfEdgeId h : star(v))
    if (corner_of(h) != 2 || ++faces > 4) return false;
  return restricted_ || faces == (is_boundary_vertex(v) ? 2 : 4);
}

Status Mesh::weld_edge(VertexId v) {
  if (!is_weldable(v)) return Status::not_ready;
  weld_star(v);
  return Status::ok;
}

// --- Face split and weld ---

Status Mesh::split_face(FaceId f, VertexId& inserted) {
  if (restricted_ || !is_live_face(f)) return Status::not_ready;
  int top = 0;
  for (int k = 0; k < 3; ++k) top = level(corner(f, k)) > top ? level(corner(f, k)) : top;
  if (top == 255) return Status::not_ready;
  if (vertex_ids_.free_count() < 1 || face_ids_.free_count() < 2) return Status::capacity;
  const Face old = faces_[f];
  const VertexId a = old.corner[0], b = old.corner[1], c = old.corner[2];
  const VertexId m = insert_vertex(barycentre(uv(a), uv(b), uv(c)), top + 1);
  const FaceId g = face_ids_.take(), h = face_ids_.take();
  faces_[f] = Face{{a, b, m}, {kNone, kNone, kNone}};
  faces_[g] = Face{{b, c, m}, {kNone, kNone, kNone}};
  faces_[h] = Face{{c, a, m}, {kNone, kNone, kNone}};
  attach(half_edge(f, 0), old.twin[0]);
  attach(half_edge(g, 0), old.twin[1]);
  attach(half_edge(h, 0), old.twin[2]);
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
  for (const HalfEdgeId e : star(v))
    if (corner_of(e) != 2 || ++faces > 3) return Status::not_ready;
  if (faces != 3) return Status::not_ready;
  const FaceId f = face_of(out(v)), g = face_of(faces_[f].twin[1]), h = face_of(faces_[f].twin[2]);
  const VertexId a = corner(f, 0), b = corner(g, 0), c = corner(h, 0);
  const HalfEdgeId ab = faces_[f].twin[0], bc = faces_[g].twin[0], ca = faces_[h].twin[0];
  faces_[f] = Face{{a, b, c}, {kNone, kNone, kNone}};
  attach(half_edge(f, 0), ab);
  attach(half_edge(f, 1), bc);
  attach(half_edge(f, 2), ca);
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
    const HalfEdgeId t = faces_[f].twin[0];
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
  while (count > 0) split_ready(chain[--count]);
  return Status::ok;
}

// What stands in the way of a weld is a face around v with a newer vertex at corner 2: that one goes first.
// Levels rise along the stack, so it is never deeper than the levels there are, and each turn pushes one or
// removes one.
Status Mesh::simplify(VertexId v) {
  if (!restricted_ || !is_live_vertex(v) || level(v) == 0) return Status::not_ready;
  VertexId stack[MeshLimits::kDeepest + 1];
  int depth = 0;
  stack[depth++] = v;
  while (depth > 0) {
    const VertexId w = stack[depth - 1];
    VertexId newer = kNone;
    for (const HalfEdgeId h : star(w))
      if (corner_of(h) != 2) {
        newer = corner(face_of(h), 2);
        break;
      }
    if (newer != kNone) {
      stack[depth++] = newer;
    } else {
      weld_star(w);
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
