#pragma once
/// \file cage.hpp
/// The control cage of a symmetric surface: named points joined to quads, from which subdivision makes the
/// smooth surface. A table gives the left half and the middle; the right half is its mirror image and has "-"
/// before its names.
#include <array>
#include <string>
#include <unordered_map>
#include <vector>

#include "pliant/geometry.hpp"

namespace pliant::host::bake {

struct CageFace {
  std::vector<int> corners;  ///< counter-clockwise seen from outside; three or four
  bool is_hole;              ///< belongs to what closes an eye or the mouth, not to the skin
  std::string patch;         ///< its name in patches.txt
};

struct Cage {
  std::vector<std::string> names;
  std::vector<Vec3> position;  ///< where the surface shall pass, millimetres
  std::vector<Vec2> uv;
  std::vector<CageFace> faces;
  std::vector<int> mirror;  ///< the other side's point; itself in the middle
  std::unordered_map<std::string, int> index;

  std::size_t size() const { return names.size(); }
  bool is_left(int point) const { return names[static_cast<std::size_t>(point)][0] != '-'; }
};

/// The points that words with commas between them stand for: "name", "-name", or "stem.3-7" and "stem.7-3", from the first
/// to the last. Throws std::invalid_argument naming a point that does not exist.
std::vector<int> points_of(const Cage& cage, const std::string& words);

/// Reads `folder`/points.txt and patches.txt, mirrors and winds the faces. Throws SourceError.
Cage read_cage(const std::string& folder);

}  // namespace pliant::host::bake
