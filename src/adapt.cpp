// Worst-error-first adaptation with two queues, after the dual queues of ROAM, on the restricted
// multitriangulation of the paper's sections 4.2 and 5. Nothing is recomputed but what an operation touched:
// a split takes two triangles away and brings four; the rank that its vertex's removal would have is the rank
// those two had.
#include "pliant/adapt.hpp"

#include <cstring>

namespace pliant {
namespace {

// Floats of at least 0 order as their bits do. Anything else counts as 0.
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
      mesh.limits().faces != limits_.faces)
    return Status::bad_argument;
  if (!mesh.is_restricted()) return Status::not_ready;
  mesh_ = &mesh;
  surface_ = surface;
  criterion_ = criterion;
  Vec2 low = mesh.uv(0), high = low;
  for (const VertexId v : mesh.vertices()) {
    const Vec2 p = mesh.uv(v);
    low = {min(low.x, p.x), min(low.y, p.y)};
    high = {max(high.x, p.x), max(high.y, p.y)};
  }
  chart_origin_ = low;
  chart_scale_ = {high.x > low.x ? 65535.0f / (high.x - low.x) : 0,
                  high.y > low.y ? 65535.0f / (high.y - low.y) : 0};
  faces_.clear();
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

std::uint32_t Adapter::place_key(Vec2 uv) const {
  const float x = (uv.x - chart_origin_.x) * chart_scale_.x, y = (uv.y - chart_origin_.y) * chart_scale_.y;
  return static_cast<std::uint32_t>(clamp(y, 0, 65535)) << 16 |
         static_cast<std::uint32_t>(clamp(x, 0, 65535));
}

// Both faces of a block have the same place, the vertex that splitting them would insert, which is also what
// is done first whichever of them comes first.
std::uint64_t Adapter::face_key(FaceId f) const {
  float rank = 0;
  if (mesh_->face_level(f) < limits_.max_level) rank = criterion_.refine_rank(criterion_.context, shape(), f);
  const Vec2 middle = 0.5f * (mesh_->uv(mesh_->corner(f, 0)) + mesh_->uv(mesh_->corner(f, 1)));
  return std::uint64_t{rank_bits(rank)} << 32 | place_key(middle);
}

// Where the faces around v rank higher than what would come back, the samples of the latter have missed
// something: v is worth at least as much as they are, or it would be welded to make room for them, and split
// again.
std::uint64_t Adapter::weld_key(VertexId v, std::uint32_t bits) const {
  for (const HalfEdgeId h : mesh_->star(v)) {
    const auto around = static_cast<std::uint32_t>(faces_.key(Mesh::face_of(h)) >> 32);
    if (around > bits) bits = around;
  }
  return std::uint64_t{~bits} << 32 | place_key(mesh_->uv(v));
}

void Adapter::rank_face(FaceId f) {
  faces_.set(f, face_key(f));
}

void Adapter::rank_vertex(VertexId v) {
  if (mesh_->is_weldable(v))
    vertices_.set(v, weld_key(v, rank_bits(criterion_.weld_rank(criterion_.context, shape(), v))));
  else
    vertices_.remove(v);
}

// After a change of the star of v: whatever looks across an edge into it.
void Adapter::rank_around(VertexId v) {
  for (const HalfEdgeId h : mesh_->star(v)) {
    const HalfEdgeId outer = mesh_->twin(Mesh::next(h));
    if (outer == kNone) continue;
    rank_face(Mesh::face_of(outer));
    const VertexId apex = mesh_->corner(Mesh::face_of(outer), 2);
    if (vertices_.contains(apex)) rank_vertex(apex);
  }
}

// --- Operations ---

// f is ready and there is room.
void Adapter::split(FaceId f) {
  const HalfEdgeId t = mesh_->twin(Mesh::half_edge(f, 0));
  const VertexId apex = mesh_->corner(f, 2), other = t == kNone ? kNone : mesh_->corner(Mesh::face_of(t), 2);
  std::uint32_t bits = static_cast<std::uint32_t>(faces_.key(f) >> 32);
  if (t != kNone) {
    const auto mate = static_cast<std::uint32_t>(faces_.key(Mesh::face_of(t)) >> 32);
    if (mate > bits) bits = mate;
  }
  VertexId v = kNone;
  if (mesh_->split_edge(Mesh::half_edge(f, 0), v) != Status::ok) return;
  position_[v] = surface_(mesh_->uv(v));
  for (const HalfEdgeId h : mesh_->star(v)) rank_face(Mesh::face_of(h));
  if (criterion_.ranks_triangles)
    vertices_.set(v, weld_key(v, bits));
  else
    rank_vertex(v);
  vertices_.remove(apex);
  if (other != kNone) vertices_.remove(other);
  if (criterion_.sees_neighbours) rank_around(v);
}

void Adapter::weld(VertexId v) {
  FaceId faces[4];
  int count = 0;
  for (const HalfEdgeId h : mesh_->star(v)) faces[count++] = Mesh::face_of(h);
  vertices_.remove(v);
  if (mesh_->weld_edge(v) != Status::ok) return;
  for (int i = 0; i < count; ++i)
    if (!mesh_->is_live_face(faces[i])) faces_.remove(faces[i]);
  for (int i = 0; i < count; ++i) {
    if (!mesh_->is_live_face(faces[i])) continue;
    rank_face(faces[i]);
    rank_vertex(mesh_->corner(faces[i], 2));
    if (criterion_.sees_neighbours) rank_around(mesh_->corner(faces[i], 2));
  }
}

void Adapter::refine(FaceId f, AdaptReport& report) {
  FaceId chain[MeshLimits::kDeepest + 1];
  int new_faces = 0;
  const int count = mesh_->find_refinement_chain(f, chain, &new_faces);
  for (int i = count - 1; i >= 0; --i) split(chain[i]);
  report.splits += count;
}

bool Adapter::fits(FaceId f, int vertex_room, int* splits) const {
  FaceId chain[MeshLimits::kDeepest + 1];
  int new_faces = 0;
  *splits = mesh_->find_refinement_chain(f, chain, &new_faces);
  return *splits <= vertex_room && mesh_->face_count() + new_faces <= limits_.faces;
}

// The worst face that fits; only looked for when the worst of all does not fit.
FaceId Adapter::find_fitting(int vertex_room, float lowest_rank) const {
  FaceId best = kNone;
  if (vertex_room < 1) return best;
  for (const FaceId f : mesh_->faces()) {
    int splits = 0;
    if (face_rank(faces_.key(f)) > lowest_rank && (best == kNone || faces_.key(f) > faces_.key(best)) &&
        fits(f, vertex_room, &splits))
      best = f;
  }
  return best;
}

// One refinement or one weld; false when there is nothing to do, and why is in the report.
bool Adapter::step(const AdaptOptions& options, int budget, int operations_left, AdaptReport& report) {
  const bool can_weld = options.may_weld && vertices_.count() > 0;
  const float cheapest = can_weld ? vertex_rank(vertices_.top_key()) : 0;
  FaceId worst = faces_.top();
  const float worst_rank = face_rank(faces_.top_key());
  const int room = budget - mesh_->vertex_count();
  report.stop = room < 0 ? AdaptStop::no_room : AdaptStop::converged;

  bool do_weld = can_weld && room < 0;
  bool do_split = false;
  if (!do_weld && options.may_split && worst_rank > 1) {
    int splits = 0;
    do_split = fits(worst, room, &splits);
    do_weld = !do_split && can_weld && worst_rank > options.hysteresis * cheapest;
    if (!do_split && !do_weld) {
      // Nothing lower than this may be put in: it would be the next to go.
      report.stop = AdaptStop::no_room;
      worst = find_fitting(room, max(1, worst_rank / options.hysteresis));
      do_split = worst != kNone && fits(worst, room, &splits);
    }
    if (do_split && splits > operations_left) {
      report.stop = AdaptStop::operations;
      return false;
    }
  } else if (!do_weld) {
    do_weld = can_weld && cheapest * options.hysteresis < 1;
  }
  if (do_weld) {
    weld(vertices_.top());
    ++report.welds;
  } else if (do_split) {
    refine(worst, report);
  }
  return do_weld || do_split;
}

AdaptReport Adapter::adapt(const AdaptOptions& options) {
  AdaptReport report;
  if (mesh_ == nullptr) return report;
  const int capacity = limits_.vertices;
  const int budget =
      options.vertex_budget > 0 && options.vertex_budget < capacity ? options.vertex_budget : capacity;
  const int limit = options.max_operations > 0 ? options.max_operations : 16 * capacity;
  // A criterion that sees neighbours may find more to do once all of them are as they will be.
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
  report.worst_rank = face_rank(faces_.top_key());
  return report;
}

}  // namespace pliant
