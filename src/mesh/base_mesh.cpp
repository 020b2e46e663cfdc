// Checks, orientation, and two methods to make basic blocks: the paper's (5.1), and pairing (docs/algorithms.md, section
// 1.3).
//
// When a face is split, at an edge or at its middle, each child takes one of the face's whole edges as its subdivision edge.
// Two neighbours that share a whole edge then both have it as subdivision edge: they form a basic block.
#include "pliant/base_mesh.hpp"

#include "base/arrays.hpp"
#include "base/heap_sort.hpp"
#include "base/integers.hpp"
#include "mesh/perfect_matching.hpp"

namespace pliant {
namespace {

constexpr int kMostFaces = MeshLimits::kMostFaces;

MeshLimits output_limits(const BaseMeshLimits& l) {
  MeshLimits m;
  const int vertices = l.splits ? l.vertices + l.faces : l.vertices;
  const int faces = l.splits ? 3 * l.faces : l.faces;
  m.vertices = static_cast<std::uint16_t>(smaller(vertices, MeshLimits::kMostVertices));
  m.faces = static_cast<std::uint16_t>(smaller(faces, kMostFaces));
  m.max_level = 1;
  return m;
}

}  // namespace

void BaseMeshMaker::lay_out(Arena& arena, const BaseMeshLimits& limits) {
  limits_ = limits;
  limits_.faces =
      static_cast<std::uint16_t>(smaller(limits.faces, limits.splits ? kMostFaces / 3 : kMostFaces));
  const MeshLimits out = output_limits(limits_);
  const std::size_t faces = limits_.faces;
  mesh_.lay_out(arena, out);
  uv_ = arena.take<Vec2>(out.vertices);
  corners_ = arena.take<std::uint16_t>(3 * std::size_t{out.faces});
  parents_ = arena.take<Parents>(limits_.splits ? faces : 0);
  edges_ = arena.take<Edge>(3 * faces);
  sides_ = arena.take<Side>(3 * faces);
  neighbour_ = arena.take<HalfEdgeId>(3 * faces);
  queue_ = arena.take<std::uint16_t>(faces);
  mate_ = arena.take<std::uint16_t>(faces);
  search_ = arena.take<std::uint16_t>(3 * faces);
  flag_ = arena.take<std::uint8_t>(faces);
  flip_ = arena.take<std::uint8_t>(faces);
}

// --- Checks and orientation ---

// Finds for each side of each face the side across the edge, of either direction.
Status BaseMeshMaker::find_neighbours() {
  const std::size_t count = 3 * face_count_;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t a = corners_[i], b = corners_[i % 3 == 2 ? i - 2 : i + 1];
    sides_[i] = {a < b ? a << 16 | b : b << 16 | a, static_cast<HalfEdgeId>(i)};
    neighbour_[i] = kNone;
  }
  heap_sort(sides_, count,
            [](const Side& x, const Side& y) { return x.edge != y.edge ? x.edge < y.edge : x.h < y.h; });
  const auto apex = [this](const Side& s) { return corners_[Mesh::previous(s.h)]; };
  for (std::size_t i = 0; i < count;) {
    std::size_t end = i + 1;
    while (end < count && sides_[end].edge == sides_[i].edge) ++end;
    for (std::size_t j = i; j < end; ++j)
      for (std::size_t k = j + 1; k < end; ++k)
        if (apex(sides_[j]) == apex(sides_[k])) return Status::duplicate_face;
    if (end - i > 2) return Status::non_manifold_edge;
    if (end - i == 2) {
      neighbour_[sides_[i].h] = sides_[i + 1].h;
      neighbour_[sides_[i + 1].h] = sides_[i].h;
    }
    i = end;
  }
  return Status::ok;
}

// Gives the connected part of a face its winding, then inverts the whole part if the caller asks for it.
Status BaseMeshMaker::orient_part(FaceId first, Span<const Vec2> uv, Winding winding) {
  std::size_t head = 0, tail = 0;
  float area = 0;
  queue_[tail++] = first;
  flag_[first] = 1;
  while (head < tail) {
    const FaceId f = queue_[head++];
    const std::uint16_t* c = corners_ + 3 * std::size_t{f};
    const float own = doubled_area(uv[c[0]], uv[c[1]], uv[c[2]]);
    area += flip_[f] != 0 ? -own : own;
    for (int k = 0; k < 3; ++k) {
      const HalfEdgeId h = Mesh::half_edge(f, k), t = neighbour_[h];
      if (t == kNone) continue;
      const FaceId g = Mesh::face_of(t);
      const std::uint8_t wanted =
          corners_[h] == corners_[t] ? 1 - flip_[f] : flip_[f];  // alike as given: one turns
      if (flag_[g] == 0) {
        flag_[g] = 1;
        flip_[g] = wanted;
        queue_[tail++] = g;
      } else if (flip_[g] != wanted) {
        return Status::non_orientable;
      }
    }
  }
  const bool turn =
      (winding == Winding::counter_clockwise && area < 0) || (winding == Winding::clockwise && area > 0);
  for (std::size_t i = 0; turn && i < tail; ++i) flip_[queue_[i]] ^= 1;
  return Status::ok;
}

Status BaseMeshMaker::orient(Span<const Vec2> uv, Winding winding) {
  for (std::size_t f = 0; f < face_count_; ++f) flag_[f] = flip_[f] = 0;
  for (std::size_t first = 0; first < face_count_; ++first) {
    if (flag_[first] != 0) continue;
    const Status status = orient_part(static_cast<FaceId>(first), uv, winding);
    if (status != Status::ok) return status;
  }
  for (std::size_t f = 0; f < face_count_; ++f) {
    if (flip_[f] == 0) continue;
    const std::uint16_t second = corners_[3 * f + 1];
    corners_[3 * f + 1] = corners_[3 * f + 2];
    corners_[3 * f + 2] = second;
  }
  return Status::ok;
}

Status BaseMeshMaker::prepare(Span<const Vec2> uv, Span<const std::uint16_t> corners, Winding winding,
                              Span<const Vec3> position) {
  vertex_count_ = face_count_ = input_vertices_ = 0;
  const bool has_positions = position.data != nullptr && position.count == uv.count;
  if (corners_ == nullptr || !(position.empty() || has_positions)) return Status::bad_argument;
  MeshLimits input;
  input.vertices = limits_.vertices;
  input.faces = limits_.faces;
  Status status = Mesh::check_triangles(uv, corners, input);
  if (status != Status::ok) return status;
  face_count_ = corners.count / 3;
  copy(corners.data, corners.count, corners_);
  status = find_neighbours();
  if (status == Status::ok) status = orient(uv, winding);
  if (status == Status::ok) status = mesh_.set_triangles(uv, {corners_, corners.count});
  if (status == Status::ok)
    input_vertices_ = uv.count;
  else
    face_count_ = 0;
  return status;
}

// --- Edges, the longest first ---

float BaseMeshMaker::squared_length(HalfEdgeId h, Span<const Vec3> position) const {
  const VertexId a = mesh_.origin(h), b = mesh_.destination(h);
  if (position.empty()) {
    const Vec2 d = mesh_.uv(b) - mesh_.uv(a);
    return dot(d, d);
  }
  const Vec3 d = position[b] - position[a];
  return dot(d, d);
}

// Equal lengths are ordered by the place of their midpoints: splits do not depend on the order of the input.
std::size_t BaseMeshMaker::sort_edges(Span<const Vec3> position) {
  std::size_t count = 0;
  for (const FaceId f : mesh_.faces())
    for (int k = 0; k < 3; ++k) {
      const HalfEdgeId h = Mesh::half_edge(f, k);
      if (mesh_.represents_edge(h)) edges_[count++] = {squared_length(h, position), h};
    }
  const Mesh& mesh = mesh_;
  heap_sort(edges_, count, [&mesh](const Edge& x, const Edge& y) {
    if (x.length2 < y.length2 || x.length2 > y.length2) return x.length2 > y.length2;
    const Vec2 a = mesh.uv(mesh.origin(x.h)) + mesh.uv(mesh.destination(x.h));
    const Vec2 b = mesh.uv(mesh.origin(y.h)) + mesh.uv(mesh.destination(y.h));
    if (a.x < b.x || a.x > b.x) return a.x < b.x;
    if (a.y < b.y || a.y > b.y) return a.y < b.y;
    return x.h < y.h;
  });
  return count;
}

// --- Splits, the paper's method ---

void BaseMeshMaker::split_edges(std::size_t edge_count) {
  const std::size_t whole_faces = face_count_;
  for (std::size_t f = 0; f < whole_faces; ++f) flag_[f] = 0;
  const auto is_whole = [this, whole_faces](FaceId f) { return f < whole_faces && flag_[f] == 0; };
  VertexId v = kNone;
  std::size_t added = 0;
  for (std::size_t i = 0; i < edge_count; ++i) {
    const HalfEdgeId h = edges_[i].h;  // still valid if its face is not split
    const FaceId f = Mesh::face_of(h);
    if (!is_whole(f)) continue;
    const HalfEdgeId t = mesh_.twin(h);
    if (t != kNone && !is_whole(Mesh::face_of(t))) continue;
    parents_[added++] = {{mesh_.origin(h), mesh_.destination(h), kNone}};
    flag_[f] = 1;
    if (t != kNone) flag_[Mesh::face_of(t)] = 1;
    (void)mesh_.split_edge(h, v);  // there is room: the limits are those of the worst case
  }
  for (std::size_t i = 0; i < whole_faces; ++i) {
    const auto f = static_cast<FaceId>(i);
    if (!is_whole(f)) continue;
    parents_[added++] = {{mesh_.corner(f, 0), mesh_.corner(f, 1), mesh_.corner(f, 2)}};
    (void)mesh_.split_face(f, v);
  }
}

void BaseMeshMaker::emit_mesh() {
  vertex_count_ = static_cast<std::size_t>(mesh_.vertex_count());
  face_count_ = static_cast<std::size_t>(mesh_.face_count());
  for (std::size_t v = 0; v < vertex_count_; ++v) uv_[v] = mesh_.uv(static_cast<VertexId>(v));
  for (std::size_t i = 0; i < 3 * face_count_; ++i) corners_[i] = mesh_.origin(static_cast<HalfEdgeId>(i));
}

Status BaseMeshMaker::by_splits(Span<const Vec2> uv, Span<const std::uint16_t> corners, Winding winding,
                                Span<const Vec3> position) {
  // Without room for splits it is given no triangles, which is a bad argument, too.
  Status status = prepare(uv, limits_.splits ? corners : Span<const std::uint16_t>{}, winding, position);
  if (status != Status::ok) return status;
  split_edges(sort_edges(position));
  emit_mesh();
  // Halves of a triangle a few steps of a float wide may have no area.
  status = Mesh::check_triangles(this->uv(), this->corners(), mesh_.limits());
  if (status == Status::ok) status = mesh_.make_base();
  if (status != Status::ok) vertex_count_ = face_count_ = input_vertices_ = 0;
  return status;
}

// --- Pairing ---

HalfEdgeId BaseMeshMaker::longest_boundary_edge(FaceId f, Span<const Vec3> position) const {
  HalfEdgeId best = kNone;
  for (int k = 0; k < 3; ++k) {
    const HalfEdgeId h = Mesh::half_edge(f, k);
    if (mesh_.twin(h) == kNone &&
        (best == kNone || squared_length(h, position) > squared_length(best, position)))
      best = h;
  }
  return best;
}

// Pairs greedily across long edges, then completes the matching by exchanges.
void BaseMeshMaker::pair_faces(std::size_t edge_count) {
  for (std::size_t f = 0; f < face_count_; ++f) {
    mate_[f] = kNone;
    flag_[f] = 0;  // set: decided
  }
  for (std::size_t i = 0; i < edge_count; ++i) {
    const FaceId f = Mesh::face_of(edges_[i].h);
    const HalfEdgeId t = mesh_.twin(edges_[i].h);
    const FaceId g = t == kNone ? f : Mesh::face_of(t);
    if (flag_[f] != 0 || flag_[g] != 0) continue;
    flag_[f] = flag_[g] = 1;
    if (g == f) continue;  // alone, on its boundary edge
    mate_[f] = g;
    mate_[g] = f;
  }
}

Status BaseMeshMaker::by_pairing(Span<const Vec2> uv, Span<const std::uint16_t> corners, Winding winding,
                                 Span<const Vec3> position) {
  const Status status = prepare(uv, corners, winding, position);
  if (status != Status::ok) return status;
  pair_faces(sort_edges(position));
  const std::size_t n = limits_.faces;
  FaceMatching matching(mesh_, face_count_, {mate_, search_, search_ + n, queue_, search_ + 2 * n, flag_});
  if (!matching.complete()) {  // cannot be, by Petersen's theorem
    face_count_ = 0;
    return Status::not_basic_blocks;
  }
  vertex_count_ = uv.count;
  copy(uv.data, vertex_count_, uv_);
  for (std::size_t i = 0; i < face_count_; ++i) {
    const auto f = static_cast<FaceId>(i);
    HalfEdgeId h = mate_[i] == kNone ? longest_boundary_edge(f, position) : kNone;
    for (int k = 0; k < 3; ++k) {
      const HalfEdgeId t = mesh_.twin(Mesh::half_edge(f, k));
      if (mate_[i] != kNone && t != kNone && Mesh::face_of(t) == mate_[i]) h = Mesh::half_edge(f, k);
    }
    for (int k = 0; k < 3; ++k, h = Mesh::next(h))
      corners_[3 * i + static_cast<std::size_t>(k)] = mesh_.origin(h);
  }
  return mesh_.set_base(this->uv(), this->corners());
}

}  // namespace pliant
