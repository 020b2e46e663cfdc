#pragma once
/// \file visibility.hpp
/// Self-occlusion of a posed mesh by a coarse depth buffer (docs/algorithms.md, section 7.8).
#include "pliant/arena.hpp"
#include "pliant/geometry.hpp"
#include "pliant/mesh.hpp"

namespace pliant {

/// Tuning of visibility.
struct VisibilityTuning {
  /// mm. A point is hidden if the surface in its cell is nearer to the camera by more than this. It must be
  /// larger than the depth range of a face within one cell, and smaller than the height of a nose. Round
  /// value, not tuned.
  float hidden_margin_mm = 6;
};
inline constexpr VisibilityTuning kVisibilityTuning{};  ///< the values in use

/// Least depth over a coarse grid of cells that covers the projected mesh. Bytes: 4 a cell.
class DepthBuffer {
 public:
  /// Takes cells_across x cells_down cells, 4 bytes each, from the arena.
  void lay_out(Arena& arena, int cells_across, int cells_down);

  /// Draws all faces that turn to the camera. Cost: the cells under each face.
  /// \param image  px, by vertex id.
  /// \param depth  mm along the optical axis, by vertex id; 0 or less for a vertex that is not in front of the camera.
  void draw(const Mesh& mesh, const Vec2* image, const float* depth);

  /// Moves the drawing by `offset` px.
  void move(Vec2 offset) { origin_ = origin_ + offset; }
  /// True if the depth drawn at x (px) is less than depth - margin (mm). False outside the grid.
  bool hides(Vec2 x, float depth, float margin) const;
  /// Side of a cell in the image of the last drawing, px; 0 before.
  float cell_px() const { return cells_per_px_ > 0 ? 1.0f / cells_per_px_ : 0.0f; }

 private:
  struct Cells {
    int i0, i1, j0, j1;  // [i0, i1) x [j0, j1)
  };
  void draw_face(const Vec2 (&x)[3], const float (&z)[3], const Cells& cells);

  float* depth_ = nullptr;
  int across_ = 0, down_ = 0;
  Vec2 origin_;
  float cells_per_px_ = 0;
};

/// True if the face turns its outer side to the camera: its orientation in the image is that in the chart.
/// Seen from outside, v points down where u points right (model.hpp).
/// \param image  px, by vertex id.
bool faces_camera(const Mesh& mesh, const Vec2* image, FaceId face);

/// Finds the point of triangle (a,b,c) nearest to x and writes its barycentric coordinates. A degenerate
/// triangle gives a point on one of its edges.
/// \return the squared distance.
float nearest_on_triangle(Vec2 a, Vec2 b, Vec2 c, Vec2 x, float (&weight)[3]);

}  // namespace pliant
