#pragma once
/// \file mesh.hpp
/// Half-edge triangle mesh over (u,v) in fixed memory, with the four stellar operators and the restricted
/// binary multitriangulation of the paper's section 4. The current mesh is all there is: no tree and no
/// history.
///
/// Half-edge h = 3f + k runs from corner k of face f to corner k + 1. Half-edge 0 of a face is its
/// *subdivision edge*, corner 2 opposite is its *weld vertex*, the newest of the three. Faces are
/// counter-clockwise seen from outside.
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/geometry.hpp"
#include "pliant/id_set.hpp"
#include "pliant/status.hpp"

namespace pliant {

using VertexId = std::uint16_t;
using FaceId = std::uint16_t;
using HalfEdgeId = std::uint16_t;

/// Capacities of a mesh. 14 bytes a vertex, 12 a face, and a bit for each: about 19 bytes a triangle when
/// there are twice as many faces as vertices.
struct MeshLimits {
  std::uint16_t vertices = 1024;  ///< at most 65,534
  std::uint16_t faces = 2048;     ///< at most 21,845
  std::uint8_t max_level = 12;    ///< bisections on top of the base mesh; at most kDeepest
  static constexpr std::uint8_t kDeepest = 24;
};

/// A triangle and what lies across its edges: a live face, or one that a weld would bring back. Edge i runs
/// from corner i to corner i + 1 (modulo 3).
struct Triangle {
  VertexId corner[3];
  VertexId
      across[3];  ///< the neighbour's corner that is not on edge i; kNone where edge i is on the boundary
  int level = 0;
};

struct MeshStatistics {
  int vertices = 0, edges = 0, faces = 0, boundary_edges = 0;
  int boundary_loops = 0;
  int euler = 0;    ///< V - E + F
  int deepest = 0;  ///< highest level of a vertex
  int faces_at_level[MeshLimits::kDeepest + 1] = {};
  int largest_valence = 0;
  int folded_faces = 0;  ///< negative area in (u,v)
};

/// A broken invariant; see Mesh::validate.
struct MeshFault {
  int invariant = 0;  ///< 0: none
  int id = 0;         ///< the half-edge, face or vertex it was seen at
};

class Mesh {
 public:
  Mesh() = default;
  Mesh(const Mesh&) = delete;
  Mesh& operator=(const Mesh&) = delete;

  /// Limits beyond the stated maxima are lowered to them. The mesh is empty afterwards.
  void lay_out(Arena& arena, const MeshLimits& limits);

  /// Takes a base mesh of basic blocks: where two faces meet, the edge is the subdivision edge (corner 0 to
  /// corner 1) of both or of neither. Base vertices keep their indices as ids, base faces theirs, and both
  /// live for ever. \param uv       one finite position a vertex. \param corners  three vertex indices a
  /// face; neighbours wind alike. \return ok, or the first defect: bad_argument (empty, not a multiple of
  /// three, NaN), capacity, bad_index,
  ///   degenerate_face, isolated_vertex, duplicate_face, non_manifold_edge, non_orientable (two neighbours
  ///   wind in opposite senses), non_manifold_vertex, not_basic_blocks. The mesh is then empty.
  /// Cost: O(faces x valence), no scratch.
  Status set_base(Span<const Vec2> uv, Span<const std::uint16_t> corners);
  /// As set_base, but any manifold triangles: the mesh is *free* until make_base succeeds, and only the four
  /// stellar operators work on it, on any edge and face.
  Status set_triangles(Span<const Vec2> uv, Span<const std::uint16_t> corners);
  /// Makes the present triangles of a free mesh its base (all levels 0), or gives not_basic_blocks.
  Status make_base();
  /// The defects that can be seen without topology, the first four of set_base's list.
  static Status check_triangles(Span<const Vec2> uv, Span<const std::uint16_t> corners,
                                const MeshLimits& limits);
  /// Takes over everything from a mesh of the same limits; bad_argument otherwise.
  Status copy_from(const Mesh& other);

  // --- Size ---
  const MeshLimits& limits() const { return limits_; }
  int vertex_count() const { return static_cast<int>(vertex_ids_.used_count()); }
  int face_count() const { return static_cast<int>(face_ids_.used_count()); }
  int boundary_edge_count() const { return boundary_edges_; }
  int edge_count() const { return (3 * face_count() + boundary_edges_) / 2; }
  int base_vertex_count() const { return base_vertices_; }
  int base_face_count() const { return base_faces_; }
  /// False between set_triangles and make_base, and while the mesh is empty.
  bool is_restricted() const { return restricted_; }

  // --- Walks, in rising order of ids: for (VertexId v : mesh.vertices()) ---
  const IdSet& vertices() const { return vertex_ids_; }
  const IdSet& faces() const { return face_ids_; }
  bool is_live_vertex(VertexId v) const { return vertex_ids_.is_used(v); }
  bool is_live_face(FaceId f) const { return face_ids_.is_used(f); }

  // --- Topology, O(1) ---
  static FaceId face_of(HalfEdgeId h) { return static_cast<FaceId>((h * 0xAAABu) >> 17); }
  static int corner_of(HalfEdgeId h) { return h - 3 * face_of(h); }
  static HalfEdgeId half_edge(FaceId f, int k) { return static_cast<HalfEdgeId>(3 * f + k); }
  static HalfEdgeId next(HalfEdgeId h) { return static_cast<HalfEdgeId>(corner_of(h) == 2 ? h - 2 : h + 1); }
  static HalfEdgeId previous(HalfEdgeId h) {
    return static_cast<HalfEdgeId>(corner_of(h) == 0 ? h + 2 : h - 1);
  }
  /// The other half of the edge; kNone on the boundary.
  HalfEdgeId twin(HalfEdgeId h) const { return twin_[h]; }
  VertexId origin(HalfEdgeId h) const { return corner_[h]; }
  VertexId destination(HalfEdgeId h) const { return origin(next(h)); }
  VertexId corner(FaceId f, int k) const { return corner_[3 * f + k]; }
  /// One half-edge that leaves v; at a boundary vertex the one without a twin.
  HalfEdgeId out(VertexId v) const { return vertices_[v].out; }
  bool is_boundary_edge(HalfEdgeId h) const { return twin(h) == kNone; }
  bool is_boundary_vertex(VertexId v) const { return twin(out(v)) == kNone; }
  /// The next half-edge leaving the same vertex, counter-clockwise; kNone when the fan ends at the boundary.
  HalfEdgeId next_in_star(HalfEdgeId h) const { return twin(previous(h)); }
  /// The next boundary half-edge of the loop that the boundary half-edge h is in.
  HalfEdgeId next_on_boundary(HalfEdgeId h) const { return out(destination(h)); }
  /// True for one of the two halves of each edge, so that a walk over half-edges meets every edge once.
  bool represents_edge(HalfEdgeId h) const { return h < twin(h); }
  Vec2 uv(VertexId v) const { return vertices_[v].uv; }
  int level(VertexId v) const { return vertices_[v].level; }
  int face_level(FaceId f) const { return level(corner_[3 * f + 2]); }
  Triangle triangle(FaceId f) const;

  /// The half-edges that leave a vertex, counter-clockwise: for (HalfEdgeId h : mesh.star(v)).
  class Star {
   public:
    class Iterator {
     public:
      Iterator(const Mesh& mesh, HalfEdgeId first) : mesh_(&mesh), first_(first), at_(first) {}
      HalfEdgeId operator*() const { return at_; }
      Iterator& operator++() {
        at_ = mesh_->next_in_star(at_);
        if (at_ == first_) at_ = kNone;
        return *this;
      }
      bool operator!=(const Iterator& other) const { return at_ != other.at_; }

     private:
      const Mesh* mesh_;
      HalfEdgeId first_, at_;
    };
    Star(const Mesh& mesh, VertexId v) : mesh_(mesh), first_(mesh.out(v)) {}
    Iterator begin() const { return {mesh_, first_}; }
    Iterator end() const { return {mesh_, kNone}; }

   private:
    const Mesh& mesh_;
    HalfEdgeId first_;
  };
  Star star(VertexId v) const { return {*this, v}; }

  // --- Topology, O(valence) or more ---
  /// Edges at v.
  int find_valence(VertexId v) const;
  /// The half-edge from a to b, or kNone.
  HalfEdgeId find_half_edge(VertexId a, VertexId b) const;
  /// One boundary half-edge of each loop, the one with the lowest id. Returns how many there are; writes as
  /// many as fit. O(boundary edges x length of a loop) at worst.
  int find_boundary_loops(Span<HalfEdgeId> loops) const;
  MeshStatistics compute_statistics() const;

  // --- Stellar operators (Figure 2) ---
  // On a restricted mesh the edge operators keep every invariant and refuse anything else with not_ready; the
  // face operators are for free meshes only. Weld undoes split to the byte (on a free mesh up to the rotation
  // of a face).
  /// True where f's subdivision edge can be split at once: its neighbour's is the same edge, or there is
  /// none.
  bool is_ready(FaceId f) const {
    const HalfEdgeId t = twin_[3 * f];
    return t == kNone || corner_of(t) == 0;
  }
  /// True where v was inserted and nothing was bisected around it since.
  bool is_weldable(VertexId v) const;
  /// Splits the edge of h at its midpoint in (u,v). Statuses: ok, not_ready (also at max_level), capacity.
  Status split_edge(HalfEdgeId h, VertexId& inserted);
  /// Removes a weldable vertex. Statuses: ok, not_ready.
  Status weld_edge(VertexId v);
  /// Free mesh: inserts the barycentre of f; each old edge becomes the subdivision edge of a face.
  Status split_face(FaceId f, VertexId& inserted);
  /// Free mesh: removes a vertex that split_face inserted. Statuses: ok, not_ready.
  Status weld_face(VertexId v);

  // --- Restricted refinement and simplification (section 4.2) ---
  /// Splits the subdivision edge of f and, first, whatever must be split so that neighbours stay within one
  /// level: at most level + 1 splits. All or nothing. Statuses: ok, not_ready (f is at max_level), capacity.
  Status refine(FaceId f);
  /// Removes v and, first, whatever was inserted on top of it. Statuses: ok, not_ready (a base vertex).
  Status simplify(VertexId v);
  /// Back to the base mesh, to the byte.
  void simplify_all();
  /// The faces whose subdivision edges `refine` would split, last one first.
  /// \param chain  room for max_level + 1.
  /// \return how many; splits they need `*new_faces` faces besides as many vertices.
  int find_refinement_chain(FaceId f, FaceId* chain, int* new_faces) const;
  /// The triangles that welding v brings back, one at the boundary and two elsewhere. Precondition:
  /// is_weldable(v).
  int find_parents(VertexId v, Triangle parents[2]) const;
  /// The faces around v, two at the boundary and four elsewhere. Of each pair the first is what keeps its id
  /// when v is welded. Precondition: is_weldable(v).
  int find_star_faces(VertexId v, FaceId faces[4]) const {
    const HalfEdgeId h = vertices_[v].out;
    faces[1] = face_of(h);
    faces[0] = face_of(twin_[3 * faces[1] + 1]);
    const HalfEdgeId t = twin_[h];
    if (t == kNone) return 2;
    faces[2] = face_of(t);
    faces[3] = face_of(twin_[3 * faces[2] + 2]);
    return 4;
  }

  // --- Changes ---
  /// Vertices inserted, removed, or both since the last clear_changes (or base), each once, oldest first.
  /// Whether one is there now is_live_vertex tells; if so, its (u,v) may be another than before.
  Span<const VertexId> changes() const { return {changes_, change_count_}; }
  /// O(changes).
  void clear_changes();

  // --- Checks ---
  /// Checks all invariants; O(mesh), more with many boundary edges.
  ///  1 corners of a live face are live and distinct
  ///  2 twin(twin(h)) = h, never h itself, and both faces are live
  ///  3 twins run in opposite directions between the same vertices
  ///  4 out(v) leaves v from a live face, without a twin if v is on the boundary
  ///  5 every corner of every face is met by walking the star of its vertex
  ///  6 V - E + F and the number of boundary loops are those of the base mesh (restricted only)
  ///  7 the boundary edges are as many as counted
  ///  8 dead faces and vertices hold nothing
  ///  9 no face has zero area in (u,v)
  /// and, of a restricted mesh,
  /// 10 base vertices have level 0, inserted ones 1 to max_level; corner 2 has the highest level of a face
  /// 11 neighbours differ by one level at most; the edge they share is the subdivision edge of both, or of
  /// neither,
  ///    where the levels are equal, and of the finer one only where they are not
  /// 12 an inserted vertex is in at most 8 faces
  /// 13 a weldable vertex lies at the midpoint of the edge that its removal restores
  MeshFault validate() const;
  /// 32-bit digest of everything but the changes: equal on every target for equal histories.
  std::uint32_t compute_digest() const;

 private:
  using Wide = std::uint32_t;  // an id in a register
  struct Vertex {
    HalfEdgeId out;
    std::uint8_t level;
    std::uint8_t changed;
    Vec2 uv;
  };

  void clear();
  void set_face(Wide f, Wide a, Wide b, Wide c);
  void link(Wide a, Wide b);
  void attach(Wide h, Wide outer);
  void move_out(Wide v, Wide from, Wide to);
  Status find_twins();
  Status find_twin(HalfEdgeId h);
  bool take_from_bucket(HalfEdgeId h);
  Status find_fans();
  bool is_basic_blocks() const;
  MeshFault check_half_edges() const;
  MeshFault check_stars() const;
  MeshFault check_dead() const;
  MeshFault check_geometry() const;
  MeshFault check_levels() const;
  MeshFault check_inserted() const;

  VertexId insert_vertex(Vec2 uv, int level);
  void remove_vertex(VertexId v);
  void remove_face(Wide f);
  void note_change(VertexId v);
  int newest_level(Wide f) const;
  Wide bisect(Wide h, Wide m);
  void join(Wide f, Wide g);
  VertexId split(Wide h);
  void weld_star(VertexId v);

  friend class Adapter;       // operates where it has checked already
  friend struct MeshSurgeon;  // a test breaks invariants with it

  MeshLimits limits_;
  VertexId* corner_ = nullptr;  // by half-edge: its origin
  HalfEdgeId* twin_ = nullptr;
  Vertex* vertices_ = nullptr;
  VertexId* changes_ = nullptr;
  IdSet face_ids_, vertex_ids_;
  std::size_t change_count_ = 0;
  int boundary_edges_ = 0, base_vertices_ = 0, base_faces_ = 0, base_euler_ = 0, base_loops_ = 0;
  bool restricted_ = false;
};

}  // namespace pliant
