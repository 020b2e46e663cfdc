// What the mesh refuses, each of its invariants broken by hand, and the stellar operators on a free mesh.
#include <doctest/doctest.h>

#include "mesh_shapes.hpp"
#include "mesh_tools.hpp"
#include "pliant/mesh.hpp"
#include "random.hpp"

namespace mesh_faults_test {

using namespace pliant;
using shapes::limits;
using shapes::MeshBox;
using shapes::Triangles;

namespace {

// Breaks a mesh on purpose.
class MeshSurgeon : private Mesh {
 public:
  explicit MeshSurgeon(Mesh& mesh) : mesh_(mesh) {}
  VertexId& corner(int f, int k) { return (mesh_.*(&MeshSurgeon::corner_))[3 * f + k]; }
  HalfEdgeId& twin(int f, int k) { return (mesh_.*(&MeshSurgeon::twin_))[3 * f + k]; }
  HalfEdgeId& out(int v) { return vertex(v).out; }
  std::uint8_t& level(int v) { return vertex(v).level; }
  Vec2& uv(int v) { return vertex(v).uv; }
  int& boundary_edges() { return mesh_.*(&MeshSurgeon::boundary_edges_); }
  int& base_euler() { return mesh_.*(&MeshSurgeon::base_euler_); }

 private:
  Vertex& vertex(int v) { return (mesh_.*(&MeshSurgeon::vertices_))[v]; }
  Mesh& mesh_;
};

}  // namespace

TEST_CASE("a bad base is refused by name and leaves the mesh empty") {
  const auto status_of = [](const Triangles& t, const MeshLimits& l = limits(50, 50)) {
    MeshBox box(l, t);
    if (box.status != Status::ok) {
      CHECK(box.mesh.face_count() == 0);
      CHECK(box.mesh.vertex_count() == 0);
      MeshBox fresh(l);
      CHECK(box.block.copy() == fresh.block.copy());
    }
    return box.status;
  };
  const Triangles square = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {2, 0, 1, 0, 2, 3}};
  REQUIRE(status_of(square) == Status::ok);
  Triangles t = square;
  t.corners[5] = 4;
  CHECK(status_of(t) == Status::bad_index);
  t = square;
  t.corners.pop_back();
  CHECK(status_of(t) == Status::bad_argument);
  t = square;
  t.uv[2].x = 0.0f / (t.uv[0].x * 0.0f);
  CHECK(status_of(t) == Status::bad_argument);
  CHECK(status_of({{{0, 0}}, {}}) == Status::bad_argument);
  MeshBox box(limits(50, 50));
  CHECK(box.mesh.set_base({}, square.corner_span()) == Status::bad_argument);
  CHECK(box.mesh.set_base(square.uv_span(), {}) == Status::bad_argument);
  t = square;
  t.corners[5] = 2;
  CHECK(status_of(t) == Status::degenerate_face);
  t = square;
  t.uv[3] = {0.5f, 0.5f};
  CHECK(status_of(t) == Status::degenerate_face);
  t = square;
  t.uv.push_back({2, 2});
  CHECK(status_of(t) == Status::isolated_vertex);
  t = square;
  t.add(3, 0, 2);
  CHECK(status_of(t) == Status::duplicate_face);
  t = square;
  t.add(0, 3, 2);
  CHECK(status_of(t) == Status::duplicate_face);
  t = square;  // three pages on one edge
  t.uv.push_back({2, 0.5f});
  t.add(0, 2, 4);
  CHECK(status_of(t) == Status::non_manifold_edge);
  t = square;
  std::swap(t.corners[3], t.corners[4]);
  CHECK(status_of(t) == Status::non_orientable);
  t = square;  // a bow-tie
  t.uv.insert(t.uv.end(), {{2, 1}, {2, 2}});
  t.add(2, 4, 5);
  CHECK(status_of(t) == Status::non_manifold_vertex);
  t = square;
  std::rotate(t.corners.begin(), t.corners.begin() + 1, t.corners.begin() + 3);
  CHECK(status_of(t) == Status::not_basic_blocks);
  CHECK(status_of(square, limits(3, 50)) == Status::capacity);
  CHECK(status_of(square, limits(50, 1)) == Status::capacity);
}

TEST_CASE("each invariant is seen when it is broken") {
  const auto broken = [](auto harm) {
    MeshBox box(limits(100, 200), shapes::block_grid(2));
    VertexId v = kNone;
    REQUIRE(box.mesh.split_edge(0, v) == Status::ok);
    REQUIRE(v == 9);
    MeshSurgeon surgeon{box.mesh};
    harm(surgeon, box.mesh);
    return box.mesh.validate().invariant;
  };
  CHECK(broken([](MeshSurgeon&, Mesh&) {}) == 0);
  CHECK(broken([](MeshSurgeon& s, Mesh&) { s.corner(2, 1) = s.corner(2, 0); }) == 1);
  CHECK(broken([](MeshSurgeon& s, Mesh&) { s.corner(2, 1) = 90; }) == 1);
  CHECK(broken([](MeshSurgeon& s, Mesh&) { s.twin(2, 0) = Mesh::half_edge(2, 0); }) == 2);
  CHECK(broken([](MeshSurgeon& s, Mesh&) { s.twin(2, 0) = 500; }) == 2);
  CHECK(broken([](MeshSurgeon& s, Mesh&) { std::swap(s.corner(2, 0), s.corner(2, 1)); }) == 3);
  CHECK(broken([](MeshSurgeon& s, Mesh& m) { s.out(0) = m.out(1); }) == 4);
  CHECK(broken([](MeshSurgeon& s, Mesh& m) {  // a boundary vertex that starts inside its fan
          s.out(1) = m.next_in_star(m.out(1));
        }) == 4);
  CHECK(broken([](MeshSurgeon& s, Mesh&) {  // a vertex shared by two separate fans
          s.corner(0, 0) = s.corner(7, 0);
        }) != 0);
  CHECK(broken([](MeshSurgeon& s, Mesh&) { ++s.base_euler(); }) == 6);
  CHECK(broken([](MeshSurgeon& s, Mesh&) { s.boundary_edges() += 2; }) == 7);
  CHECK(broken([](MeshSurgeon& s, Mesh&) { s.corner(100, 0) = 3; }) == 8);
  CHECK(broken([](MeshSurgeon& s, Mesh&) { s.level(50) = 3; }) == 8);
  CHECK(broken([](MeshSurgeon& s, Mesh& m) { s.uv(9) = m.uv(m.corner(0, 0)); }) == 9);
  CHECK(broken([](MeshSurgeon& s, Mesh&) { s.level(3) = 1; }) == 10);
  CHECK(broken([](MeshSurgeon& s, Mesh&) { s.level(9) = 2; }) == 11);
  CHECK(broken([](MeshSurgeon& s, Mesh&) { s.uv(9).x += 1e-3f; }) == 13);
}

TEST_CASE("an inserted vertex with more than eight faces is seen") {
  MeshBox box(limits(100, 200));
  const Triangles t = shapes::fan(9);
  REQUIRE(box.mesh.set_triangles(t.uv_span(), t.corner_span()) == Status::ok);
  REQUIRE(box.mesh.make_base() == Status::ok);
  CHECK_VALID(box.mesh);
  MeshBox big(limits(500, 800), shapes::torus(5));
  refine_all(big.mesh, 4);
  for (const VertexId v : big.mesh.vertices())
    if (big.mesh.level(v) > 0) CHECK(big.mesh.find_valence(v) <= 8);
}

TEST_CASE("on a free mesh every edge and face can be split, and welds undo it") {
  for (const Triangles& base : bases()) {
    MeshBox box(limits(200, 400));
    Mesh& mesh = box.mesh;
    REQUIRE(mesh.set_triangles(base.uv_span(), base.corner_span()) == Status::ok);
    CHECK(!mesh.is_restricted());
    CHECK(mesh.refine(0) == Status::not_ready);
    for (const FaceId f : faces_of(mesh)) {
      mesh.clear_changes();
      const auto before = box.block.copy();
      VertexId m = kNone;
      REQUIRE(mesh.split_face(f, m) == Status::ok);
      CHECK(mesh.find_valence(m) == 3);
      CHECK_VALID(mesh);
      CHECK(mesh.weld_edge(m) == Status::not_ready);
      REQUIRE(mesh.weld_face(m) == Status::ok);
      mesh.clear_changes();
      CHECK(box.block.copy() == before);
      for (int k = 0; k < 3; ++k) {
        const auto faces = mesh.face_count();
        REQUIRE(mesh.split_edge(Mesh::half_edge(f, k), m) == Status::ok);
        CHECK_VALID(mesh);
        CHECK(mesh.weld_face(m) == Status::not_ready);
        REQUIRE(mesh.weld_edge(m) == Status::ok);
        CHECK(mesh.face_count() == faces);
        CHECK_VALID(mesh);
      }
    }
  }
}

TEST_CASE("the face operators are refused on a restricted mesh and out of capacity") {
  MeshBox box(limits(9, 8), shapes::block_grid(2));
  VertexId v = kNone;
  CHECK(box.mesh.split_face(0, v) == Status::not_ready);
  CHECK(box.mesh.weld_face(4) == Status::not_ready);
  CHECK(box.mesh.split_edge(0, v) == Status::capacity);
  const Triangles t = shapes::block_grid(2);
  REQUIRE(box.mesh.set_triangles(t.uv_span(), t.corner_span()) == Status::ok);
  CHECK(box.mesh.split_face(0, v) == Status::capacity);
  CHECK(v == kNone);
}

TEST_CASE("a random free mesh stays valid through all four operators") {
  Random random{77};
  MeshBox box(limits(200, 400));
  Mesh& mesh = box.mesh;
  const Triangles t = shapes::block_grid(3);
  REQUIRE(mesh.set_triangles(t.uv_span(), t.corner_span()) == Status::ok);
  int welded_faces = 0, welded_edges = 0;
  for (int i = 0; i < 5000; ++i) {
    VertexId v = kNone;
    switch (random.below(4)) {
      case 0:
        (void)mesh.split_edge(Mesh::half_edge(random_face(mesh, random), static_cast<int>(random.below(3))),
                              v);
        break;
      case 1:
        (void)mesh.split_face(random_face(mesh, random), v);
        break;
      case 2:
        welded_edges += mesh.weld_edge(random_vertex(mesh, random)) == Status::ok;
        break;
      default:
        welded_faces += mesh.weld_face(random_vertex(mesh, random)) == Status::ok;
        break;
    }
    const MeshFault fault = mesh.validate();
    if (fault.invariant == 9) break;  // random splits may end in slivers
    REQUIRE_MESSAGE(fault.invariant == 0, "invariant ", fault.invariant, " at ", fault.id, " step ", i);
  }
  CHECK(welded_edges > 20);
  CHECK(welded_faces > 20);
}

}  // namespace mesh_faults_test
