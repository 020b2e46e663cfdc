#include "pliant/base_mesh.hpp"

#include <doctest/doctest.h>

#include <fstream>
#include <initializer_list>
#include <sstream>
#include <string>

#include "aligned_block.hpp"
#include "mesh_shapes.hpp"
#include "random.hpp"
#include "real_data.hpp"

namespace base_mesh_test {

using namespace pliant;
using shapes::limits;
using shapes::MeshBox;
using shapes::Triangles;

namespace {

BaseMeshLimits maker_limits(const Triangles& t, bool splits = true) {
  return {static_cast<std::uint16_t>(t.uv.size()), static_cast<std::uint16_t>(t.face_count()), splits};
}

struct Maker {
  explicit Maker(const BaseMeshLimits& l)
      : block(measured_bytes<BaseMeshMaker>(l)), arena(block.data(), block.size()) {
    REQUIRE(create_in(arena, maker, l) == Status::ok);
  }
  AlignedBlock block;
  Arena arena;
  BaseMeshMaker maker;
};

// Irregular triangles: a grid after random splits of edges and faces.
Triangles irregular(int n, int operations, std::uint64_t seed) {
  Random random{seed};
  const Triangles grid = shapes::block_grid(n, &random);
  MeshBox box(limits(static_cast<int>(grid.uv.size()) + operations,
                     static_cast<int>(grid.face_count()) + 2 * operations));
  REQUIRE(box.mesh.set_triangles(grid.uv_span(), grid.corner_span()) == Status::ok);
  for (int i = 0; i < operations; ++i) {
    VertexId v = kNone;
    const auto f = static_cast<FaceId>(random.below(static_cast<std::size_t>(box.mesh.face_count())));
    if (random.below(2) == 0)
      REQUIRE(box.mesh.split_face(f, v) == Status::ok);
    else
      REQUIRE(box.mesh.split_edge(Mesh::half_edge(f, static_cast<int>(random.below(3))), v) == Status::ok);
  }
  Triangles t;
  for (const VertexId v : box.mesh.vertices()) t.uv.push_back(box.mesh.uv(v));
  for (const FaceId f : box.mesh.faces())
    t.add(box.mesh.corner(f, 0), box.mesh.corner(f, 1), box.mesh.corner(f, 2));
  return t;
}

// Any winding, any first corner, any order.
Triangles disordered(const Triangles& t, std::uint64_t seed) {
  Random random{seed};
  Triangles s = shapes::shuffled(t, random);
  for (std::size_t f = 0; f < s.face_count(); ++f) {
    const auto at = s.corners.begin() + static_cast<std::ptrdiff_t>(3 * f);
    std::rotate(at, at + static_cast<std::ptrdiff_t>(random.below(3)), at + 3);
    if (random.below(2) == 0) std::swap(at[1], at[2]);
  }
  return s;
}

std::vector<Triangles> inputs() {
  std::vector<Triangles> all = {
      shapes::block_grid(1),
      shapes::block_grid(4),
      shapes::fan(3),
      shapes::fan(7),
      shapes::torus(4),
      {{{0, 0}, {1, 0}, {0, 1}}, {0, 1, 2}},
      shapes::grid_with_holes(5, [](int i, int j) { return i % 2 == 1 && j % 2 == 1; }),
      shapes::grid_with_holes(5, [](int i, int) { return i == 2; })};
  for (std::uint64_t seed = 0; seed < 40; ++seed)
    all.push_back(irregular(1 + static_cast<int>(seed % 5), 3 * static_cast<int>(seed % 13), seed));
  return all;
}

// Two copies glued along the boundary: closed, and every face has three neighbours.
Triangles doubled(const Triangles& t) {
  MeshBox box(limits(static_cast<int>(t.uv.size()), static_cast<int>(t.face_count())));
  REQUIRE(box.mesh.set_triangles(t.uv_span(), t.corner_span()) == Status::ok);
  Triangles d = t;
  std::vector<int> other;
  for (const VertexId v : box.mesh.vertices()) {
    other.push_back(box.mesh.is_boundary_vertex(v) ? v : static_cast<int>(d.uv.size()));
    if (other.back() != v) d.uv.push_back(t.uv[v] + Vec2{1e-3f, 0});
  }
  for (std::size_t f = 0; f < t.face_count(); ++f) {
    const std::uint16_t* c = t.corners.data() + 3 * f;
    d.add(other[c[0]], other[c[2]], other[c[1]]);
  }
  return d;
}

float area(const Triangles& t) {
  float sum = 0;
  for (std::size_t f = 0; f < t.face_count(); ++f) {
    const Vec2 a = t.uv[t.corners[3 * f]], b = t.uv[t.corners[3 * f + 1]] - a,
               c = t.uv[t.corners[3 * f + 2]] - a;
    sum += magnitude(b.x * c.y - b.y * c.x) / 2;
  }
  return sum;
}

Triangles result_of(const BaseMeshMaker& maker) {
  Triangles t;
  t.uv.assign(maker.uv().begin(), maker.uv().end());
  t.corners.assign(maker.corners().begin(), maker.corners().end());
  return t;
}

int folded_after_refinement(const Triangles& base) {
  MeshBox box(limits(static_cast<int>(8 * base.uv.size()), static_cast<int>(5 * base.face_count())), base);
  REQUIRE(box.status == Status::ok);
  for (int i = 0; i < static_cast<int>(base.face_count()); ++i)
    REQUIRE(box.mesh.refine(static_cast<FaceId>(i)) == Status::ok);
  CHECK(box.mesh.validate().invariant == 0);
  return box.mesh.compute_statistics().folded_faces;
}

}  // namespace

TEST_CASE("any triangles become basic blocks by splits, with the vertices and faces that were promised") {
  std::uint64_t seed = 0;
  for (const Triangles& input : inputs()) {
    const Triangles t = disordered(input, ++seed);
    const bool closed = seed == 5;
    Maker m(maker_limits(t));
    REQUIRE(m.maker.by_splits(t.uv_span(), t.corner_span(), Winding::counter_clockwise) == Status::ok);
    const Triangles base = result_of(m.maker);
    MeshBox box(limits(static_cast<int>(base.uv.size()), static_cast<int>(base.face_count())), base);
    REQUIRE(box.status == Status::ok);
    CHECK(box.mesh.validate().invariant == 0);
    if (!closed) CHECK(folded_after_refinement(base) == 0);
    CHECK(area(base) == doctest::Approx(static_cast<double>(area(t))).epsilon(1e-4));

    const std::size_t added = base.uv.size() - t.uv.size();
    REQUIRE(m.maker.parents().count == added);
    std::size_t centres = 0;
    for (std::size_t i = 0; i < added; ++i) {
      const auto& p = m.maker.parents()[i];
      const Vec2 v = base.uv[t.uv.size() + i];
      Vec2 expected = 0.5f * (t.uv[p.v[0]] + t.uv[p.v[1]]);
      if (p.v[2] != kNone) {
        ++centres;
        expected = (1.0f / 3) * (t.uv[p.v[0]] + t.uv[p.v[1]] + t.uv[p.v[2]]);
      }
      CHECK(length(v - expected) < 1e-6f);
    }
    for (std::size_t v = 0; v < t.uv.size(); ++v) CHECK(length(base.uv[v] - t.uv[v]) == 0);
    CHECK(base.face_count() == 2 * t.face_count() + centres);
    CHECK(base.uv.size() <= t.uv.size() + t.face_count());
  }
}

TEST_CASE("any triangles become basic blocks by pairing, without one new vertex or face") {
  std::uint64_t seed = 100;
  for (const Triangles& input : inputs()) {
    const Triangles t = disordered(input, ++seed);
    Maker m(maker_limits(t, false));
    REQUIRE(m.maker.by_pairing(t.uv_span(), t.corner_span(), Winding::counter_clockwise) == Status::ok);
    const Triangles base = result_of(m.maker);
    CHECK(base.uv.size() == t.uv.size());
    REQUIRE(base.face_count() == t.face_count());
    for (std::size_t f = 0; f < t.face_count(); ++f) {
      auto a = std::array<int, 3>{base.corners[3 * f], base.corners[3 * f + 1], base.corners[3 * f + 2]};
      auto b = std::array<int, 3>{t.corners[3 * f], t.corners[3 * f + 1], t.corners[3 * f + 2]};
      std::sort(a.begin(), a.end());
      std::sort(b.begin(), b.end());
      CHECK(a == b);
    }
    MeshBox box(limits(static_cast<int>(base.uv.size()), static_cast<int>(base.face_count())), base);
    REQUIRE(box.status == Status::ok);
    CHECK(box.mesh.validate().invariant == 0);
    if (seed != 105) CHECK(folded_after_refinement(base) == 0);
    CHECK(m.maker.by_splits(t.uv_span(), t.corner_span(), Winding::as_given) == Status::bad_argument);
    CHECK((m.maker.uv().empty() && m.maker.corners().empty()));  // nor is the former result left
  }
}

TEST_CASE("pairing succeeds where it takes blossoms to get there") {
  // On these, search without contracting odd cycles fails.
  for (const std::uint64_t seed :
       std::initializer_list<std::uint64_t>{170, 266, 516, 645, 760, 776, 1002, 1016}) {
    const Triangles t = irregular(1 + static_cast<int>(seed % 4), 2 + static_cast<int>(seed % 60), seed);
    Maker m(maker_limits(t, false));
    CHECK(m.maker.by_pairing(t.uv_span(), t.corner_span(), Winding::as_given) == Status::ok);
  }
  for (const std::uint64_t seed : std::initializer_list<std::uint64_t>{32, 224, 348, 517, 760, 994, 1121}) {
    const Triangles t =
        doubled(irregular(1 + static_cast<int>(seed % 4), 2 + static_cast<int>(seed % 60), seed));
    Maker m(maker_limits(t, false));
    CHECK(m.maker.by_pairing(t.uv_span(), t.corner_span(), Winding::as_given) == Status::ok);
  }
}

TEST_CASE("double pyramids and a large irregular mesh are paired") {
  for (int n = 4; n < 40; ++n) {
    Triangles t;
    for (int i = 0; i < n; ++i) {
      const float s = static_cast<float>(i) / static_cast<float>(n);
      t.uv.push_back({s, s * (1 - s)});
    }
    t.uv.push_back({0.3f, 2});
    t.uv.push_back({0.6f, -3});
    for (int i = 0; i < n; ++i) {
      t.add(i, (i + 1) % n, n);
      t.add((i + 1) % n, i, n + 1);
    }
    Maker m(maker_limits(t, false));
    CHECK(m.maker.by_pairing(t.uv_span(), t.corner_span(), Winding::as_given) == Status::ok);
    CHECK(m.maker.corners().count == t.corners.size());
  }
  const Triangles big = disordered(irregular(20, 1500, 99), 7);
  Maker m(maker_limits(big, false));
  CHECK(m.maker.by_pairing(big.uv_span(), big.corner_span(), Winding::counter_clockwise) == Status::ok);
}

TEST_CASE("meshes whose faces were all split at the centre, three times over, are paired") {
  // After a face split every old face is a star of three, which greedy pairing leaves with many singles.
  for (const bool closed : {true, false}) {
    Triangles t = closed ? shapes::torus(5) : shapes::block_grid(5);
    for (int round = 0; round < 3; ++round) {
      Triangles next;
      next.uv = t.uv;
      for (std::size_t f = 0; f < t.face_count(); ++f) {
        const int a = t.corners[3 * f], b = t.corners[3 * f + 1], c = t.corners[3 * f + 2];
        const auto m = static_cast<int>(next.uv.size());
        const auto at = [&](int v) { return t.uv[static_cast<std::size_t>(v)]; };
        next.uv.push_back((1.0f / 3) * (at(a) + at(b) + at(c)) + Vec2{1e-3f * static_cast<float>(round), 0});
        next.add(a, b, m);
        next.add(b, c, m);
        next.add(c, a, m);
      }
      t = next;
      Maker m(maker_limits(t, false));
      CHECK(m.maker.by_pairing(t.uv_span(), t.corner_span(), Winding::as_given) == Status::ok);
    }
    CHECK(t.face_count() == 50 * 27);
  }
}

TEST_CASE("conversion by splits does not depend on the order of the input") {
  const Triangles t = irregular(4, 25, 3);
  std::vector<shapes::Face> first;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const Triangles s = disordered(t, seed);
    Maker m(maker_limits(s));
    REQUIRE(m.maker.by_splits(s.uv_span(), s.corner_span(), Winding::counter_clockwise) == Status::ok);
    const Triangles base = result_of(m.maker);
    MeshBox box(limits(static_cast<int>(base.uv.size()), static_cast<int>(base.face_count())), base);
    if (seed == 0) first = shapes::sorted_faces(box.mesh);
    CHECK(shapes::sorted_faces(box.mesh) == first);
  }
}

TEST_CASE("each part is wound as asked, whatever it was") {
  const Triangles t =
      disordered(shapes::grid_with_holes(5, [](int i, int) { return i == 2; }), 4);  // two parts
  Maker m(maker_limits(t));
  for (const Winding winding : {Winding::counter_clockwise, Winding::clockwise, Winding::as_given}) {
    REQUIRE(m.maker.by_pairing(t.uv_span(), t.corner_span(), winding) == Status::ok);
    const Triangles base = result_of(m.maker);
    int positive = 0;
    for (std::size_t f = 0; f < base.face_count(); ++f) {
      const Vec2 a = base.uv[base.corners[3 * f]], b = base.uv[base.corners[3 * f + 1]] - a,
                 c = base.uv[base.corners[3 * f + 2]] - a;
      positive += b.x * c.y - b.y * c.x > 0 ? 1 : 0;
    }
    if (winding == Winding::counter_clockwise) CHECK(positive == 40);
    if (winding == Winding::clockwise) CHECK(positive == 0);
    if (winding == Winding::as_given) CHECK(positive % 20 == 0);
  }
}

TEST_CASE("longest edges are taken in space where positions are given") {
  const Triangles t = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {0, 1, 2, 0, 2, 3}};
  const std::vector<Vec3> stretched = {
      {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 9, 0}};  // edge 2-3 is longer than the diagonal
  Maker m(maker_limits(t));
  REQUIRE(m.maker.by_splits(t.uv_span(), t.corner_span(), Winding::as_given, {stretched.data(), 4}) ==
          Status::ok);
  CHECK(m.maker.uv()[4].y == 0.5f);  // the midpoint of 0-3, 9 long
  CHECK(m.maker.uv()[4].x == 0);
  CHECK(m.maker.by_splits(t.uv_span(), t.corner_span(), Winding::as_given, {stretched.data(), 3}) ==
        Status::bad_argument);
  CHECK(m.maker.by_splits(t.uv_span(), t.corner_span(), Winding::as_given, {nullptr, 4}) ==
        Status::bad_argument);
  CHECK((m.maker.uv().empty() && m.maker.parents().empty()));
}

TEST_CASE("each defect of a base mesh is named") {
  const auto both = [](const Triangles& t, const BaseMeshLimits& l = {60, 60, true}) {
    Maker m(l);
    const Status a = m.maker.by_splits(t.uv_span(), t.corner_span(), Winding::counter_clockwise);
    if (a != Status::ok)
      CHECK((m.maker.uv().empty() && m.maker.corners().empty() && m.maker.parents().empty()));
    const Status b = m.maker.by_pairing(t.uv_span(), t.corner_span(), Winding::counter_clockwise);
    CHECK(a == b);
    return a;
  };
  const Triangles square = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {0, 1, 2, 0, 2, 3}};
  CHECK(both(square) == Status::ok);
  CHECK(both({}) == Status::bad_argument);
  Triangles t = square;
  t.corners.push_back(1);
  CHECK(both(t) == Status::bad_argument);
  t = square;
  t.uv[1].y = 1.0f / (t.uv[0].x * 0.0f);
  CHECK(both(t) == Status::bad_argument);
  t = square;
  t.corners[2] = 7;
  CHECK(both(t) == Status::bad_index);
  t = square;
  t.corners[2] = 1;
  CHECK(both(t) == Status::degenerate_face);
  t = square;  // a sliver
  t.uv[2] = {0.5f, 0};
  CHECK(both(t) == Status::degenerate_face);
  for (const std::array<int, 3> again : {std::array<int, 3>{0, 1, 2}, {1, 2, 0}, {2, 1, 0}}) {
    t = square;
    t.add(again[0], again[1], again[2]);
    CHECK(both(t) == Status::duplicate_face);
  }
  t = square;  // a book of three pages
  t.uv.push_back({0.2f, 0.7f});
  t.add(0, 2, 4);
  CHECK(both(t) == Status::non_manifold_edge);
  t = square;  // a bow-tie
  t.uv.insert(t.uv.end(), {{2, 1}, {2, 2}});
  t.add(2, 4, 5);
  CHECK(both(t) == Status::non_manifold_vertex);
  t = square;
  t.uv.push_back({3, 3});
  CHECK(both(t) == Status::isolated_vertex);
  for (int n = 5; n < 9; ++n) {  // Moebius strips of n triangles; for odd n the core turns once
    t = {};
    for (int i = 0; i < n; ++i) t.uv.push_back({static_cast<float>(i), static_cast<float>(i * i % 7)});
    for (int i = 0; i < n; ++i) t.add(i, (i + 1) % n, (i + 2) % n);
    CHECK(both(t) == (n % 2 == 1 ? Status::non_orientable : Status::ok));
  }
  CHECK(both(square, {3, 60, true}) == Status::capacity);
  CHECK(both(square, {60, 1, true}) == Status::capacity);
}

TEST_CASE("a triangle whose halves have no area in float is refused: what by_splits makes is a base mesh") {
  const float step = 0x1p-24f;  // of a float from 0.5 to 1
  const Vec2 at{0.75f, 0.75f};
  const Triangles narrow = {{at, at + Vec2{step, -5 * step}, at + Vec2{-2 * step, 4 * step}}, {0, 1, 2}};
  Maker m(maker_limits(narrow));
  CHECK(m.maker.by_splits(narrow.uv_span(), narrow.corner_span(), Winding::as_given) ==
        Status::degenerate_face);
  CHECK(m.maker.uv().empty());
  CHECK(m.maker.corners().empty());
  CHECK(m.maker.parents().empty());
  CHECK(m.maker.by_pairing(narrow.uv_span(), narrow.corner_span(), Winding::as_given) == Status::ok);
}

TEST_CASE("a maker fits what required bytes say") {
  for (const bool splits : {true, false}) {
    const BaseMeshLimits l{512, 1024, splits};
    const std::size_t bytes = measured_bytes<BaseMeshMaker>(l);
    MESSAGE("bytes a face: ", bytes / 1024);
    AlignedBlock block(bytes);
    Arena arena(block.data(), bytes - 16);
    BaseMeshMaker maker;
    CHECK(create_in(arena, maker, l) == Status::out_of_memory);
  }
}

TEST_CASE("the canonical face of 468 vertices converts both ways") {
  const char* data = require_data();
  if (data == nullptr) return;
  std::ifstream file(std::string(data) + "/mediapipe_face/canonical_face_model.obj");
  REQUIRE(file.good());
  Triangles t;
  std::vector<Vec3> position;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "v") {
      Vec3 p;
      words >> p.x >> p.y >> p.z;
      position.push_back(p);
    } else if (kind == "vt") {
      Vec2 p;
      words >> p.x >> p.y;
      t.uv.push_back(p);
    } else if (kind == "f") {
      int v[3];
      for (int& i : v) {
        std::string word;
        words >> word;
        i = std::stoi(word) - 1;
      }
      t.add(v[0], v[1], v[2]);
    }
  }
  REQUIRE(t.uv.size() == 468);
  REQUIRE(t.face_count() == 898);
  Maker m(maker_limits(t));
  REQUIRE(m.maker.by_pairing(t.uv_span(), t.corner_span(), Winding::as_given, {position.data(), 468}) ==
          Status::ok);
  CHECK(m.maker.uv().count == 468);
  CHECK(m.maker.corners().count == 3 * 898);
  CHECK(folded_after_refinement(result_of(m.maker)) == 0);
  REQUIRE(m.maker.by_splits(t.uv_span(), t.corner_span(), Winding::as_given, {position.data(), 468}) ==
          Status::ok);
  MESSAGE("by splits: ", m.maker.uv().count, " vertices, ", m.maker.corners().count / 3, " faces");
  CHECK(m.maker.corners().count / 3 >= 2 * 898);
  CHECK(folded_after_refinement(result_of(m.maker)) == 0);
}

}  // namespace base_mesh_test
