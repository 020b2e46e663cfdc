#pragma once
/// \file subdivision.hpp
/// Catmull-Clark subdivision of a cage as weights: every vertex of the fine mesh is a weighted sum of cage
/// points, so that positions, (u,v) and deformations are all made smooth by the same few thousand sums.
#include <array>
#include <map>
#include <utility>
#include <vector>

#include "host/bake/cage.hpp"

namespace pliant::host::bake {

/// Cage points and their weights, in ascending order; the weights add up to one.
using Stencil = std::vector<std::pair<int, float>>;

struct SubdividedCage {
  std::vector<Stencil> stencils;          ///< a fine vertex; the first are the cage's own points
  std::vector<std::array<int, 4>> quads;  ///< fine vertices, wound like the cage
  std::vector<int> cage_face;             ///< a quad: the face of the cage that it is part of
  /// The fine vertices between the ends of a cage edge, ends included, from the lower point to the higher.
  std::map<std::pair<int, int>, std::vector<int>> edges;
};

/// `levels` rounds (Catmull and Clark 1978). Edges of the boundary and between skin and hole are sharp: they
/// become cubic B-splines of their own points.
SubdividedCage subdivide(const Cage& cage, int levels);

/// Control values for which the surface passes through `targets` at the cage points, to the accuracy of
/// `rounds` of residual correction. Points with `is_still` keep their target, so that what does not move
/// stays exactly where it is; empty: none. T is float or Vec3.
template <class T>
std::vector<T> controls_through(const SubdividedCage& fine, const std::vector<T>& targets, int rounds,
                                const std::vector<char>& is_still = {});

/// Fine vertices along the surface through cage points, straight where no edge of the cage joins two of them.
std::vector<int> path_through(const SubdividedCage& fine, const std::vector<int>& points);

/// The values at all fine vertices.
template <class T>
std::vector<T> fine_values(const SubdividedCage& fine, const std::vector<T>& controls);

}  // namespace pliant::host::bake
