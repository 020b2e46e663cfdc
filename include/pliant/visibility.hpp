#pragma once
/// \file visibility.hpp
/// What the camera sees of a mesh: self-occlusion by a coarse depth buffer (ALGORITHMS: section 7.8).
#include <cstddef>

#include "pliant/arena.hpp"
#include "pliant/geometry.hpp"
#include "pliant/mesh.hpp"

namespace pliant {

/// Nearest depth over a coarse grid of cells that covers the projected mesh. Bytes: 4 a cell.
class DepthBuffer {
 public:
  void lay_out(Arena& arena, int cells_across, int cells_down);

  /// Draws all faces that turn to the camera. `image` (px) and `depth` (mm along the optical axis; 0 or less for a vertex
  /// that is not in front of the camera) are indexed by vertex id. Cost: the cells under each face.
  void draw(const Mesh& mesh, const Vec2* image, const float* depth);

  /// What was drawn is now to be found that much (px) further on.
  void move(Vec2 way) { origin_ = origin_ + way; }
  /// True where something drawn at x lies nearer than depth - margin. False outside the grid.
  bool hides(Vec2 x, float depth, float margin) const;
  /// Side of a cell in the image as last drawn, px; 0 before.
  float cell_px() const { return cells_per_px_ > 0 ? 1.0f / cells_per_px_ : 0.0f; }

 private:
  struct Cells {
    int i0, i1, j0, j1;  // [i0, i1) x [j0, j1)
  };
  Cells cells_under(const Vec2 (&x)[3]) const;
  void draw_face(const Vec2 (&x)[3], const float (&z)[3], const Cells& cells);

  float* depth_ = nullptr;
  int across_ = 0, down_ = 0;
  Vec2 origin_;
  float cells_per_px_ = 0;
};

/// Twice the signed area of a triangle; with y (or v) down, positive is clockwise as one sees it.
constexpr float doubled_area(Vec2 a, Vec2 b, Vec2 c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// True where the face turns its outer side to the camera: the chart's u and v then run the same way round in the image
/// (model.hpp: seen from outside, v points down where u points right).
bool faces_camera(const Mesh& mesh, const Vec2* image, FaceId face);

/// The point of triangle (a,b,c) nearest to x, by its barycentric coordinates. Degenerate triangles give a corner or edge.
/// \return the squared distance.
float nearest_on_triangle(Vec2 a, Vec2 b, Vec2 c, Vec2 x, float (&weight)[3]);

}  // namespace pliant
