#include "pliant/mesh.hpp"

#include <doctest/doctest.h>

#include <map>
#include <set>

#include "aligned_block.hpp"
#include "mesh_shapes.hpp"
#include "mesh_tools.hpp"
#include "random.hpp"

namespace mesh_test {

using namespace pliant;
using shapes::limits;
using shapes::MeshBox;
using shapes::Triangles;

TEST_CASE("every base is accepted, valid and has the Euler number of its kind") {
  const int euler[] = {1, 1, 1, 1, 1, 0, -3, 2};
  const int loops[] = {1, 1, 1, 1, 1, 0, 5, 2};
  int i = 0;
  for (const Triangles& base : bases()) {
    MeshBox box(limits(200, 400), base);
    REQUIRE(box.status == Status::ok);
    CHECK_VALID(box.mesh);
    const MeshStatistics s = box.mesh.compute_statistics();
    CHECK(s.euler == euler[i]);
    CHECK(s.boundary_loops == loops[i]);
    CHECK(s.faces == static_cast<int>(base.face_count()));
    CHECK(s.vertices == static_cast<int>(base.uv.size()));
    ++i;
  }
}

TEST_CASE("twins, stars and boundary loops of a grid are what they should be") {
  MeshBox box(limits(100, 100), shapes::block_grid(4));
  const Mesh& mesh = box.mesh;
  int edges = 0, star_total = 0;
  for (const FaceId f : mesh.faces())
    for (int k = 0; k < 3; ++k) {
      const HalfEdgeId h = Mesh::half_edge(f, k);
      CHECK(Mesh::next(Mesh::next(Mesh::next(h))) == h);
      CHECK(Mesh::previous(Mesh::next(h)) == h);
      CHECK(mesh.find_half_edge(mesh.origin(h), mesh.destination(h)) == h);
      if (!mesh.is_boundary_edge(h)) CHECK(mesh.twin(mesh.twin(h)) == h);
      if (mesh.represents_edge(h)) ++edges;
    }
  const VertexId corner = mesh.origin(0);
  CHECK(mesh.find_half_edge(corner, corner) == kNone);
  for (const VertexId v : mesh.vertices())
    if (length(mesh.uv(v) - mesh.uv(corner)) > 0.5f) CHECK(mesh.find_half_edge(corner, v) == kNone);
  CHECK(edges == mesh.edge_count());
  for (const VertexId v : mesh.vertices()) {
    star_total += mesh.find_valence(v);
    const Vec2 p = mesh.uv(v);
    CHECK(mesh.is_boundary_vertex(v) == (p.x <= 0 || p.x >= 1 || p.y <= 0 || p.y >= 1));
  }
  CHECK(star_total == 2 * edges);
  HalfEdgeId loop[2] = {kNone, kNone};
  REQUIRE(mesh.find_boundary_loops({loop, 2}) == 1);
  int length = 0;
  HalfEdgeId h = loop[0];
  do {
    CHECK(mesh.is_boundary_edge(h));
    h = mesh.next_on_boundary(h);
    ++length;
  } while (h != loop[0] && length < 100);
  CHECK(length == 16);
}

TEST_CASE("a mesh fits what required bytes say, and no smaller arena") {
  const MeshLimits l = limits(1024, 2048);
  const std::size_t bytes = measured_bytes<Mesh>(l);
  CHECK(bytes <= 20 * 2048);  // 20 bytes a triangle
  AlignedBlock block(bytes);
  for (std::size_t less = 16; less <= bytes; less += 16 * 97) {
    Arena arena(block.data(), bytes - less);
    Mesh mesh;
    CHECK(create_in(arena, mesh, l) == Status::out_of_memory);
    CHECK(arena.used_bytes() == 0);
  }
  Arena arena(block.data(), bytes);
  Mesh mesh;
  CHECK(create_in(arena, mesh, l) == Status::ok);
}

TEST_CASE("a split edge bears its midpoint and weld gives back every byte") {
  for (const Triangles& base : bases()) {
    MeshBox box(limits(200, 400), base);
    Mesh& mesh = box.mesh;
    refine_all(mesh, 1);
    mesh.clear_changes();
    for (const FaceId f : faces_of(mesh)) {
      const auto before = box.block.copy();
      const HalfEdgeId h = Mesh::half_edge(f, 0);
      const Vec2 a = mesh.uv(mesh.origin(h)), b = mesh.uv(mesh.destination(h));
      const int faces = mesh.face_count(), vertices = mesh.vertex_count();
      const bool at_boundary = mesh.is_boundary_edge(h);
      VertexId v = kNone;
      if (!mesh.is_ready(f)) {
        CHECK(mesh.split_edge(h, v) == Status::not_ready);
        continue;
      }
      REQUIRE(mesh.split_edge(h, v) == Status::ok);
      CHECK_VALID(mesh);
      CHECK(mesh.uv(v).x == 0.5f * (a.x + b.x));
      CHECK(mesh.uv(v).y == 0.5f * (a.y + b.y));
      CHECK(mesh.vertex_count() == vertices + 1);
      CHECK(mesh.face_count() == faces + (at_boundary ? 1 : 2));
      REQUIRE(mesh.changes().count == 1);
      CHECK(mesh.changes()[0] == v);
      CHECK(mesh.is_weldable(v));
      CHECK(mesh.weld_edge(v) == Status::ok);
      CHECK(mesh.changes().count == 1);
      mesh.clear_changes();
      CHECK(box.block.copy() == before);
    }
  }
}

TEST_CASE("what a weld would bring back is the faces that the split took away") {
  MeshBox box(limits(400, 800), shapes::block_grid(4));
  Mesh& mesh = box.mesh;
  Random random{3};
  for (int i = 0; i < 60; ++i) REQUIRE(mesh.refine(random_face(mesh, random)) == Status::ok);
  for (const FaceId f : faces_of(mesh)) {
    if (!mesh.is_ready(f)) continue;
    std::vector<Triangle> before = {mesh.triangle(f)};
    const HalfEdgeId t = mesh.twin(Mesh::half_edge(f, 0));
    if (t != kNone) before.push_back(mesh.triangle(Mesh::face_of(t)));
    VertexId v = kNone;
    REQUIRE(mesh.split_edge(Mesh::half_edge(f, 0), v) == Status::ok);
    Triangle parents[2];
    REQUIRE(mesh.find_parents(v, parents) == static_cast<int>(before.size()));
    for (std::size_t i = 0; i < before.size(); ++i) {
      CHECK(parents[i].level == before[i].level);
      for (int k = 0; k < 3; ++k) {
        CHECK(parents[i].corner[k] == before[i].corner[k]);
        CHECK(parents[i].across[k] == before[i].across[k]);
      }
    }
    REQUIRE(mesh.weld_edge(v) == Status::ok);
  }
}

TEST_CASE("refining everything n times multiplies the faces by two to the n") {
  for (const Triangles& base : bases()) {
    MeshBox box(limits(2000, 4000), base);
    Mesh& mesh = box.mesh;
    const int faces = mesh.face_count(), euler = mesh.compute_statistics().euler;
    for (int n = 1; n <= 5; ++n) {
      refine_all(mesh, n);
      CHECK(mesh.face_count() == faces << n);
      const MeshStatistics s = mesh.compute_statistics();
      CHECK(s.faces_at_level[n] == mesh.face_count());
      CHECK(s.euler == euler);
      CHECK_VALID(mesh);
    }
  }
}

TEST_CASE("refinement is restricted: it splits at most level + 1 edges, each of them needed") {
  MeshBox box(limits(2000, 4000, 14), shapes::block_grid(2));
  Mesh& mesh = box.mesh;
  Random random{11};
  int longest = 0;
  for (int i = 0; i < 400; ++i) {
    FaceId f = random_face(mesh, random);
    if (random.below(2) == 0) f = Mesh::face_of(mesh.out(0));  // dig at a corner
    const int level = mesh.face_level(f);
    const int before = mesh.vertex_count();
    FaceId chain[MeshLimits::kDeepest + 1];
    int new_faces = 0;
    const int count = mesh.find_refinement_chain(f, chain, &new_faces);
    const int faces = mesh.face_count();
    const Status status = mesh.refine(f);
    if (level == 14) {
      CHECK(status == Status::not_ready);
      continue;
    }
    REQUIRE(status == Status::ok);
    CHECK(mesh.vertex_count() == before + count);
    CHECK(mesh.face_count() == faces + new_faces);
    CHECK(count <= level + 1);
    longest = std::max(longest, count);
    CHECK_VALID(mesh);
  }
  CHECK(longest >= 5);
}

TEST_CASE(
    "a storm of refine, simplify, split and weld keeps every invariant and ends in the base to the byte") {
  int seed = 100;
  for (const Triangles& base : bases()) {
    MeshBox box(limits(160, 300, 9), base);
    Mesh& mesh = box.mesh;
    const auto before = box.block.copy();
    Random random{static_cast<std::uint64_t>(++seed)};
    int full = 0, wide = 0;
    for (int i = 0; i < 4000; ++i) {
      const auto op = random.below(16);
      if (op < 9) {
        if (mesh.refine(random_face(mesh, random)) == Status::capacity) ++full;
      } else if (op < 11) {
        VertexId v = kNone;
        (void)mesh.split_edge(Mesh::half_edge(random_face(mesh, random), static_cast<int>(random.below(3))),
                              v);
      } else if (op < 15) {
        (void)mesh.weld_edge(random_vertex(mesh, random));
      } else {
        (void)mesh.simplify(random_vertex(mesh, random));
      }
      const MeshFault fault = mesh.validate();
      REQUIRE_MESSAGE(fault.invariant == 0, "invariant ", fault.invariant, " at ", fault.id);
      wide = std::max(wide, mesh.compute_statistics().largest_valence);
    }
    CHECK(full > 0);
    CHECK(wide >= 8);
    mesh.simplify_all();
    CHECK(mesh.face_count() == static_cast<int>(base.face_count()));
    mesh.clear_changes();
    CHECK(box.block.copy() == before);
  }
}

TEST_CASE("a million operations leave no trace") {
  Random shake{5};
  MeshBox box(limits(1200, 2200, 12), shapes::block_grid(6, &shake));
  Mesh& mesh = box.mesh;
  const auto before = box.block.copy();
  Random random{6};
  for (int i = 0; i < 1000000; ++i) {
    if (random.below(2) == 0)
      (void)mesh.refine(random_face(mesh, random));
    else
      (void)mesh.weld_edge(random_vertex(mesh, random));
    if (i % 16384 == 0) CHECK_VALID(mesh);
  }
  CHECK(mesh.face_count() > 500);
  CHECK_VALID(mesh);
  mesh.simplify_all();
  mesh.clear_changes();
  CHECK(box.block.copy() == before);
}

TEST_CASE("simplify removes a vertex with all that stands on it, and nothing else changes level") {
  MeshBox box(limits(2000, 4000), shapes::block_grid(2));
  Mesh& mesh = box.mesh;
  refine_all(mesh, 6);
  CHECK(mesh.simplify(0) == Status::not_ready);
  VertexId first = kNone;
  for (const VertexId v : mesh.vertices())
    if (mesh.level(v) == 1 && first == kNone) first = v;
  const int before = mesh.vertex_count();
  REQUIRE(mesh.simplify(first) == Status::ok);
  CHECK(!mesh.is_live_vertex(first));
  CHECK(mesh.vertex_count() < before - 20);
  CHECK(mesh.compute_statistics().deepest == 6);
  CHECK_VALID(mesh);
}

TEST_CASE("the mesh of a predicate does not depend on the order of refinement nor of the base's faces") {
  const auto wants = [](const Mesh& mesh, FaceId f) {
    const Vec2 p = mesh.uv(mesh.corner(f, 2)) - Vec2{0.31f, 0.62f};
    return static_cast<float>(mesh.face_level(f)) < 11.0f - 14.0f * length(p);
  };
  Random shake{21};
  const Triangles base = shapes::block_grid(3, &shake);
  std::vector<shapes::Face> first;
  for (int round = 0; round < 12; ++round) {
    Random random{static_cast<std::uint64_t>(1000 + round)};
    MeshBox box(limits(3000, 6000, 12), round == 0 ? base : shapes::shuffled(base, random));
    Mesh& mesh = box.mesh;
    for (bool again = true; again;) {
      again = false;
      std::vector<FaceId> faces = faces_of(mesh);
      for (std::size_t i = faces.size(); i > 1; --i) std::swap(faces[i - 1], faces[random.below(i)]);
      for (const FaceId f : faces)
        if (wants(mesh, f)) {
          REQUIRE(mesh.refine(f) == Status::ok);
          again = true;
        }
    }
    CHECK(mesh.face_count() > 200);
    CHECK_VALID(mesh);
    if (round == 0) first = shapes::sorted_faces(mesh);
    CHECK(shapes::sorted_faces(mesh) == first);
  }
}

TEST_CASE("at every capacity from the base to full, running out leaves the mesh as it was") {
  const Triangles base = shapes::grid_with_holes(3, [](int i, int j) { return i == 1 && j == 1; });
  const auto faces = static_cast<int>(base.face_count());
  const auto vertices = static_cast<int>(base.uv.size());
  for (int extra = 0; extra <= 60; ++extra) {
    // Short of vertices, then short of faces.
    for (const MeshLimits& l : {limits(vertices + extra, 500), limits(500, faces + extra)}) {
      MeshBox box(l, base);
      REQUIRE(box.status == Status::ok);
      Mesh& mesh = box.mesh;
      Random random{static_cast<std::uint64_t>(extra)};
      int refused = 0;
      for (int i = 0; i < 200; ++i) {
        const FaceId f = random_face(mesh, random);
        mesh.clear_changes();
        const auto before = box.block.copy();
        const Status status = mesh.refine(f);
        if (status == Status::ok) continue;
        ++refused;
        REQUIRE(status == Status::capacity);
        REQUIRE(box.block.copy() == before);
      }
      CHECK(refused > 0);
      CHECK_VALID(mesh);
      CHECK(mesh.vertex_count() <= l.vertices);
      CHECK(mesh.face_count() <= l.faces);
    }
  }
}

// A reference without half-edges: triangles by coordinates, neighbours by search, and a record
// of which edge every point was put on.
namespace {
struct NaiveMesh {
  using Point = std::pair<float, float>;
  using Tri = std::array<Point, 3>;  // subdivision edge from 0 to 1
  std::set<Tri> faces;
  std::map<Point, std::pair<Point, Point>> split_edge;

  explicit NaiveMesh(const Triangles& t) {
    for (std::size_t f = 0; f < t.face_count(); ++f) {
      Tri tri;
      for (std::size_t k = 0; k < 3; ++k)
        tri[k] = {t.uv[t.corners[3 * f + k]].x, t.uv[t.corners[3 * f + k]].y};
      faces.insert(tri);
    }
  }
  static Point middle(Point a, Point b) { return {0.5f * (a.first + b.first), 0.5f * (a.second + b.second)}; }
  const Tri* find(Point a, Point b) const {  // the face that runs from a to b
    for (const Tri& t : faces)
      for (std::size_t k = 0; k < 3; ++k)
        if (t[k] == a && t[(k + 1) % 3] == b) return &t;
    return nullptr;
  }
  void bisect(Tri t) {
    const Point m = middle(t[0], t[1]);
    split_edge[m] = {t[0], t[1]};
    faces.erase(t);
    faces.insert({t[2], t[0], m});
    faces.insert({t[1], t[2], m});
  }
  void refine(Tri t) {
    const Tri* mate = find(t[1], t[0]);
    if (mate != nullptr && !((*mate)[0] == t[1] && (*mate)[1] == t[0])) {
      refine(*mate);
      mate = find(t[1], t[0]);
    }
    if (mate != nullptr) bisect(*mate);
    bisect(t);
  }
  bool weld(Point v) {
    if (split_edge.count(v) == 0) return false;
    std::vector<Tri> around;
    for (const Tri& t : faces) {
      if (t[0] == v || t[1] == v) return false;
      if (t[2] == v) around.push_back(t);
    }
    const auto [a, b] = split_edge[v];
    for (const auto& [x, y] : {std::make_pair(a, b), std::make_pair(b, a)})
      for (const Tri& first : around)
        for (const Tri& second : around)
          if (first[1] == x && second[0] == y && first[0] == second[1]) faces.insert({x, y, first[0]});
    for (const Tri& t : around) faces.erase(t);
    split_edge.erase(v);
    return true;
  }
  std::vector<shapes::Face> sorted() const {
    std::vector<shapes::Face> all;
    for (const Tri& t : faces)
      all.push_back({t[0].first, t[0].second, t[1].first, t[1].second, t[2].first, t[2].second});
    std::sort(all.begin(), all.end());
    return all;
  }
};
}  // namespace

TEST_CASE("refinement and welds agree with a naive mesh without half-edges") {
  int welds = 0;
  for (const Triangles& base : {shapes::block_grid(2), shapes::fan(5)}) {
    for (int seed = 0; seed < 20; ++seed) {
      MeshBox box(limits(500, 1000), base);
      NaiveMesh naive(base);
      Random random{static_cast<std::uint64_t>(seed)};
      for (int i = 0; i < 80; ++i) {
        if (random.below(5) < 2) {
          const FaceId f = random_face(box.mesh, random);
          NaiveMesh::Tri t;
          for (int k = 0; k < 3; ++k) {
            const Vec2 p = box.mesh.uv(box.mesh.corner(f, k));
            t[static_cast<std::size_t>(k)] = {p.x, p.y};
          }
          if (box.mesh.refine(f) == Status::ok) naive.refine(t);
        } else {
          const VertexId v = random_vertex(box.mesh, random);
          const Vec2 p = box.mesh.uv(v);
          const bool done = box.mesh.weld_edge(v) == Status::ok;
          CHECK(naive.weld({p.x, p.y}) == done);
          welds += done ? 1 : 0;
        }
        REQUIRE(shapes::sorted_faces(box.mesh) == naive.sorted());
      }
    }
  }
  CHECK(welds > 300);
}

TEST_CASE("changes name each vertex once, whatever happened to it") {
  MeshBox box(limits(300, 600), shapes::block_grid(3));
  Mesh& mesh = box.mesh;
  Random random{31};
  std::map<VertexId, Vec2> seen;
  for (const VertexId v : mesh.vertices()) seen[v] = mesh.uv(v);
  for (int round = 0; round < 200; ++round) {
    for (int i = 0; i < 20; ++i)
      if (random.below(2) == 0)
        (void)mesh.refine(random_face(mesh, random));
      else
        (void)mesh.weld_edge(random_vertex(mesh, random));
    std::set<VertexId> once;
    for (const VertexId v : mesh.changes()) {
      CHECK(once.insert(v).second);
      if (mesh.is_live_vertex(v))
        seen[v] = mesh.uv(v);
      else
        seen.erase(v);
    }
    mesh.clear_changes();
    REQUIRE(static_cast<int>(seen.size()) == mesh.vertex_count());
    for (const auto& [v, p] : seen) {
      REQUIRE(mesh.is_live_vertex(v));
      CHECK(mesh.uv(v).x == p.x);
      CHECK(mesh.uv(v).y == p.y);
    }
  }
}

TEST_CASE("copies are equal and independent") {
  MeshBox a(limits(300, 600), shapes::block_grid(3)), b(limits(300, 600)), c(limits(301, 600));
  Random random{41};
  for (int i = 0; i < 50; ++i) (void)a.mesh.refine(random_face(a.mesh, random));
  CHECK(c.mesh.copy_from(a.mesh) == Status::bad_argument);
  MeshBox usual{MeshLimits{}};  // the limits that a mesh has before its layout
  const Mesh no_mesh;
  CHECK(usual.mesh.copy_from(no_mesh) == Status::bad_argument);
  REQUIRE(b.mesh.copy_from(a.mesh) == Status::ok);
  CHECK(b.block.copy() == a.block.copy());
  CHECK(b.mesh.compute_digest() == a.mesh.compute_digest());
  REQUIRE(b.mesh.refine(0) == Status::ok);
  CHECK(b.mesh.compute_digest() != a.mesh.compute_digest());
  CHECK_VALID(b.mesh);
  b.mesh.simplify_all();
  CHECK(b.mesh.face_count() == 18);
}

}  // namespace mesh_test
