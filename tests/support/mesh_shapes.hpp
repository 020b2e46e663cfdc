#pragma once
// Small meshes for tests, built by rule and seed.
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "aligned_block.hpp"
#include "pliant/mesh.hpp"
#include "random.hpp"

namespace shapes {

using pliant::Vec2;

struct Triangles {
  std::vector<Vec2> uv;
  std::vector<std::uint16_t> corners;

  std::size_t face_count() const { return corners.size() / 3; }
  pliant::Span<const Vec2> uv_span() const { return {uv.data(), uv.size()}; }
  pliant::Span<const std::uint16_t> corner_span() const { return {corners.data(), corners.size()}; }
  void add(int a, int b, int c) {
    for (const int v : {a, b, c}) corners.push_back(static_cast<std::uint16_t>(v));
  }
};

/// n x n squares on [0,1]^2, each a basic block. Diagonals alternate, or fall at random with a `random`,
/// which also shakes the inner vertices.
inline Triangles block_grid(int n, Random* random = nullptr) {
  Triangles t;
  const float cell = 1.0f / static_cast<float>(n);
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      Vec2 p{static_cast<float>(i) * cell, static_cast<float>(j) * cell};
      if (random != nullptr && i > 0 && i < n && j > 0 && j < n)
        p = p + 0.3f * cell * Vec2{random->uniform(-0.5f, 0.5f), random->uniform(-0.5f, 0.5f)};
      t.uv.push_back(p);
    }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i, b = a + 1, d = a + n + 1, c = d + 1;
      if (random != nullptr ? random->below(2) == 0 : (i + j) % 2 == 0) {
        t.add(c, a, b);
        t.add(a, c, d);
      } else {
        t.add(d, b, c);
        t.add(b, d, a);
      }
    }
  return t;
}

/// The same without the squares for which `hole(i, j)`; vertices that nobody uses are dropped.
template <class Hole>
Triangles grid_with_holes(int n, Hole hole) {
  const Triangles full = block_grid(n);
  Triangles t;
  std::vector<int> map(full.uv.size(), -1);
  for (std::size_t f = 0; f < full.face_count(); ++f) {
    const int cell = static_cast<int>(f / 2);
    if (hole(cell % n, cell / n)) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t v = full.corners[3 * f + k];
      if (map[v] < 0) {
        map[v] = static_cast<int>(t.uv.size());
        t.uv.push_back(full.uv[v]);
      }
      t.corners.push_back(static_cast<std::uint16_t>(map[v]));
    }
  }
  return t;
}

/// Half blocks only: n triangles around a centre, subdivision edges on the boundary.
inline Triangles fan(int n) {
  Triangles t;
  t.uv.push_back({0.5f, 0.5f});
  for (int i = 0; i < n; ++i) {  // points of a square's outline, counter-clockwise
    const float s = 4.0f * static_cast<float>(i) / static_cast<float>(n);
    const int side = static_cast<int>(s);
    const float r = s - static_cast<float>(side);
    const Vec2 corner[4] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, along[4] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    t.uv.push_back(corner[side] + r * along[side]);
  }
  for (int i = 0; i < n; ++i) t.add(1 + i, 1 + (i + 1) % n, 0);
  return t;
}

/// A closed torus of n x n blocks. Its (u,v) wraps, so that some faces are folded; the topology is what
/// matters.
inline Triangles torus(int n) {
  Triangles t;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      t.uv.push_back(
          {static_cast<float>(i) / static_cast<float>(n), static_cast<float>(j) / static_cast<float>(n)});
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = j * n + i, b = j * n + (i + 1) % n, d = (j + 1) % n * n + i,
                c = (j + 1) % n * n + (i + 1) % n;
      t.add(c, a, b);
      t.add(a, c, d);
    }
  return t;
}

/// Another order of the faces and of the vertices; the blocks stay what they were.
inline Triangles shuffled(const Triangles& t, Random& random) {
  std::vector<std::size_t> faces(t.face_count()), vertices(t.uv.size());
  for (std::size_t i = 0; i < faces.size(); ++i) faces[i] = i;
  for (std::size_t i = 0; i < vertices.size(); ++i) vertices[i] = i;
  for (std::size_t i = faces.size(); i > 1; --i) std::swap(faces[i - 1], faces[random.below(i)]);
  for (std::size_t i = vertices.size(); i > 1; --i) std::swap(vertices[i - 1], vertices[random.below(i)]);
  Triangles s;
  s.uv.resize(t.uv.size());
  for (std::size_t v = 0; v < t.uv.size(); ++v) s.uv[vertices[v]] = t.uv[v];
  for (const std::size_t f : faces)
    for (std::size_t k = 0; k < 3; ++k)
      s.corners.push_back(static_cast<std::uint16_t>(vertices[t.corners[3 * f + k]]));
  return s;
}

/// A mesh and the block it lives in.
struct MeshBox {
  explicit MeshBox(const pliant::MeshLimits& limits)
      : block(pliant::measured_bytes<pliant::Mesh>(limits)), arena(block.data(), block.size()) {
    status = pliant::create_in(arena, mesh, limits);
  }
  MeshBox(const pliant::MeshLimits& limits, const Triangles& t) : MeshBox(limits) {
    if (status == pliant::Status::ok) status = mesh.set_base(t.uv_span(), t.corner_span());
  }
  AlignedBlock block;
  pliant::Arena arena;
  pliant::Mesh mesh;
  pliant::Status status;
};

inline pliant::MeshLimits limits(int vertices, int faces, int max_level = 12) {
  return {static_cast<std::uint16_t>(vertices), static_cast<std::uint16_t>(faces),
          static_cast<std::uint8_t>(max_level)};
}

/// What the mesh is, whatever the ids: every face's corners as (u,v), in order, sorted.
using Face = std::array<float, 6>;
inline std::vector<Face> sorted_faces(const pliant::Mesh& mesh) {
  std::vector<Face> all;
  for (const pliant::FaceId f : mesh.faces()) {
    Face face;
    for (int k = 0; k < 3; ++k) {
      const Vec2 p = mesh.uv(mesh.corner(f, k));
      face[static_cast<std::size_t>(2 * k)] = p.x;
      face[static_cast<std::size_t>(2 * k + 1)] = p.y;
    }
    all.push_back(face);
  }
  std::sort(all.begin(), all.end());
  return all;
}

}  // namespace shapes
