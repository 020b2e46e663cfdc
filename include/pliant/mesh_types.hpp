#pragma once
/// \file mesh_types.hpp
/// Ids, limits, and what is reported of a mesh (mesh.hpp).
#include <cstdint>

#include "pliant/id_set.hpp"

namespace pliant {

/// Index of a vertex.
using VertexId = std::uint16_t;
/// Index of a face.
using FaceId = std::uint16_t;
/// Index of a half-edge, 3 f + k.
using HalfEdgeId = std::uint16_t;

/// Capacities of a mesh. Bytes: 14 a vertex, 12 a face and a bit for each; 19 a triangle where there are twice as many
/// faces as vertices.
struct MeshLimits {
  std::uint16_t vertices = 1024;                         ///< at most kMostVertices
  std::uint16_t faces = 2048;                            ///< at most kMostFaces
  std::uint8_t max_level = 12;                           ///< bisections on top of the base mesh; at most kDeepest
  static constexpr std::uint16_t kMostVertices = 65534;  ///< ids have 16 bits
  static constexpr std::uint16_t kMostFaces = 21845;     ///< ids of their half-edges have 16 bits
  static constexpr std::uint8_t kDeepest = 24;           ///< highest level
};

/// A triangle and its neighbours: a live face, or one that a weld would restore. Edge i runs from corner i to
/// corner i + 1 (modulo 3).
struct Triangle {
  VertexId corner[3];  ///< vertices
  /// The neighbour's corner that is not on edge i; kNone where edge i is on the boundary.
  VertexId across[3];
  int level = 0;  ///< of its weld vertex
};

/// Counts of a mesh.
struct MeshStatistics {
  int vertices = 0, edges = 0, faces = 0, boundary_edges = 0;  ///< live ones
  int boundary_loops = 0;                                      ///< closed walks along the boundary
  int euler = 0;                                               ///< V - E + F
  int deepest = 0;                                             ///< highest level of a vertex
  int faces_at_level[MeshLimits::kDeepest + 1] = {};           ///< faces of each level
  int largest_valence = 0;                                     ///< most faces at a vertex
  int folded_faces = 0;                                        ///< faces with negative area in (u,v)
};

/// The first invariant that Mesh::validate finds broken:
///   1  corners of a live face are live and distinct
///   2  twin(twin(h)) = h, never h itself, and both faces are live
///   3  twins run in opposite directions between the same vertices
///   4  out(v) leaves v from a live face, without a twin if v is on the boundary
///   5  the walk around a vertex meets every corner of every face there
///   6  V - E + F and the number of boundary loops are those of the base mesh (restricted meshes only)
///   7  the number of boundary edges is the one counted
///   8  dead faces and vertices hold nothing
///   9  no face has zero area in (u,v); splits keep this while edges are longer than a few steps of a float: a base
///      triangle of 2e-6 of the chart loses it before level 12
/// and, of a restricted mesh:
///  10  base vertices have level 0, inserted ones 1 to max_level; corner 2 has the highest level of a face
///  11  neighbours differ by one level at most. Where their levels are equal, the shared edge is the
///      subdivision edge of both or of neither; otherwise it is that of the finer one only
///  12  an inserted vertex is in at most 8 faces
///  13  a weldable vertex lies at the midpoint of the edge that its removal restores
struct MeshFault {
  int invariant = 0;  ///< 0: none is broken
  int id = 0;         ///< the half-edge, face or vertex that breaks it
};

}  // namespace pliant
