#pragma once
/// \file subdivision.hpp
/// Catmull-Clark subdivision of a cage as weights. Every vertex of the fine mesh is a weighted sum of cage points. The same
/// sums apply to positions, (u,v) and deformations.
#include <array>
#include <map>
#include <utility>
#include <vector>

#include "host/bake/cage.hpp"

namespace pliant::host::bake {

/// Cage points in ascending order and their weights, which add up to one.
using Stencil = std::vector<std::pair<int, float>>;

struct SubdividedCage {
  std::vector<Stencil> stencils;          ///< one a fine vertex; the first ones belong to the cage's points
  std::vector<std::array<int, 4>> quads;  ///< fine vertices, wound like the cage
  std::vector<int> cage_face;             ///< for each quad, the face of the cage that it is part of
  /// The fine vertices along each edge of the cage, both ends included, from the lower index to the higher.
  std::map<std::pair<int, int>, std::vector<int>> edges;
};

/// Subdivides a cage `levels` times (Catmull and Clark 1978). Edges on the boundary, and those between surface and hole, are
/// sharp: they become cubic B-splines of their own points (Hoppe et al. 1994).
SubdividedCage subdivide(const Cage& cage, int levels);

/// Computes control values with which the surface passes through `targets` at the cage points, by `rounds` of residual
/// correction. The control of a point with `is_still` remains its target, so that points without motion get exactly none.
/// `is_still` may be empty. T is float or Vec3.
template <class T>
std::vector<T> controls_through(const SubdividedCage& fine, const std::vector<T>& targets, int rounds,
                                const std::vector<char>& is_still = {});

/// Fine vertices along the surface through cage points. Between two points without a common edge there are none.
std::vector<int> path_through(const SubdividedCage& fine, const std::vector<int>& points);

/// Computes the values at all fine vertices.
template <class T>
std::vector<T> fine_values(const SubdividedCage& fine, const std::vector<T>& controls);

}  // namespace pliant::host::bake
