#pragma once
/// \file cage.hpp
/// The control cage of a symmetric surface: named points and the quads between them. Subdivision makes the smooth surface of
/// it. The tables give the left half and the middle. The right half is the mirror image; its names start with "-".
#include <string>
#include <unordered_map>
#include <vector>

#include "pliant/geometry.hpp"

namespace pliant::host::bake {

struct CageFace {
  std::vector<int> corners;  ///< counter-clockwise seen from outside; three or four
  bool is_hole;              ///< fills an opening (an eye, the mouth) and is no part of the surface
  std::string patch;         ///< its name in patches.txt
};

struct Cage {
  std::vector<std::string> names;
  std::vector<Vec3> position;  ///< a point that the surface passes through, millimetres
  std::vector<Vec2> uv;
  std::vector<CageFace> faces;
  std::vector<int> mirror;  ///< index of the mirrored point; its own in the middle
  std::unordered_map<std::string, int> index;

  std::size_t size() const { return names.size(); }
  bool is_left(int point) const { return names[static_cast<std::size_t>(point)][0] != '-'; }
};

/// Parses a comma-separated list of points: "name", "-name", or a range "stem.3-7" or "stem.7-3", in that order. Throws
/// std::invalid_argument that names a point that does not exist.
std::vector<int> points_of(const Cage& cage, const std::string& words);

/// Reads points.txt and patches.txt of a folder, adds the mirrored half and winds all faces alike. Throws SourceError.
Cage read_cage(const std::string& folder);

}  // namespace pliant::host::bake
