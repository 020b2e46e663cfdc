// Worst-error-first adaptation with two queues, after the dual queues of ROAM, on the restricted multitriangulation of the
// paper's sections 4.2 and 5 (docs/algorithms.md, section 1.8). An operation ranks only the triangles that it changes: a
// split replaces two triangles by four, and the removal of its vertex has the rank of those two.
#include "pliant/adapt.hpp"

#include <cstring>

#include "mesh/mesh_tuning.hpp"
#include "pliant/mesh_star.hpp"

namespace pliant {
namespace {

// Floats of at least 0 have the order of their bit patterns. All other values count as 0.
std::uint32_t rank_bits(float rank) {
  if (!(rank > 0)) return 0;
  std::uint32_t bits;
  std::memcpy(&bits, &rank, sizeof bits);
  return bits;
}

float rank_of(std::uint32_t bits) {
  float rank;
  std::memcpy(&rank, &bits, sizeof rank);
  return rank;
}

constexpr std::uint32_t kToleranceBits = 0x3f800000;  // a rank of 1

float face_rank(std::uint64_t key) {
  return rank_of(static_cast<std::uint32_t>(key >> 32));
}
// The vertex queue gives the lowest rank first.
float vertex_rank(std::uint64_t key) {
  return rank_of(~static_cast<std::uint32_t>(key >> 32));
}

}  // namespace

void Adapter::lay_out(Arena& arena, const MeshLimits& limits) {
  limits_ = limits;
  position_ = arena.take<Vec3>(limits.vertices);
  faces_.lay_out(arena, limits.faces);
  vertices_.lay_out(arena, limits.vertices);
  mesh_ = nullptr;
}

Status Adapter::start(Mesh& mesh, const Surface& surface, const Criterion& criterion) {
  if (surface.sample == nullptr || criterion.refine_rank == nullptr || criterion.weld_rank == nullptr ||
      position_ == nullptr || mesh.limits().vertices != limits_.vertices ||
      mesh.limits().faces != limits_.faces || mesh.limits().max_level != limits_.max_level)
    return Status::bad_argument;
  if (!mesh.is_restricted()) return Status::not_ready;
  mesh_ = &mesh;
  surface_ = surface;
  criterion_ = criterion;
  Vec2 low = mesh.uv(0), high = low;
  for (const VertexId v : mesh.vertices()) {
    const Vec2 p = mesh.uv(v);
    low = min(low, p);
    high = max(high, p);
  }
  chart_origin_ = low;
  chart_scale_ = {high.x > low.x ? 65535.0f / (high.x - low.x) : 0,
                  high.y > low.y ? 65535.0f / (high.y - low.y) : 0};
  faces_.clear(std::uint64_t{kToleranceBits + 1} << 32);
  vertices_.clear();
  resample();
  rerank();
  return Status::ok;
}

void Adapter::resample() {
  if (mesh_ == nullptr) return;
  for (const VertexId v : mesh_->vertices()) position_[v] = surface_(mesh_->uv(v));
}

void Adapter::rerank(int part, int parts) {
  if (mesh_ == nullptr || parts < 1) return;
  for (const FaceId f : mesh_->faces())
    if (f % parts == part) rank_face(f);
  for (const VertexId v : mesh_->vertices())
    if (v % parts == part) rank_vertex(v);
}

// --- Keys ---

// (u,v) lies within the chart's extent, so both steps fit 16 bits; on a chart so large that they are NaN they are 0.
std::uint32_t Adapter::place_key(Vec2 uv) const {
  const auto steps = [](float x) { return x > 0 ? static_cast<std::uint32_t>(min(x, 65535)) : 0u; };
  return steps((uv.y - chart_origin_.y) * chart_scale_.y) << 16 |
         steps((uv.x - chart_origin_.x) * chart_scale_.x);
}

// Both faces of a block have the same place: the vertex that splitting them inserts. Either face first gives that split. A
// face within tolerance needs no place in the order.
std::uint64_t Adapter::face_key(const Shape& shape, FaceId f) const {
  const std::uint32_t bits = rank_bits(criterion_.refine_rank(criterion_.context, shape, f));
  if (bits <= kToleranceBits) return std::uint64_t{bits} << 32;
  const Vec2 middle = 0.5f * (mesh_->uv(mesh_->corner(f, 0)) + mesh_->uv(mesh_->corner(f, 1)));
  return std::uint64_t{bits} << 32 | place_key(middle);
}

std::uint32_t Adapter::face_bits(FaceId f) const {
  return static_cast<std::uint32_t>(faces_.key(f) >> 32);
}

// Refining either face of a block splits both: only the one that ranks higher takes part in the queue.
void Adapter::queue_face(FaceId f, std::uint64_t key) {
  const HalfEdgeId t = mesh_->twin(Mesh::half_edge(f, 0));
  const FaceId mate = Mesh::face_of(t);
  if (t == kNone || Mesh::corner_of(t) != 0 || !faces_.contains(mate)) {
    faces_.set(f, key);
  } else if (faces_.key(mate) >= key) {
    faces_.hold(f, key);
    faces_.set(mate, faces_.key(mate));
  } else {
    faces_.set(f, key);
    faces_.hold(mate, faces_.key(mate));
  }
}

void Adapter::rank_face(FaceId f) {
  queue_face(f, mesh_->face_level(f) < limits_.max_level ? face_key(shape(), f) : 0);
}

// A vertex that is no longer weldable may stay in the queue until it comes to the top; its key is then ignored.
void Adapter::rank_vertex(VertexId v) {
  if (!mesh_->is_weldable(v)) return;
  set_cost(v, rank_bits(criterion_.weld_rank(criterion_.context, shape(), v)));
}

// Where the faces around v rank higher than the triangles that a weld restores, the samples of the latter have missed some
// error. The cost of v is then at least that rank; otherwise v would be welded to make room for those faces, and inserted
// again.
void Adapter::set_cost(VertexId v, std::uint32_t bits) {
  FaceId faces[4];
  for (int i = mesh_->find_star_faces(v, faces); i > 0; --i) {
    const std::uint32_t around = face_bits(faces[i - 1]);
    bits = around > bits ? around : bits;
  }
  vertices_.set(v, std::uint64_t{~bits} << 32 | place_key(mesh_->uv(v)));
}

// After a change of the star of v: ranks the faces that share an edge with it.
void Adapter::rank_around(VertexId v) {
  for (const HalfEdgeId h : star(*mesh_, v)) {
    const HalfEdgeId outer = mesh_->twin(Mesh::next(h));
    if (outer == kNone) continue;
    rank_face(Mesh::face_of(outer));
    rank_vertex(mesh_->corner(Mesh::face_of(outer), 2));
  }
}

// The weldable vertex that costs least, or kNone.
VertexId Adapter::cheapest_vertex() {
  VertexId v = vertices_.top();
  for (; v != kNone && !mesh_->is_weldable(v); v = vertices_.top()) vertices_.remove(v);
  return v;
}

// --- Operations ---

// f is ready and there is room.
void Adapter::split(FaceId f) {
  const HalfEdgeId t = mesh_->twin(Mesh::half_edge(f, 0));
  std::uint32_t bits = face_bits(f);
  if (t != kNone && face_bits(Mesh::face_of(t)) > bits) bits = face_bits(Mesh::face_of(t));
  const VertexId v = mesh_->split_ready_edge(Mesh::half_edge(f, 0));
  position_[v] = surface_(mesh_->uv(v));
  const Shape now = shape();
  const bool is_deepest = mesh_->level(v) >= limits_.max_level;
  FaceId faces[4];
  const int count = mesh_->find_star_faces(v, faces);
  for (int i = 0; i < count; ++i) {
    const std::uint64_t key = is_deepest ? 0 : face_key(now, faces[i]);
    queue_face(faces[i], key);
    const auto around = static_cast<std::uint32_t>(key >> 32);
    bits = around > bits ? around : bits;
  }
  if (criterion_.ranks_triangles)
    vertices_.set(v, std::uint64_t{~bits} << 32 | place_key(mesh_->uv(v)));
  else
    rank_vertex(v);
  if (criterion_.sees_neighbours) rank_around(v);
}

// v is weldable.
void Adapter::weld(VertexId v) {
  FaceId faces[4];
  const int count = mesh_->find_star_faces(v, faces);
  HalfEdgeId outer[4];
  for (int i = 0; i < count; ++i) outer[i] = mesh_->twin(Mesh::half_edge(faces[i], 0));
  mesh_->weld_weldable(v);
  for (int i = 1; i < count; i += 2) faces_.remove(faces[i]);
  for (int i = 0; i < count; ++i) {  // a face without its block partner is queued alone
    const FaceId f = Mesh::face_of(outer[i]);
    if (outer[i] != kNone && Mesh::corner_of(outer[i]) == 0) faces_.set(f, faces_.key(f));
  }
  for (int i = 0; i < count; i += 2) {
    rank_face(faces[i]);
    rank_vertex(mesh_->corner(faces[i], 2));
    if (criterion_.sees_neighbours) rank_around(mesh_->corner(faces[i], 2));
  }
}

bool Adapter::fits(FaceId f, int vertex_room, Chain& chain) const {
  int new_faces = 0;
  chain.count = mesh_->find_refinement_chain(f, chain.face, &new_faces);
  return chain.count <= vertex_room && mesh_->face_count() + new_faces <= limits_.faces;
}

// The worst face that fits.
FaceId Adapter::find_fitting(int vertex_room, float lowest_rank) const {
  FaceId best = kNone;
  Chain chain;
  if (vertex_room < 1) return best;
  for (const FaceId f : mesh_->faces())
    if (face_rank(faces_.key(f)) > lowest_rank && (best == kNone || faces_.key(f) > faces_.key(best)) &&
        fits(f, vertex_room, chain))
      best = f;
  return best;
}

// Makes one refinement or one weld. False when there is nothing to do; report.stop says why.
bool Adapter::step(const AdaptOptions& options, int budget, int operations_left, AdaptReport& report) {
  const int room = budget - mesh_->vertex_count();
  FaceId worst = faces_.top();
  const bool wants_split = options.may_split && worst != kNone;
  const float worst_rank = wants_split ? face_rank(faces_.key(worst)) : 1;
  Chain chain;
  bool do_split = wants_split && room > 0 && fits(worst, room, chain);

  VertexId cheapest = kNone;
  if (!do_split && options.may_weld) cheapest = cheapest_vertex();
  if (cheapest != kNone && room >= 0) {
    const float cost = vertex_rank(vertices_.key(cheapest)) * kAdaptTuning.hysteresis;
    if (cost >= worst_rank) cheapest = kNone;
  }
  if (cheapest != kNone) {
    weld(cheapest);
    ++report.welds;
    return true;
  }

  report.stop = room < 0 || (wants_split && !do_split) ? AdaptStop::no_room : AdaptStop::converged;
  if (wants_split && !do_split) {  // a face of a lower rank would be the next to be welded
    worst = find_fitting(room, max(1, worst_rank / kAdaptTuning.hysteresis));
    do_split = worst != kNone && fits(worst, room, chain);
  }
  if (!do_split) return false;
  // Each split of a chain is valid without those after it: the next call goes on.
  for (; chain.count > 0 && operations_left > 0; --operations_left, ++report.splits)
    split(chain.face[--chain.count]);
  return true;
}

AdaptReport Adapter::adapt(const AdaptOptions& options) {
  AdaptReport report;
  if (mesh_ == nullptr) return report;
  const int capacity = limits_.vertices;
  const int budget =
      options.vertex_budget > 0 && options.vertex_budget < capacity ? options.vertex_budget : capacity;
  const int limit =
      options.max_operations > 0 ? options.max_operations : kAdaptTuning.operations_per_vertex * capacity;
  // A criterion that depends on neighbours may change its ranks after their refinement.
  for (int pass = 0; pass <= limits_.max_level; ++pass) {
    const int before = report.splits + report.welds;
    bool stopped = false;
    while (!stopped) {
      const int left = limit - report.splits - report.welds;
      if (left <= 0) {
        report.stop = AdaptStop::operations;
        stopped = true;
      } else {
        stopped = !step(options, budget, left, report);
      }
    }
    if (!criterion_.sees_neighbours || report.splits + report.welds == before ||
        report.stop == AdaptStop::operations)
      break;
    rerank();
  }
  report.worst_rank = face_rank(faces_.find_highest_key());
  return report;
}

}  // namespace pliant
