#pragma once
// Helpers of the mesh tests: checks of validity, refinement of all faces, several base meshes.
#include <doctest/doctest.h>

#include <vector>

#include "mesh_shapes.hpp"
#include "pliant/mesh.hpp"
#include "random.hpp"

#define CHECK_VALID(mesh)                                                                 \
  do {                                                                                    \
    const pliant::MeshFault fault = (mesh).validate();                                    \
    CHECK_MESSAGE(fault.invariant == 0, "invariant ", fault.invariant, " at ", fault.id); \
  } while (false)

inline std::vector<pliant::FaceId> faces_of(const pliant::Mesh& mesh) {
  std::vector<pliant::FaceId> all;
  for (const pliant::FaceId f : mesh.faces()) all.push_back(f);
  return all;
}

inline void refine_all(pliant::Mesh& mesh, int levels) {
  for (int level = 0; level < levels; ++level)
    for (const pliant::FaceId f : faces_of(mesh))
      if (mesh.face_level(f) == level) REQUIRE(mesh.refine(f) == pliant::Status::ok);
}

inline std::vector<shapes::Triangles> bases() {
  Random random{7};
  return {shapes::block_grid(1),
          shapes::block_grid(4),
          shapes::block_grid(5, &random),
          shapes::fan(1 + 2),
          shapes::fan(9),
          shapes::torus(4),
          shapes::grid_with_holes(5, [](int i, int j) { return i % 2 == 1 && j % 2 == 1; }),
          shapes::grid_with_holes(5, [](int i, int) { return i == 2; })};
}

// Ids are dense, so this is close to uniform.
inline pliant::FaceId random_face(const pliant::Mesh& mesh, Random& random) {
  return static_cast<pliant::FaceId>(mesh.faces().next_used(random.below(mesh.faces().used_count())));
}

inline pliant::VertexId random_vertex(const pliant::Mesh& mesh, Random& random) {
  return static_cast<pliant::VertexId>(mesh.vertices().next_used(random.below(mesh.vertices().used_count())));
}
