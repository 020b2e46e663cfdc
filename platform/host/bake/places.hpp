#pragma once
/// \file places.hpp
/// Vertices at one place, as along a cut of the chart.
#include <vector>

#include "pliant/geometry.hpp"

namespace pliant::host::bake {

/// The place of each vertex: one number for all vertices that are there, from 0, in the order in which the places appear. A vertex
/// is at the first place whose first vertex is at most 1e-5 of the diagonal of all positions away: the two sides of a cut may
/// differ by rounding. Cost: O(n log n).
std::vector<int> places_of(const std::vector<Vec3>& position);

}  // namespace pliant::host::bake
