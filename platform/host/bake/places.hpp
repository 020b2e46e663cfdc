#pragma once
/// \file places.hpp
/// Vertices at one place, as along a cut of the chart.
#include <array>
#include <map>
#include <vector>

#include "pliant/geometry.hpp"

namespace pliant::host::bake {

/// The place of each vertex: one number for all vertices that are there, from 0, in the order in which the places appear.
inline std::vector<int> places_of(const std::vector<Vec3>& position) {
  std::vector<int> place_of;
  std::map<std::array<float, 3>, int> places;
  for (const Vec3 p : position)
    place_of.push_back(places.insert({{p.x, p.y, p.z}, static_cast<int>(places.size())}).first->second);
  return place_of;
}

}  // namespace pliant::host::bake
