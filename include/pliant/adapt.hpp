#pragma once
/// \file adapt.hpp
/// Adaptive refinement and simplification of a mesh on a surface (the paper, section 5; docs/algorithms.md,
/// section 1.8). The application gives the surface and the error of a triangle. The mesh is refined where the
/// error is worst, within a budget.
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/geometry.hpp"
#include "pliant/mesh.hpp"
#include "pliant/rank_queue.hpp"
#include "pliant/status.hpp"

namespace pliant {

/// The application's surface: a position (mm) for every (u,v) of the chart. Between two calls of Adapter::resample the
/// position at one (u,v) must not change.
struct Surface {
  void* context = nullptr;                           ///< passed to the functions
  Vec3 (*sample)(void* context, Vec2 uv) = nullptr;  ///< position at (u,v), mm

  Vec3 operator()(Vec2 uv) const { return sample(context, uv); }  ///< Position at (u,v), mm.
};

/// The mesh and the surface that a criterion reads.
struct Shape {
  const Mesh& mesh;      ///< the mesh that is adapted
  Surface surface;       ///< the surface that it approximates
  const Vec3* position;  ///< the surface at the vertices, mm; by vertex id
};

/// Where a mesh needs more or fewer triangles, as ranks: error over tolerance. A face is refined when its
/// rank is above 1. A vertex is removed when the ranks with and without it are below 1 by a margin. Ranks are
/// at least 0; NaN counts as 0. criteria.hpp has the usual ones, and makes one from a pair of yes-or-no
/// tests.
struct Criterion {
  const void* context = nullptr;  ///< passed to the functions
  /// Rank of a live face.
  float (*refine_rank)(const void* context, const Shape& shape, FaceId face) = nullptr;
  /// Rank of the worst triangle that welding v restores. Only called for weldable vertices.
  float (*weld_rank)(const void* context, const Shape& shape, VertexId v) = nullptr;
  /// Whether weld_rank is the highest refine_rank of the triangles that the weld restores. Saves ranking.
  bool ranks_triangles = false;
  /// Whether a face's rank depends on its neighbours too. A change then ranks the neighbours again.
  bool sees_neighbours = false;
};

/// Bounds of one call of Adapter::adapt.
struct AdaptOptions {
  int vertex_budget = 0;   ///< hard limit on vertices; 0: the mesh's capacity
  int max_operations = 0;  ///< splits and welds in this call; 0: until it converges, at most 16 x capacity
  bool may_split = true;   ///< false: no splits
  bool may_weld = true;    ///< false: no welds
};

/// Why an adaptation ended.
enum class AdaptStop : std::uint8_t {
  /// No face that may be split is out of tolerance, and no vertex that may be welded is superfluous.
  converged,
  no_room,     ///< budget or capacity is used up, and no weld is worth a split
  operations,  ///< max_operations
};

/// Result of one call of Adapter::adapt.
struct AdaptReport {
  int splits = 0, welds = 0;              ///< operations done
  AdaptStop stop = AdaptStop::converged;  ///< why it ended
  float worst_rank = 0;                   ///< of the faces there are now; those at max_level count as 0
};

/// Keeps one mesh adapted to one surface. After `start`, only the adapter may change the mesh.
///
/// Two queues are in fixed memory: faces by rank, highest first, and weldable vertices by the cost of their
/// removal, lowest first. Ties are broken by place in the chart: the result depends neither on the order of
/// the base mesh nor on addresses.
/// Bytes: 12 a face, 24 a vertex.
class Adapter {
 public:
  Adapter() = default;
  Adapter(const Adapter&) = delete;
  Adapter& operator=(const Adapter&) = delete;

  /// Arena layout (create_in, measured_bytes).
  /// \param limits  those of the mesh, as Mesh::limits gives them.
  void lay_out(Arena& arena, const MeshLimits& limits);

  /// Samples the vertices of a mesh and ranks its faces. Mesh, surface and criterion must outlive the adaptation.
  /// \return ok, bad_argument (null functions, other limits), not_ready (no base mesh).
  Status start(Mesh& mesh, const Surface& surface, const Criterion& criterion);

  /// Splits and welds until nothing is left to do within the options. Does nothing before `start`.
  ///
  /// The face with the highest rank above 1 is refined if its chain of splits fits the budget. If not, the
  /// cheapest vertex is welded when the face's rank exceeds its cost by the hysteresis, a factor of 1.25; else
  /// the worst face that fits is refined, when its rank is within that factor of the highest. When all faces
  /// are within tolerance, vertices whose removal keeps them there by the hysteresis are welded. Above the
  /// budget, the cheapest vertices are welded whatever their cost (docs/algorithms.md, section 1.8).
  /// Cost: O(log n) and the ranking of about 6 triangles an operation. A criterion that sees neighbours takes twice as many, and
  /// all triangles of the mesh are ranked again after each of at most max_level + 1 passes.
  AdaptReport adapt(const AdaptOptions& options);

  /// Samples all vertices again, after the surface has changed. Cost: a sample a vertex.
  void resample();
  /// Ranks again the faces and vertices with id % parts == part, so that the work can be spread over frames.
  /// A vertex's rank depends on the faces around it: after two rounds of all parts the ranks are those of one
  /// call for all.
  void rerank(int part = 0, int parts = 1);

  /// Position of a live vertex, mm.
  Vec3 position(VertexId v) const { return position_[v]; }
  /// The mesh, the surface and the vertices' positions.
  Shape shape() const { return {*mesh_, surface_, position_}; }

 private:
  /// Splits that refining a face takes, the last one first.
  struct Chain {
    FaceId face[MeshLimits::kDeepest + 1];
    int count = 0;
  };

  std::uint32_t place_key(Vec2 uv) const;
  std::uint64_t face_key(const Shape& shape, FaceId f) const;
  std::uint32_t face_bits(FaceId f) const;
  void queue_face(FaceId f, std::uint64_t key);
  void rank_face(FaceId f);
  void rank_vertex(VertexId v);
  void set_cost(VertexId v, std::uint32_t bits);
  void rank_around(VertexId v);
  VertexId cheapest_vertex();
  void split(FaceId f);
  void weld(VertexId v);
  bool fits(FaceId f, int vertex_room, Chain& chain) const;
  FaceId find_fitting(int vertex_room, float lowest_rank) const;
  bool step(const AdaptOptions& options, int budget, int operations_left, AdaptReport& report);

  Mesh* mesh_ = nullptr;
  Surface surface_;
  Criterion criterion_;
  MeshLimits limits_;
  Vec3* position_ = nullptr;
  RankQueue faces_, vertices_;
  Vec2 chart_origin_, chart_scale_;  // from (u,v) to 16-bit steps over the chart, for tie-breaks
};

}  // namespace pliant
