#include "host/bake/surface_modes.hpp"

#include <stdexcept>

#include "host/bake/at.hpp"
#include "host/bake/places.hpp"
#include "host/bake/source_error.hpp"

namespace pliant::host::bake {

namespace {

/// The surface with one vertex for each place. `place_of` becomes the place of each vertex.
BendingMesh joined(const Source& source, const std::vector<char>& is_fixed, std::vector<int>& place_of) {
  BendingMesh mesh;
  place_of = places_of(source.neutral);
  for (std::size_t v = 0; v < place_of.size(); ++v)
    if (at(place_of[v]) == mesh.position.size()) mesh.position.push_back(source.neutral[v]);
  mesh.is_fixed.assign(mesh.position.size(), 0);
  for (std::size_t v = 0; v < is_fixed.size(); ++v)
    if (is_fixed[v]) mesh.is_fixed[at(place_of[v])] = 1;
  for (std::array<int, 3> t : source.triangles) {
    for (int& v : t) v = place_of[at(v)];
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0])
      mesh.triangles.push_back(t);  // else it is an edge or a point
  }
  return mesh;
}

}  // namespace

BendingModes surface_modes(const Source& source, const std::vector<char>& is_fixed, int count,
                           float stiffness, const std::string& file) {
  std::vector<int> place_of;
  const BendingMesh mesh = joined(source, is_fixed, place_of);
  if (mesh.position.size() > kMostModeVertices)
    throw SourceError(file, 0,
                      "has " + std::to_string(mesh.position.size()) + " vertices, more than " +
                          std::to_string(kMostModeVertices) + ", for --modes: reduce the mesh");
  BendingModes modes;
  try {
    modes = find_bending_modes(mesh, count, stiffness);
  } catch (const std::runtime_error& error) {
    throw SourceError(file, 0, std::string("has no bending modes: ") + error.what());
  }
  if (modes.displacement.size() < at(count))
    throw SourceError(file, 0,
                      "has only " + std::to_string(modes.displacement.size()) + " bending modes, not " +
                          std::to_string(count));
  const auto spread = [&place_of](std::vector<Vec3>& displacement) {
    std::vector<Vec3> of_vertices;
    for (const int place : place_of) of_vertices.push_back(displacement[at(place)]);
    displacement = std::move(of_vertices);
  };
  for (auto& displacement : modes.displacement) spread(displacement);
  for (ModeCorrection& c : modes.corrections) spread(c.displacement);
  return modes;
}

}  // namespace pliant::host::bake
