#include "pliant/adapt.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <set>

#include "aligned_block.hpp"
#include "mesh_shapes.hpp"
#include "pliant/criteria.hpp"
#include "pliant/mesh_star.hpp"
#include "random.hpp"

namespace adapt_test {

using namespace pliant;
using shapes::limits;
using shapes::MeshBox;
using shapes::Triangles;

namespace {

// Five bumps on a square of 100 mm that wander with `time`.
struct Bumps {
  float time = 0;
  int samples = 0;
  static Vec3 sample(void* context, Vec2 uv) {
    auto& self = *static_cast<Bumps*>(context);
    ++self.samples;
    float z = 0;
    for (int i = 0; i < 5; ++i) {
      const auto k = static_cast<float>(i);
      const float du = uv.x - 0.5f - 0.35f * std::sin(1.7f * k + self.time),
                  dv = uv.y - 0.5f - 0.35f * std::cos(2.3f * k + 0.7f * self.time);
      z += (4 + k) / (1 + (150 + 120 * k) * (du * du + dv * dv));
    }
    return {100 * uv.x, 100 * uv.y, z};
  }
  Surface surface() { return {this, &sample}; }
};

// A patch of a torus.
Vec3 torus_patch(void*, Vec2 uv) {
  const float a = 3 * uv.x, b = 3 * uv.y;
  return {(40 + 15 * std::cos(b)) * std::cos(a), (40 + 15 * std::cos(b)) * std::sin(a), 15 * std::sin(b)};
}

// A sphere of 50 mm but for one point, stereographic.
Vec3 sphere(void*, Vec2 uv) {
  const float x = 4 * uv.x - 2, y = 4 * uv.y - 2, s = 1 / (1 + x * x + y * y);
  return {100 * x * s, 100 * y * s, 50 * (1 - x * x - y * y) * s};
}

struct Setup {
  Setup(const MeshLimits& l, const Triangles& base, const Surface& surface, const Criterion& criterion)
      : box(l, base), block(measured_bytes<Adapter>(l)), arena(block.data(), block.size()) {
    REQUIRE(box.status == Status::ok);
    REQUIRE(create_in(arena, adapter, l) == Status::ok);
    REQUIRE(adapter.start(box.mesh, surface, criterion) == Status::ok);
  }
  MeshBox box;
  AlignedBlock block;
  Arena arena;
  Adapter adapter;
};

AdaptOptions splits_only() {
  AdaptOptions o;
  o.may_weld = false;
  return o;
}

AdaptOptions with_budget(int vertices) {
  AdaptOptions o;
  o.vertex_budget = vertices;
  return o;
}

float rank(const Criterion& c, const Adapter& a, FaceId f) {
  return c.refine_rank(c.context, a.shape(), f);
}

}  // namespace

TEST_CASE("the rank queue gives what a sorted set gives") {
  AlignedBlock block(measured_bytes<RankQueue>(std::size_t{300}));
  Arena arena(block.data(), block.size());
  RankQueue queue;
  REQUIRE(create_in(arena, queue, std::size_t{300}) == Status::ok);
  for (const std::uint64_t floor : {std::uint64_t{0}, std::uint64_t{1} << 63, ~std::uint64_t{0}}) {
    queue.clear(floor);
    Random random{1};
    std::set<std::pair<std::uint64_t, std::uint16_t>> reference;
    std::vector<std::uint64_t> key(300, 0);
    for (int i = 0; i < 20000; ++i) {
      const auto id = static_cast<std::uint16_t>(random.below(300));
      if (queue.contains(id)) reference.erase({key[id], id});
      if (random.below(3) == 0) {
        queue.remove(id);
        CHECK(!queue.contains(id));
      } else {
        key[id] = random.bits() >> 16 << 16 | id;
        queue.set(id, key[id]);
        reference.insert({key[id], id});
      }
      if (!reference.empty()) {
        const auto& any = *reference.begin();
        REQUIRE(queue.contains(any.second));
        CHECK(queue.key(any.second) == any.first);
      }
      if (random.below(4) != 0) continue;
      CHECK(queue.find_highest_key() == (reference.empty() ? 0 : reference.rbegin()->first));
      const bool has_top = !reference.empty() && reference.rbegin()->first >= floor;
      CHECK(queue.top() == (has_top ? reference.rbegin()->second : kNone));
    }
  }
}

TEST_CASE("unconditional refinement to depth n multiplies the faces by two to the n, and back") {
  Bumps bumps;
  Unconditional depth{0};
  Setup s(limits(2000, 4000), shapes::block_grid(4), bumps.surface(), criterion_of(depth));
  for (const int n : {3, 5, 6, 2, 0, 3, std::numeric_limits<int>::min()}) {
    depth.levels = n;
    s.adapter.rerank();
    const AdaptReport report = s.adapter.adapt({});
    CHECK(report.stop == AdaptStop::converged);
    CHECK(s.box.mesh.face_count() == 32 << (n > 0 ? n : 0));
    CHECK(report.worst_rank == 0);
    CHECK(s.box.mesh.validate().invariant == 0);
  }
}

TEST_CASE(
    "each surface is refined until every face is within tolerance, and no vertex is there for nothing") {
  ContourOptions tolerance;
  tolerance.mean_mm = 0.1f;
  tolerance.max_mm = 0.3f;
  const Criterion contour = criterion_of(tolerance);
  Bumps bumps;
  for (const Surface& surface :
       {bumps.surface(), Surface{nullptr, &torus_patch}, Surface{nullptr, &sphere}}) {
    Setup s(limits(6000, 12000, 16), shapes::block_grid(4), surface, contour);
    AdaptReport report = s.adapter.adapt({});
    REQUIRE(report.stop == AdaptStop::converged);
    CHECK(report.worst_rank <= 1);
    CHECK(report.splits > 100);
    CHECK(s.box.mesh.validate().invariant == 0);
    for (const FaceId f : s.box.mesh.faces()) REQUIRE(rank(contour, s.adapter, f) <= 1);
    for (const VertexId v : s.box.mesh.vertices()) {
      if (!s.box.mesh.is_weldable(v)) continue;
      float worth = contour.weld_rank(contour.context, s.adapter.shape(), v);
      for (const HalfEdgeId h : star(s.box.mesh, v))
        worth = max(worth, rank(contour, s.adapter, Mesh::face_of(h)));
      REQUIRE(worth * 1.25f >= 1);
      REQUIRE(length(s.adapter.position(v) - surface(s.box.mesh.uv(v))) == 0);
    }
    const ContourError whole = compute_contour_error(s.adapter.shape(), 4);
    CHECK(whole.mean_mm <= 0.1f);
    CHECK(whole.max_mm <= 0.5f);

    // Nothing is left to do, also with all ranks taken afresh; ten times the tolerance welds most of it.
    s.adapter.rerank();
    report = s.adapter.adapt({});
    CHECK(report.splits + report.welds == 0);
    const int before = s.box.mesh.vertex_count();
    tolerance.mean_mm = 1;
    tolerance.max_mm = 3;
    s.adapter.rerank();
    report = s.adapter.adapt({});
    CHECK(report.splits == 0);
    CHECK(s.box.mesh.vertex_count() < before / 2);
    for (const FaceId f : s.box.mesh.faces()) REQUIRE(rank(contour, s.adapter, f) <= 1);
    tolerance.mean_mm = 0.1f;
    tolerance.max_mm = 0.3f;
  }
}

TEST_CASE("the result does not depend on the order of the base mesh, with a budget or without") {
  Bumps bumps;
  const Triangles base = shapes::block_grid(5);
  ContourOptions tolerance;
  tolerance.mean_mm = 0.15f;
  tolerance.max_mm = 0.5f;
  Unconditional deep{9};
  const Criterion criteria[] = {criterion_of(tolerance), criterion_of(deep)};
  for (const Criterion& criterion : criteria) {
    for (const int budget : {150, 371, 1000}) {
      std::vector<shapes::Face> first;
      for (int round = 0; round < 5; ++round) {
        Random random{static_cast<std::uint64_t>(round)};
        Setup s(limits(1000, 2000), round == 0 ? base : shapes::shuffled(base, random), bumps.surface(),
                criterion);
        (void)s.adapter.adapt(with_budget(budget));
        if (round == 0) first = shapes::sorted_faces(s.box.mesh);
        CHECK(shapes::sorted_faces(s.box.mesh) == first);
      }
      CHECK(first.size() > 200);
    }
  }
}

TEST_CASE("the vertex budget is never exceeded, at any size, and filled") {
  Bumps bumps;
  ContourOptions fine;
  fine.mean_mm = 0.001f;
  fine.max_mm = 0.001f;
  const Criterion contour = criterion_of(fine);
  for (int budget = 25; budget < 400; budget += 7) {
    for (const int capacity : {budget, 600}) {
      Setup s(limits(capacity, 2000), shapes::block_grid(4), bumps.surface(), contour);
      AdaptOptions one = with_budget(budget);
      one.max_operations = 13;
      for (int call = 0; call < 60; ++call) {
        const AdaptReport report = s.adapter.adapt(one);
        REQUIRE(report.splits + report.welds <= 13);
        REQUIRE(s.box.mesh.vertex_count() <= budget);
      }
      CHECK(s.box.mesh.validate().invariant == 0);
      CHECK(s.box.mesh.vertex_count() >= budget - 6);
      CHECK(s.adapter.adapt(with_budget(budget)).stop == AdaptStop::no_room);
    }
  }
}

TEST_CASE("a budget that was lowered is reached by welding the cheapest, down to the base") {
  Bumps bumps;
  ContourOptions fine;
  fine.mean_mm = fine.max_mm = 0.01f;
  Setup s(limits(600, 1200), shapes::block_grid(4), bumps.surface(), criterion_of(fine));
  (void)s.adapter.adapt(with_budget(500));
  for (int budget = 480; budget > 0; budget -= 60) {
    const AdaptReport report = s.adapter.adapt(with_budget(budget));
    CHECK(s.box.mesh.vertex_count() <= (budget > 25 ? budget : 25));
    CHECK(report.stop == AdaptStop::no_room);
    CHECK(s.box.mesh.validate().invariant == 0);
  }
  CHECK(s.box.mesh.face_count() >= 32);
}

TEST_CASE("too few faces stop refinement as too few vertices do") {
  Bumps bumps;
  ContourOptions fine;
  fine.mean_mm = fine.max_mm = 0.001f;
  for (int faces = 32; faces < 120; ++faces) {
    Setup s(limits(500, faces), shapes::block_grid(4), bumps.surface(), criterion_of(fine));
    CHECK(s.adapter.adapt({}).stop == AdaptStop::no_room);
    CHECK(s.box.mesh.face_count() <= faces);
    CHECK(s.box.mesh.face_count() >= faces - 10);
    CHECK(s.box.mesh.validate().invariant == 0);
  }
}

TEST_CASE("a split at the boundary needs room for one face, and no more") {
  Bumps bumps;
  ContourOptions fine;
  fine.mean_mm = fine.max_mm = 1e-6f;
  for (const int faces : {1, 2, 3}) {
    Setup s(limits(50, faces), {{{0, 0}, {1, 0}, {0, 1}}, {0, 1, 2}}, bumps.surface(), criterion_of(fine));
    CHECK(s.adapter.adapt({}).stop == AdaptStop::no_room);
    CHECK(s.box.mesh.face_count() == faces);
  }
}

TEST_CASE("a budgeted mesh that follows a moving surface beats a uniform one of twice the vertices") {
  Bumps bumps;
  ContourOptions volume;
  volume.mean_mm = volume.max_mm = 0;
  volume.volume_mm3 = 0.01f;
  Setup s(limits(700, 1400), shapes::block_grid(4), bumps.surface(), criterion_of(volume));
  Unconditional uniform{5};
  Setup u(limits(2000, 4000), shapes::block_grid(4), bumps.surface(), criterion_of(uniform));
  (void)u.adapter.adapt({});
  REQUIRE(u.box.mesh.vertex_count() > 500);
  AdaptOptions options = with_budget(u.box.mesh.vertex_count() / 2);
  (void)s.adapter.adapt(options);
  options.max_operations = 128;
  float mean = 0, uniform_mean = 0, worst = 0, uniform_worst = 0;
  for (int frame = 0; frame < 30; ++frame) {
    bumps.time += 0.02f;
    s.adapter.resample();
    s.adapter.rerank();
    const AdaptReport report = s.adapter.adapt(options);
    CHECK(report.splits + report.welds <= 128);
    u.adapter.resample();
    const ContourError e = compute_contour_error(s.adapter.shape(), 4),
                       e_uniform = compute_contour_error(u.adapter.shape(), 4);
    mean += e.mean_mm / 30;
    uniform_mean += e_uniform.mean_mm / 30;
    worst = max(worst, e.max_mm);
    uniform_worst = max(uniform_worst, e_uniform.max_mm);
  }
  MESSAGE("mean ", mean, " against ", uniform_mean, ", worst ", worst, " against ", uniform_worst);
  CHECK(mean < uniform_mean);
  CHECK(worst < uniform_worst);
}

TEST_CASE("a surface at rest is left at rest") {
  Bumps bumps;
  ContourOptions volume;
  volume.mean_mm = volume.max_mm = 0;
  volume.volume_mm3 = 1e-4f;
  Setup s(limits(700, 1400), shapes::block_grid(4), bumps.surface(), criterion_of(volume));
  for (int frame = 0; frame < 10; ++frame) (void)s.adapter.adapt(with_budget(300));
  const std::uint32_t digest = s.box.mesh.compute_digest();
  for (int frame = 0; frame < 10; ++frame) {
    s.adapter.resample();
    s.adapter.rerank();
    const AdaptReport report = s.adapter.adapt(with_budget(300));
    CHECK(report.splits + report.welds == 0);
  }
  CHECK(s.box.mesh.compute_digest() == digest);
}

TEST_CASE("ranks kept from call to call are those that ranking afresh gives") {
  Bumps bumps;
  ContourOptions tolerance;
  Setup s(limits(900, 1800), shapes::block_grid(4), bumps.surface(), criterion_of(tolerance));
  AdaptOptions options = with_budget(300);
  options.max_operations = 20;
  for (int i = 0; i < 30; ++i) {
    tolerance.mean_mm = i % 10 < 5 ? 0.05f : 0.5f;
    s.adapter.rerank();
    (void)s.adapter.adapt(options);
    // The same mesh, another adapter: its next steps must be the same.
    MeshBox copy(limits(900, 1800), shapes::block_grid(4));
    REQUIRE(copy.mesh.copy_from(s.box.mesh) == Status::ok);
    AlignedBlock block(measured_bytes<Adapter>(limits(900, 1800)));
    Arena arena(block.data(), block.size());
    Adapter fresh;
    REQUIRE(create_in(arena, fresh, limits(900, 1800)) == Status::ok);
    REQUIRE(fresh.start(copy.mesh, bumps.surface(), criterion_of(tolerance)) == Status::ok);
    const AdaptReport a = s.adapter.adapt(options), b = fresh.adapt(options);
    CHECK(a.splits == b.splits);
    CHECK(a.welds == b.welds);
    CHECK(a.worst_rank == b.worst_rank);
    CHECK(s.box.mesh.compute_digest() == copy.mesh.compute_digest());
  }
}

TEST_CASE("two rounds of ranking in parts give the ranks of ranking at once") {
  Bumps bumps;
  ContourOptions tolerance;
  Setup a(limits(900, 1800), shapes::block_grid(4), bumps.surface(), criterion_of(tolerance));
  Setup b(limits(900, 1800), shapes::block_grid(4), bumps.surface(), criterion_of(tolerance));
  (void)a.adapter.adapt({});
  (void)b.adapter.adapt({});
  bumps.time = 0.3f;
  for (Setup* s : {&a, &b}) s->adapter.resample();
  a.adapter.rerank();
  for (int part = 0; part < 14; ++part) b.adapter.rerank(part % 7, 7);
  CHECK(a.adapter.adapt({}).splits == b.adapter.adapt({}).splits);
  CHECK(a.box.mesh.compute_digest() == b.box.mesh.compute_digest());
}

TEST_CASE("a pair of yes-or-no tests works as ranks do") {
  // Refine what touches the left edge down to level 6; give up what does not.
  AdaptTests tests;
  tests.should_refine = [](void*, const Shape& s, FaceId f) {
    bool touches = false;
    for (int k = 0; k < 3; ++k) touches = touches || s.mesh.uv(s.mesh.corner(f, k)).x <= 0;
    return touches && s.mesh.face_level(f) < 6;
  };
  tests.should_simplify = [](void*, const Shape& s, VertexId v) {
    Triangle parents[2];
    bool touches = false;
    for (int i = s.mesh.find_parents(v, parents) - 1; i >= 0; --i)
      for (const VertexId c : parents[i].corner) touches = touches || s.mesh.uv(c).x <= 0;
    return !touches || s.mesh.level(v) > 6;
  };
  Bumps bumps;
  Setup s(limits(900, 1800), shapes::block_grid(4), bumps.surface(), criterion_of(tests));
  CHECK(s.adapter.adapt(splits_only()).stop == AdaptStop::converged);
  const auto fixpoint = shapes::sorted_faces(s.box.mesh);
  CHECK(fixpoint.size() > 100);
  // Unconditional refinement in between, then the tests again: back to the same.
  Unconditional depth{4};
  REQUIRE(s.adapter.start(s.box.mesh, bumps.surface(), criterion_of(depth)) == Status::ok);
  CHECK(s.adapter.adapt(splits_only()).splits > 0);
  REQUIRE(s.adapter.start(s.box.mesh, bumps.surface(), criterion_of(tests)) == Status::ok);
  AdaptOptions welds_only;
  welds_only.may_split = false;
  CHECK(s.adapter.adapt(welds_only).welds > 0);
  CHECK(shapes::sorted_faces(s.box.mesh) == fixpoint);
}

TEST_CASE("any limit of operations a call, however small, leads to a mesh within the tolerance") {
  Bumps bumps;
  ContourOptions tolerance;
  tolerance.mean_mm = 0.05f;
  Setup whole(limits(900, 1800), shapes::block_grid(4), bumps.surface(), criterion_of(tolerance));
  CHECK(whole.adapter.adapt(splits_only()).stop == AdaptStop::converged);
  for (const int most : {1, 2, 3, 6}) {
    Setup s(limits(900, 1800), shapes::block_grid(4), bumps.surface(), criterion_of(tolerance));
    AdaptOptions few = splits_only();
    few.max_operations = most;
    AdaptReport report;
    report.stop = AdaptStop::operations;
    for (int calls = 0; calls < 2000 && report.stop == AdaptStop::operations; ++calls) {
      report = s.adapter.adapt(few);
      CHECK(report.splits <= most);
      if (report.stop == AdaptStop::operations) CHECK(report.splits == most);
    }
    CHECK(report.stop == AdaptStop::converged);
    CHECK(report.worst_rank <= 1);
    CHECK(s.box.mesh.vertex_count() == doctest::Approx(whole.box.mesh.vertex_count()).epsilon(0.02));
  }
}

TEST_CASE("the adapter refuses what it cannot work with") {
  Bumps bumps;
  ContourOptions tolerance;
  const Criterion contour = criterion_of(tolerance);
  Setup s(limits(100, 200), shapes::block_grid(2), bumps.surface(), contour);
  CHECK(s.adapter.start(s.box.mesh, {}, contour) == Status::bad_argument);
  CHECK(s.adapter.start(s.box.mesh, bumps.surface(), {}) == Status::bad_argument);
  MeshBox other(limits(101, 200), shapes::block_grid(2)), empty(limits(100, 200));
  CHECK(s.adapter.start(other.mesh, bumps.surface(), contour) == Status::bad_argument);
  MeshBox shallow(limits(100, 200, 4), shapes::block_grid(2));  // it would be refined beyond its own level
  CHECK(s.adapter.start(shallow.mesh, bumps.surface(), contour) == Status::bad_argument);
  CHECK(s.adapter.start(empty.mesh, bumps.surface(), contour) == Status::not_ready);
  Adapter idle;
  CHECK(idle.adapt({}).splits == 0);
  idle.resample();
  idle.rerank();
}

TEST_CASE("a rank that is no number counts as none") {
  Criterion bad;
  bad.refine_rank = [](const void*, const Shape&, FaceId) { return std::nanf(""); };
  bad.weld_rank = [](const void*, const Shape&, VertexId) { return std::nanf(""); };
  Bumps bumps;
  Setup s(limits(100, 200), shapes::block_grid(2), bumps.surface(), bad);
  CHECK(s.adapter.adapt({}).splits == 0);
}

TEST_CASE("an adapter takes 12 bytes a face and 24 a vertex") {
  CHECK(measured_bytes<Adapter>(limits(1024, 2048)) == 12 * 2048 + 24 * 1024);
}

}  // namespace adapt_test
