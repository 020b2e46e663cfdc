// Time and memory of the adaptive mesh: bare stellar operators, restricted refinement and simplification with
// queues, refinement by the contour criterion, one budgeted pass. The base is a grid of basic blocks, squares cut by
// alternating diagonals, on a gently curved patch.
#include <cstdlib>

#include "host/bench/bench.hpp"
#include "host/bench/random.hpp"
#include "host/bench/rows.hpp"
#include "host/io/owned.hpp"
#include "host/render/model_mesh.hpp"
#include "pliant/adapt.hpp"
#include "pliant/criteria.hpp"

namespace pliant::host {

namespace {

double now_ns() {
  return 1e6 * wall_ms();
}

struct Times {
  std::vector<double> ns;
  double median() const { return host::median(ns); }
};

std::string span(int from, int to) {
  return std::to_string(from) + "_to_" + std::to_string(to);
}

constexpr MeshLimits kLarge{12000, MeshLimits::kMostFaces, 20};

struct Bench {
  explicit Bench(const MeshLimits& l)
      : mesh_memory(l), adapter_memory(l), mesh(*mesh_memory), adapter(*adapter_memory) {}
  Owned<Mesh> mesh_memory;
  Owned<Adapter> adapter_memory;
  Mesh& mesh;
  Adapter& adapter;
};

/// Squares cut by alternating diagonals, each a basic block.
struct Grid {
  std::vector<Vec2> uv;
  std::vector<std::uint16_t> corners;

  explicit Grid(int n) {
    const auto cell = 1.0f / static_cast<float>(n);
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) uv.push_back({cell * static_cast<float>(i), cell * static_cast<float>(j)});
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const auto at = [&](int x, int y) { return static_cast<std::uint16_t>((j + y) * (n + 1) + i + x); };
        const bool falls = (i + j) % 2 == 0;
        const std::uint16_t a = falls ? at(0, 0) : at(1, 0), b = falls ? at(1, 1) : at(0, 1);
        const std::uint16_t c = falls ? at(0, 1) : at(0, 0), d = falls ? at(1, 0) : at(1, 1);
        for (const std::uint16_t corner : {a, b, c, b, a, d}) corners.push_back(corner);
      }
  }
  Span<const Vec2> uv_span() const { return {uv.data(), uv.size()}; }
  Span<const std::uint16_t> corner_span() const { return {corners.data(), corners.size()}; }
};

Vec3 patch(void*, Vec2 uv) {
  const float x = 3 * uv.x - 1.5f, y = 2 * uv.y - 1;
  return {100 * uv.x, 100 * uv.y, 25 * x * (1 - 0.3f * x * x) * (1 - 0.4f * y * y)};
}

// A face-like relief: broad shape, ridges, and two pits.
Vec3 relief(void*, Vec2 uv) {
  const float x = uv.x - 0.5f, y = uv.y - 0.5f;
  float z = 60 * (1 - 2 * x * x - y * y);
  const float bump[5][4] = {{0, 0, 25, 90},
                            {-0.2f, 0.15f, -10, 250},
                            {0.2f, 0.15f, -10, 250},
                            {0, -0.25f, 8, 400},
                            {0, -0.12f, 6, 900}};
  for (const auto& b : bump) {
    const float dx = x - b[0], dy = y - b[1];
    z += b[2] / (1 + b[3] * (dx * dx + dy * dy));
  }
  return {160 * uv.x, 200 * uv.y, z};
}

// Splits random edges: any edge of a free mesh, or subdivision edges of a restricted mesh. The restricted mesh is then welded
// back, newest vertex first. A trial run chooses the edges, so that only the operators are timed.
void bare_operators(const BenchRows& rows, int n, int target, bool restricted) {
  const Grid base(n);
  Bench b(kLarge);
  const auto begin = [&] {
    if (b.mesh.set_triangles(base.uv_span(), base.corner_span()) != Status::ok) std::abort();
    if (restricted && b.mesh.make_base() != Status::ok) std::abort();
  };
  begin();
  const std::uint32_t digest = b.mesh.compute_digest();
  BenchRandom random{5};
  std::vector<HalfEdgeId> edges;
  std::vector<VertexId> made;
  VertexId v;
  while (b.mesh.face_count() < target) {
    const std::size_t face = random.below(static_cast<std::size_t>(b.mesh.face_count()));
    const auto h = static_cast<HalfEdgeId>(3 * face + (restricted ? 0 : random.below(3)));
    if (b.mesh.split_edge(h, v) != Status::ok) continue;
    edges.push_back(h);
    made.push_back(v);
  }
  const int after = b.mesh.face_count();
  Times split, weld;
  for (int repeat = 0; repeat < 21; ++repeat) {
    begin();
    const double t0 = now_ns();
    for (const HalfEdgeId h : edges)
      if (b.mesh.split_edge(h, v) != Status::ok) std::abort();
    const double t1 = now_ns();
    for (std::size_t i = made.size(); restricted && i-- > 0;)
      if (b.mesh.weld_edge(made[i]) != Status::ok) std::abort();
    const double t2 = now_ns();
    if (restricted && b.mesh.compute_digest() != digest) std::abort();
    split.ns.push_back((t1 - t0) / static_cast<double>(made.size()));
    weld.ns.push_back((t2 - t1) / static_cast<double>(made.size()));
  }
  const std::string name = span(2 * n * n, after) + (restricted ? "_ready" : "_random");
  rows("split_" + name, "ns_per_split", split.median());
  if (restricted) rows("weld_back_" + name, "ns_per_weld", weld.median());
}

// Uniform refinement by a level test through the queues, and simplification back.
void restricted_adaptation(const BenchRows& rows, int n, int levels) {
  const Grid base(n);
  Unconditional depth;
  Times refine, simplify;
  int faces = 0, splits = 0;
  Bench b(kLarge);
  for (int repeat = 0; repeat < 21; ++repeat) {
    depth.levels = levels;
    if (b.mesh.set_base(base.uv_span(), base.corner_span()) != Status::ok) std::abort();
    if (b.adapter.start(b.mesh, {nullptr, &patch}, criterion_of(depth)) != Status::ok) std::abort();
    const double t0 = now_ns();
    const AdaptReport up = b.adapter.adapt({});
    const double t1 = now_ns();
    faces = b.mesh.face_count();
    splits = up.splits;
    depth.levels = 0;
    b.adapter.rerank();
    const double t2 = now_ns();
    const AdaptReport down = b.adapter.adapt({});
    const double t3 = now_ns();
    if (down.welds != splits || b.mesh.face_count() != 2 * n * n) std::abort();
    refine.ns.push_back(t1 - t0);
    simplify.ns.push_back(t3 - t2);
  }
  const std::string v = span(2 * n * n, faces);
  rows("restricted_refine_" + v, "ns_per_split", refine.median() / splits);
  rows("restricted_refine_" + v, "ms_whole", 1e-6 * refine.median());
  rows("restricted_simplify_" + v, "ns_per_weld", simplify.median() / splits);
}

/// Refines a base mesh to `vertices` vertices by the contour criterion.
void contour(const BenchRows& rows, const std::string& name, Span<const Vec2> uv,
             Span<const std::uint16_t> corners, const Surface& surface, const ContourOptions& fine,
             int vertices) {
  Times whole;
  Bench b(kLarge);
  for (int repeat = 0; repeat < 15; ++repeat) {
    require(b.mesh.set_base(uv, corners), name);
    const double t0 = now_ns();
    require(b.adapter.start(b.mesh, surface, criterion_of(fine)), name);
    AdaptOptions options;
    options.vertex_budget = vertices;
    options.may_weld = false;
    (void)b.adapter.adapt(options);
    whole.ns.push_back(now_ns() - t0);
  }
  const std::string v = name + "_" + std::to_string(b.mesh.base_vertex_count()) + "_to_" +
                        std::to_string(b.mesh.vertex_count()) + "_vertices";
  rows(v, "ms_whole", 1e-6 * whole.median());
  rows(v, "mean_error_mm", static_cast<double>(compute_contour_error(b.adapter.shape(), 4).mean_mm));
}

void relief_contour(const BenchRows& rows, int n, int vertices) {
  const Grid base(n);
  ContourOptions fine;
  fine.mean_mm = 0.001f;
  fine.max_mm = 0.003f;
  contour(rows, "contour", base.uv_span(), base.corner_span(), {nullptr, &relief}, fine, vertices);
}

void model_contour(const BenchRows& rows, const Model& model, int vertices) {
  ModelSurface surface(model, std::vector<float>(model.parameters().count, 0.0f));
  ContourOptions fine;
  fine.mean_mm = fine.max_mm = 0;
  fine.volume_mm3 = 1e-6f;
  contour(rows, "model", model.base_uv(), model.base_corners(), surface.surface(), fine, vertices);
}

// The mesh update between two frames of a tracker: 64 splits and welds on a mesh at its budget, without new ranks.
void budgeted_pass(const BenchRows& rows) {
  const Grid base(8);
  ContourOptions fine;
  fine.mean_mm = fine.max_mm = 0;
  fine.volume_mm3 = 1e-4f;
  Times pass, rank;
  Bench b(MeshLimits{1100, 2200, 16});
  for (int repeat = 0; repeat < 41; ++repeat) {
    if (b.mesh.set_base(base.uv_span(), base.corner_span()) != Status::ok) std::abort();
    if (b.adapter.start(b.mesh, {nullptr, &patch}, criterion_of(fine)) != Status::ok) std::abort();
    AdaptOptions options;
    options.vertex_budget = 1000;
    (void)b.adapter.adapt(options);
    // The surface becomes another one under the mesh.
    if (b.adapter.start(b.mesh, {nullptr, &relief}, criterion_of(fine)) != Status::ok) std::abort();
    const double t0 = now_ns();
    b.adapter.resample();
    b.adapter.rerank();
    const double t1 = now_ns();
    options.max_operations = 64;
    const AdaptReport report = b.adapter.adapt(options);
    const double t2 = now_ns();
    if (report.splits + report.welds < 60) std::abort();
    pass.ns.push_back(t2 - t1);
    rank.ns.push_back(t1 - t0);
  }
  rows("budgeted_pass_64_operations_1000_vertices", "us", 1e-3 * pass.median());
  rows("rank_all_1000_vertices", "us", 1e-3 * rank.median());
}

void memory(const BenchRows& rows, int faces) {
  MeshLimits l;
  l.vertices = static_cast<std::uint16_t>(faces / 2 + 2);
  l.faces = static_cast<std::uint16_t>(faces);
  const std::string v = "memory_" + std::to_string(faces);
  rows(v, "bytes_per_triangle", static_cast<double>(measured_bytes<Mesh>(l)) / faces);
  rows(v, "bytes_per_triangle_of_positions_and_queues",
       static_cast<double>(measured_bytes<Adapter>(l)) / faces);
}

}  // namespace

void bench_mesh(std::ostream& out, const ModelFile* model) {
  const BenchRows rows(out, "mesh");
  for (const bool restricted : {false, true}) {
    bare_operators(rows, 22, 10000, restricted);
    bare_operators(rows, 71, 20000, restricted);
  }
  restricted_adaptation(rows, 8, 7);
  restricted_adaptation(rows, 22, 4);
  relief_contour(rows, 8, 1900);
  if (model != nullptr) model_contour(rows, model->model(), 1900);
  budgeted_pass(rows);
  for (const int faces : {968, 3528, 10082, 16384}) memory(rows, faces);
}

}  // namespace pliant::host
