#pragma once
/// \file loop_points.hpp
/// Points of a base mesh along the boundary of a surface.
#include <functional>
#include <vector>

#include "host/bake/source.hpp"
#include "host/bake/surface_boundary.hpp"

namespace pliant::host::bake {

/// Wanted length of the edges at a place, millimetres.
using WantedLength = std::function<float(Vec3)>;

class LoopPoints {
 public:
  LoopPoints(const Source& source, const SurfaceBoundary& boundary);

  /// Points along each loop, in the loop's direction, at the wanted distance from each other. Where the polygons through them
  /// would touch or cross, more vertices of the loop are taken, in the worst case all.
  /// Points are kept where the kind of the boundary changes, next to landmarks, and, if the source has no landmarks, at
  /// corners of the boundary.
  /// \param most  points in all, count; with more the result is empty.
  std::vector<std::vector<Vec2>> place(const WantedLength& wanted, std::size_t most) const;

 private:
  /// A place on a loop: between vertex `k` and the next.
  struct Place {
    std::size_t k;
    float fraction;
  };
  using Places = std::vector<Place>;

  std::vector<char> fixed_anchors(const BoundaryLoop& loop) const;
  void add_corners(const BoundaryLoop& loop, const WantedLength& wanted, std::vector<char>& is_anchor) const;
  bool place_loop(std::size_t loop, const WantedLength& wanted, std::size_t most, Places& placed) const;
  bool place_run(const BoundaryLoop& loop, std::size_t start, std::size_t end, const WantedLength& wanted,
                 std::size_t most, Places& placed) const;
  bool is_nested(const std::vector<Places>& places) const;
  bool refine_crossings(std::vector<Places>& places) const;
  Vec2 uv_of(const BoundaryLoop& loop, Place place) const;
  Vec3 position(const BoundaryLoop& loop, std::size_t k) const;

  const Source& source_;
  const SurfaceBoundary& boundary_;
  std::vector<std::vector<char>> anchors_;  // of each loop
};

}  // namespace pliant::host::bake
