#pragma once
/// \file segment_grid.hpp
/// Finds segments in the chart that touch or cross.
#include <optional>
#include <utility>
#include <vector>

#include "pliant/geometry.hpp"

namespace pliant::host::bake {

/// A segment from a to b. Two segments that have an end of one number are neighbours.
struct Segment {
  Vec2 a, b;
  int first, last;
};

/// Positive where p lies to the left of the line from a to b, u to the right and v upwards.
double side_of(Vec2 a, Vec2 b, Vec2 p);

/// True if two segments have a point in common, ends included.
bool touch(const Segment& s, const Segment& t);

/// True if two segments from their common end go the same way, so that one covers the other.
bool covers_neighbour(const Segment& s, const Segment& t);

/// Segments in the cells of a grid over their bounding box.
class SegmentGrid {
 public:
  explicit SegmentGrid(const std::vector<Segment>& segments);
  /// Two segments that touch or cross without being neighbours, or neighbours of which one covers the other.
  std::optional<std::pair<std::size_t, std::size_t>> find_crossing() const;
  /// For each segment: whether find_crossing could have named it.
  std::vector<char> crossing_segments() const;

 private:
  template <class Visit>
  void each_pair(Visit visit) const;

  const std::vector<Segment>& segments_;
  std::vector<std::vector<std::size_t>> cells_;
};

}  // namespace pliant::host::bake
