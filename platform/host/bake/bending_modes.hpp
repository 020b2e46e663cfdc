#pragma once
/// \file bending_modes.hpp
/// The ways in which a thin surface bends most easily, computed from its mesh.
#include <array>
#include <vector>

#include "pliant/geometry.hpp"

namespace pliant::host::bake {

struct BendingMesh {
  std::vector<Vec3>
      position;  ///< one a vertex; vertices at one place, along a cut of the chart, are one vertex here
  std::vector<std::array<int, 3>> triangles;
  std::vector<char> is_fixed;  ///< one a vertex: it does not move
};

/// A corrective shape: the displacements of the vertices when both modes are at one standard deviation.
struct ModeCorrection {
  std::size_t first, second;  ///< modes; first <= second
  std::vector<Vec3> displacement;
};

struct BendingModes {
  /// Displacements of the vertices at one standard deviation, in the unit of the positions.
  std::vector<std::vector<Vec3>> displacement;
  std::vector<double> eigenvalue;  ///< ascending, for a surface of diagonal 1
  /// With them the surface keeps its lengths to the second order where it can. Small ones are left out.
  std::vector<ModeCorrection> corrections;
};

/// Largest number of vertices. Bounds memory and time.
constexpr std::size_t kMostModeVertices = 20000;

/// The `count` lowest eigenvectors of the energy of bending and stretching of a thin plate (docs/algorithms.md, section 3.8).
/// The plate is 0.3 % of its diagonal thick, so that the lowest modes bend and hardly stretch. Motions as a rigid body are
/// left out. Each mode has the same energy at one standard deviation.
/// \param stiffness  with 1 the first mode moves the vertices by 5 % of the diagonal, root mean square, at one standard
///                   deviation; with 4 by half of it.
/// \return fewer modes if the surface has fewer; none if there are more vertices than kMostModeVertices.
/// Throws std::runtime_error if the numbers do not allow it, as those of a vertex that is not finite.
BendingModes find_bending_modes(const BendingMesh& mesh, int count, float stiffness);

}  // namespace pliant::host::bake
