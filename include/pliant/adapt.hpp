#pragma once
/// \file adapt.hpp
/// Adaptive refinement and simplification of a mesh on a surface (the paper, section 5): the application
/// tells where the surface is and how badly a triangle approximates it; the mesh follows, worst error first,
/// within a budget.
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/geometry.hpp"
#include "pliant/mesh.hpp"
#include "pliant/rank_queue.hpp"
#include "pliant/status.hpp"

namespace pliant {

/// The application's surface: a position for every (u,v) of the chart. Must give the same answer for the same
/// (u,v) until the application says otherwise by `resample`.
struct Surface {
  void* context = nullptr;
  Vec3 (*sample)(void* context, Vec2 uv) = nullptr;

  Vec3 operator()(Vec2 uv) const { return sample(context, uv); }
};

/// What a criterion sees: the mesh, the surface, and the surface at the mesh's vertices.
struct Shape {
  const Mesh& mesh;
  Surface surface;
  const Vec3* position;  ///< by vertex id
};

/// Where a mesh needs more or fewer triangles, as ranks: error over tolerance. A face is worth refining when
/// its rank is above 1. A vertex is worth removing when the ranks with and without it are below 1 by a
/// margin. Ranks are at least 0; NaN counts as 0. criteria.hpp has the usual ones, and makes one from a pair
/// of yes-or-no tests.
struct Criterion {
  const void* context = nullptr;
  float (*refine_rank)(const void* context, const Shape& shape, FaceId face) = nullptr;
  /// Rank of the worst triangle that welding v brings back. Only called for weldable vertices.
  float (*weld_rank)(const void* context, const Shape& shape, VertexId v) = nullptr;
  /// True where weld_rank is the highest refine_rank that the triangles brought back would have: saves
  /// ranking.
  bool ranks_triangles = false;
  /// True where a face's rank also depends on its neighbours, which are then ranked again when it changes.
  bool sees_neighbours = false;
};

struct AdaptOptions {
  int vertex_budget = 0;   ///< hard limit on vertices; 0: the mesh's capacity
  int max_operations = 0;  ///< splits and welds in this call; 0: as many as it takes (16 x capacity at most)
  float hysteresis = 1.25f;  ///< > 1: how much a split must be worth more than the weld that makes room for
                             ///< it, and how far below tolerance a weld must stay
  bool may_split = true;
  bool may_weld = true;
};

enum class AdaptStop : std::uint8_t {
  converged,   ///< every face is within tolerance, and nothing can go by the hysteresis
  no_room,     ///< budget or capacity is used up, and no exchange is worth it
  operations,  ///< max_operations
};

struct AdaptReport {
  int splits = 0, welds = 0;
  AdaptStop stop = AdaptStop::converged;
  float worst_rank = 0;  ///< of the faces there are now
};

/// Keeps one mesh adapted to one surface, call after call. All changes to the mesh go through it between
/// `start`s.
///
/// Two queues live in fixed memory: faces by rank, highest first, and weldable vertices by what their removal
/// would cost, lowest first. Ties are broken by place in the chart, so that the result depends neither on the
/// order of the base mesh nor on addresses. Bytes: 12 a face, 24 a vertex.
class Adapter {
 public:
  Adapter() = default;
  Adapter(const Adapter&) = delete;
  Adapter& operator=(const Adapter&) = delete;

  /// \param limits  those of the mesh.
  void lay_out(Arena& arena, const MeshLimits& limits);

  /// Takes the mesh as it is, samples its vertices and ranks its faces. Mesh, surface and criterion must
  /// stay. Statuses: ok, bad_argument (null functions, other limits), not_ready (no base mesh).
  Status start(Mesh& mesh, const Surface& surface, const Criterion& criterion);

  /// Splits and welds until nothing is left to do within the options. Nothing happens before `start`.
  ///
  /// Worst first: the face with the highest rank above 1 is refined while its chain of splits fits the
  /// budget. Where it does not fit, the cheapest vertex is welded if the face is worse by the hysteresis;
  /// else the worst face that does fit is refined, if it is worse than that. Once all are within tolerance,
  /// vertices are welded whose removal keeps them there by the hysteresis. Above the budget, the cheapest
  /// vertices go whatever they cost. Cost: O(log n) and the ranking of about 6 triangles an operation.
  AdaptReport adapt(const AdaptOptions& options);

  /// Samples all vertices again, after the surface has changed. Cost: a sample a vertex.
  void resample();
  /// Ranks faces and vertices again, one id out of `parts`, beginning at `part`: a share of the work a frame.
  /// Vertices look at the faces around them, so that shares come to the same as all at once after two rounds.
  void rerank(int part = 0, int parts = 1);

  /// Of a live vertex.
  Vec3 position(VertexId v) const { return position_[v]; }
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
  Vec2 chart_origin_, chart_scale_;  // (u,v) to 16-bit steps over the chart, for tie-breaks
};

}  // namespace pliant
