#pragma once
/// \file base_mesh.hpp
/// Makes a base mesh of basic blocks from any triangles (the paper, 4.2 and 5.1; docs/algorithms.md, section
/// 1.3): checks them, gives them one winding, and gives every face a subdivision edge that it shares with its
/// neighbour.
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/geometry.hpp"
#include "pliant/mesh.hpp"
#include "pliant/status.hpp"

namespace pliant {

/// Winding of the faces of the result. Each connected part is turned as a whole, by the sign of its area in (u,v).
enum class Winding : std::uint8_t {
  as_given,           ///< that of the part's first face
  counter_clockwise,  ///< positive area with u to the right and v up
  clockwise,  ///< negative area: charts whose v points down seen from outside, as those of model tables
};

/// Sizes of the input, and whether by_splits may be called, which needs room for up to three times the faces.
struct BaseMeshLimits {
  std::uint16_t vertices = 512;  ///< of the input
  std::uint16_t faces = 1024;    ///< at most 7,281 with splits, 21,845 without
  bool splits = true;            ///< whether by_splits will be called
};

/// Makes base meshes. For host tools, or for the start of a device: its memory can be reused once a mesh has taken the
/// result. Bytes: about 150 a face with splits, 85 without, and 22 a vertex.
class BaseMeshMaker {
 public:
  BaseMeshMaker() = default;
  BaseMeshMaker(const BaseMeshMaker&) = delete;
  BaseMeshMaker& operator=(const BaseMeshMaker&) = delete;

  /// Takes its memory from the arena; called by create_in and measured_bytes (arena.hpp).
  void lay_out(Arena& arena, const BaseMeshLimits& limits);

  /// The paper's method. Edges are split once at their midpoints, the longest first, as long as neither of
  /// their faces has been split; faces that remain are split at the barycentre. M interior and B boundary
  /// splits and U remaining faces give V + M + B + U vertices and 2 F + U faces. The input's vertices keep
  /// their indices. Gives good shapes.
  /// \param uv, corners  any winding; one connected part or several, with boundary or without.
  /// \param position     lengths are taken between these, one a vertex; empty: in (u,v).
  /// \return ok, or the first defect in this order: bad_argument, capacity, bad_index, degenerate_face,
  ///   duplicate_face or non_manifold_edge, non_orientable, isolated_vertex, non_manifold_vertex; at last
  ///   degenerate_face where a triangle is so narrow that a part of it has no area in float.
  Status by_splits(Span<const Vec2> uv, Span<const std::uint16_t> corners, Winding winding,
                   Span<const Vec3> position = {});
  /// Without splits: neighbours are paired across long edges. A face with a boundary edge may stay single, as
  /// half a block. Succeeds for every mesh that passes the checks (Petersen's theorem on two copies joined
  /// along the boundary). Vertices and faces keep their indices. Cost: O(F log F), and the search for
  /// augmenting paths (Edmonds): O(F^3) at worst, near O(F) on surfaces. Parameters and statuses: those of
  /// by_splits.
  Status by_pairing(Span<const Vec2> uv, Span<const std::uint16_t> corners, Winding winding,
                    Span<const Vec3> position = {});

  /// The result of the last success, for Mesh::set_base; empty after a failure. Valid until the next call.
  Span<const Vec2> uv() const { return {uv_, vertex_count_}; }
  /// Three vertex indices a face.
  Span<const std::uint16_t> corners() const { return {corners_, 3 * face_count_}; }
  /// The vertices between which each added vertex lies: two ends of an edge and kNone, or three corners of a face.
  struct Parents {
    std::uint16_t v[3];  ///< corners; kNone where unused
  };
  /// One entry a vertex beyond the input's.
  Span<const Parents> parents() const { return {parents_, vertex_count_ - input_vertices_}; }

 private:
  struct Edge {
    float length2;
    HalfEdgeId h;
  };
  struct Side {
    std::uint32_t edge;  // lower end above, higher end below
    HalfEdgeId h;
  };

  Status prepare(Span<const Vec2> uv, Span<const std::uint16_t> corners, Winding winding,
                 Span<const Vec3> position);
  Status find_neighbours();
  Status orient_part(FaceId first, Span<const Vec2> uv, Winding winding);
  Status orient(Span<const Vec2> uv, Winding winding);
  std::size_t sort_edges(Span<const Vec3> position);
  void split_edges(std::size_t edge_count);
  void pair_faces(std::size_t edge_count);
  HalfEdgeId longest_boundary_edge(FaceId f, Span<const Vec3> position) const;
  float squared_length(HalfEdgeId h, Span<const Vec3> position) const;
  void emit_mesh();

  BaseMeshLimits limits_;
  Mesh mesh_;
  Edge* edges_ = nullptr;
  Side* sides_ = nullptr;
  HalfEdgeId* neighbour_ = nullptr;
  std::uint16_t *queue_ = nullptr, *mate_ = nullptr;
  std::uint16_t* search_ = nullptr;  // three more arrays of one entry a face, for the augmenting paths
  std::uint8_t *flag_ = nullptr, *flip_ = nullptr;
  Vec2* uv_ = nullptr;
  std::uint16_t* corners_ = nullptr;
  Parents* parents_ = nullptr;
  std::size_t vertex_count_ = 0, face_count_ = 0, input_vertices_ = 0;
};

}  // namespace pliant
