#pragma once
/// \file mesh.hpp
/// Half-edge triangle mesh over (u,v) in fixed memory, with the four stellar operators and the restricted binary
/// multitriangulation of the paper's section 4 (docs/algorithms.md, section 1). It stores the current mesh, no history.
/// Half-edge h = 3f + k runs from corner k of face f to corner k + 1. Half-edge 0 of a face is its *subdivision edge*;
/// corner 2, opposite, is its *weld vertex*, the newest of the three. Faces are counter-clockwise seen from outside.
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/geometry.hpp"
#include "pliant/id_set.hpp"
#include "pliant/mesh_types.hpp"
#include "pliant/status.hpp"

namespace pliant {
/// Half-edge triangle mesh over (u,v) in fixed memory.
class Mesh {
 public:
  Mesh() = default;
  Mesh(const Mesh&) = delete;
  Mesh& operator=(const Mesh&) = delete;

  /// Arena layout (create_in, measured_bytes). Limits above their maxima are lowered to them. The mesh is then empty.
  void lay_out(Arena& arena, const MeshLimits& limits);

  /// Takes a base mesh of basic blocks: where two faces meet, the edge is the subdivision edge (corner 0 to
  /// corner 1) of both or of neither. Base vertices and faces keep their indices as ids, and are never
  /// removed. Cost: O(faces x valence), no scratch.
  /// \param uv       one finite position a vertex.
  /// \param corners  three vertex indices a face; neighbours have the same winding.
  /// \return ok, or the first defect; the mesh is then empty. bad_argument (empty, not a multiple of three,
  ///   NaN), capacity, bad_index, degenerate_face, duplicate_face, non_manifold_edge, non_orientable (two
  ///   neighbours have opposite winding), isolated_vertex, non_manifold_vertex, not_basic_blocks.
  Status set_base(Span<const Vec2> uv, Span<const std::uint16_t> corners);
  /// As set_base, for any manifold triangles. The mesh is *free* until make_base succeeds: only the four
  /// stellar operators work on it, on any edge and face.
  Status set_triangles(Span<const Vec2> uv, Span<const std::uint16_t> corners);
  /// Makes the present triangles of a free mesh its base (all levels 0), or returns not_basic_blocks.
  Status make_base();
  /// The defects that show without topology: bad_argument, capacity, bad_index, degenerate_face.
  static Status check_triangles(Span<const Vec2> uv, Span<const std::uint16_t> corners,
                                const MeshLimits& limits);
  /// Copies everything from a mesh of the same limits. \return bad_argument for other limits, or none.
  Status copy_from(const Mesh& other);

  // --- Size, O(1) ---
  const MeshLimits& limits() const { return limits_; }                             ///< Limits of the layout.
  int vertex_count() const { return static_cast<int>(vertex_ids_.used_count()); }  ///< Live vertices.
  int face_count() const { return static_cast<int>(face_ids_.used_count()); }      ///< Live faces.
  int edge_count() const { return (3 * face_count() + boundary_edges_) / 2; }      ///< Edges.
  int base_vertex_count() const { return base_vertices_; }                         ///< Of the base.
  int base_face_count() const { return base_faces_; }                              ///< Of the base.
  /// False between set_triangles and make_base, and while the mesh is empty.
  bool is_restricted() const { return restricted_; }

  // --- Walks in ascending order of ids: for (VertexId v : mesh.vertices()) ---
  const IdSet& vertices() const { return vertex_ids_; }                     ///< Ids of the live vertices.
  const IdSet& faces() const { return face_ids_; }                          ///< Ids of the live faces.
  bool is_live_vertex(VertexId v) const { return vertex_ids_.is_used(v); }  ///< True for a live vertex.
  bool is_live_face(FaceId f) const { return face_ids_.is_used(f); }        ///< True for a live face.

  // --- Topology, O(1). Precondition: ids are live ---
  static FaceId face_of(HalfEdgeId h) { return static_cast<FaceId>((h * 0xAAABu) >> 17); }  ///< h / 3.
  static int corner_of(HalfEdgeId h) { return h - 3 * face_of(h); }                         ///< h modulo 3.
  static HalfEdgeId half_edge(FaceId f, int k) { return static_cast<HalfEdgeId>(3 * f + k); }  ///< 3 f + k.
  /// The next half-edge of the face.
  static HalfEdgeId next(HalfEdgeId h) { return static_cast<HalfEdgeId>(corner_of(h) == 2 ? h - 2 : h + 1); }
  /// The one before it.
  static HalfEdgeId previous(HalfEdgeId h) {
    return static_cast<HalfEdgeId>(corner_of(h) == 0 ? h + 2 : h - 1);
  }
  /// The other half of the edge; kNone on the boundary.
  HalfEdgeId twin(HalfEdgeId h) const { return twin_[h]; }
  VertexId origin(HalfEdgeId h) const { return corner_[h]; }             ///< Where the half-edge begins.
  VertexId destination(HalfEdgeId h) const { return origin(next(h)); }   ///< Where the half-edge ends.
  VertexId corner(FaceId f, int k) const { return corner_[3 * f + k]; }  ///< Corner k of face f.
  /// One half-edge that leaves v; at a boundary vertex the one without a twin.
  HalfEdgeId out(VertexId v) const { return vertices_[v].out; }
  bool is_boundary_edge(HalfEdgeId h) const { return twin(h) == kNone; }       ///< With one face.
  bool is_boundary_vertex(VertexId v) const { return twin(out(v)) == kNone; }  ///< On the boundary.
  /// The next half-edge that leaves the same vertex, counter-clockwise; kNone when the fan ends at the boundary.
  HalfEdgeId next_in_star(HalfEdgeId h) const { return twin(previous(h)); }
  /// The next boundary half-edge after the boundary half-edge h.
  HalfEdgeId next_on_boundary(HalfEdgeId h) const { return out(destination(h)); }
  /// True for one of the two halves of each edge: a walk over half-edges meets every edge once.
  bool represents_edge(HalfEdgeId h) const { return h < twin(h); }
  Vec2 uv(VertexId v) const { return vertices_[v].uv; }                 ///< Place in the chart.
  int level(VertexId v) const { return vertices_[v].level; }            ///< Bisections from the base mesh.
  int face_level(FaceId f) const { return level(corner_[3 * f + 2]); }  ///< Level of the weld vertex.
  Triangle triangle(FaceId f) const;  ///< Corners and neighbours of a live face.

  // --- Topology, O(valence) or more ---
  /// The number of edges at v.
  int find_valence(VertexId v) const;
  /// The half-edge from a to b, or kNone.
  HalfEdgeId find_half_edge(VertexId a, VertexId b) const;
  /// One boundary half-edge of each loop, the one with the lowest id; as many as fit. \return the number of loops.
  /// At worst O(boundary edges x length of a loop).
  int find_boundary_loops(Span<HalfEdgeId> loops) const;
  MeshStatistics compute_statistics() const;  ///< Counts. O(mesh).

  // --- Stellar operators (Figure 2). On a restricted mesh the edge operators keep every invariant, or return
  // not_ready; the face operators are for free meshes only. A weld undoes its split to the byte (on a free
  // mesh up to a face's rotation). Statuses: ok, not_ready, for splits capacity; only ok changes anything ---
  /// Whether f's subdivision edge can be split at once: it is its neighbour's too, or there is no neighbour.
  bool is_ready(FaceId f) const {
    const HalfEdgeId t = twin_[3 * f];
    return t == kNone || corner_of(t) == 0;
  }
  /// Whether v was inserted, and nothing was bisected around it since.
  bool is_weldable(VertexId v) const;
  /// Splits the edge of h at its midpoint in (u,v). Also not_ready at max_level.
  Status split_edge(HalfEdgeId h, VertexId& inserted);
  /// Removes a weldable vertex.
  Status weld_edge(VertexId v);
  /// Free mesh: inserts the barycentre of f; each old edge becomes the subdivision edge of a face.
  Status split_face(FaceId f, VertexId& inserted);
  /// Free mesh: removes a vertex that split_face inserted.
  Status weld_face(VertexId v);
  /// split_edge without its checks, for callers that made them. Precondition: it would succeed.
  VertexId split_ready_edge(HalfEdgeId h);
  /// weld_edge without its checks. Precondition: is_weldable(v).
  void weld_weldable(VertexId v);

  // --- Restricted refinement and simplification (section 4.2) ---
  /// Splits the subdivision edge of f, and first the neighbours that would differ by more than one level.
  /// At most level + 1 splits. All or nothing. Statuses: ok, not_ready (f is at max_level), capacity.
  Status refine(FaceId f);
  /// Removes v, and first the vertices that were inserted on its edges. Statuses: ok, not_ready (a base vertex).
  Status simplify(VertexId v);
  /// Back to the base mesh, to the byte.
  void simplify_all();
  /// The faces whose subdivision edges `refine` would split, the last one first.
  /// \param chain      room for max_level + 1.
  /// \param new_faces  faces that these splits add.
  /// \return how many; also the vertices that these splits add.
  int find_refinement_chain(FaceId f, FaceId* chain, int* new_faces) const;
  /// The triangles that welding v restores. \return 1 at the boundary, else 2. Precondition: is_weldable(v).
  int find_parents(VertexId v, Triangle parents[2]) const;
  /// The faces around v. Of each pair the first keeps its id when v is welded. \return 2 at the boundary, else 4.
  /// Precondition: is_weldable(v).
  int find_star_faces(VertexId v, FaceId faces[4]) const;

  /// Vertices inserted or removed since the last clear_changes (or base), each once, oldest first. One that is live now
  /// may have another (u,v) than before.
  Span<const VertexId> changes() const { return {changes_, change_count_}; }
  /// O(changes).
  void clear_changes();

  /// Checks all invariants (MeshFault). O(mesh), more with many boundary edges.
  MeshFault validate() const;
  /// 32-bit digest of everything but the changes: equal on every target for equal histories.
  std::uint32_t compute_digest() const;

 protected:  // for a test that breaks invariants
  /// The stored data of a vertex.
  struct Vertex {
    HalfEdgeId out;               ///< one that leaves it
    std::uint8_t level, changed;  ///< bisections; whether it is in the list of changes
    Vec2 uv;                      ///< place in the chart
  };
  MeshLimits limits_;
  VertexId* corner_ = nullptr;  // a half-edge: its origin
  HalfEdgeId* twin_ = nullptr;
  Vertex* vertices_ = nullptr;
  VertexId* changes_ = nullptr;
  IdSet face_ids_, vertex_ids_;
  std::size_t change_count_ = 0;
  int boundary_edges_ = 0, base_vertices_ = 0, base_faces_ = 0, base_euler_ = 0, base_loops_ = 0;
  bool restricted_ = false;

 private:
  using Wide = std::uint32_t;  // an id in a register

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
};
}  // namespace pliant
