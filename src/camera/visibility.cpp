#include "pliant/visibility.hpp"

#include "base/extent.hpp"

namespace pliant {

namespace {

constexpr float kFar = 1e30f;

/// The cells [*first, *end) of `count` along one axis whose centres lie between three corners. A small triangle may have none.
inline void find_cells(float a, float b, float c, int count, int* first, int* end) {
  const auto first_from = [count](float value) {  // 0 for NaN, too
    return static_cast<int>(min(max(0, value + 0.5f), static_cast<float>(count)));
  };
  *first = first_from(min(a, min(b, c)));
  *end = first_from(max(a, max(b, c)));
}

}  // namespace

bool faces_camera(const Mesh& mesh, const Vec2* image, FaceId f) {
  const VertexId a = mesh.corner(f, 0), b = mesh.corner(f, 1), c = mesh.corner(f, 2);
  const float in_image = doubled_area(image[a], image[b], image[c]);
  return in_image * doubled_area(mesh.uv(a), mesh.uv(b), mesh.uv(c)) > 0;
}

void DepthBuffer::lay_out(Arena& arena, int cells_across, int cells_down) {
  depth_ = arena.take<float>(static_cast<std::size_t>(cells_across) * static_cast<std::size_t>(cells_down));
  across_ = cells_across;
  down_ = cells_down;
  cells_per_px_ = 0;
}

void DepthBuffer::draw(const Mesh& mesh, const Vec2* image, const float* depth) {
  Extent seen;
  for (VertexId v : mesh.vertices())
    if (depth[v] > 0) seen.include(image[v]);
  for (int i = 0; i < across_ * down_; ++i) depth_[i] = kFar;
  const float width = max(seen.high.x - seen.low.x, 1), height = max(seen.high.y - seen.low.y, 1);
  origin_ = seen.low;
  cells_per_px_ = min(static_cast<float>(across_) / width, static_cast<float>(down_) / height);
  const Vec2 from = origin_;
  const float scale = cells_per_px_;
  const int across = across_, down = down_;
  for (FaceId f : mesh.faces()) {
    const VertexId a = mesh.corner(f, 0), b = mesh.corner(f, 1), c = mesh.corner(f, 2);
    const float z[3] = {depth[a], depth[b], depth[c]};
    if (!(z[0] > 0 && z[1] > 0 && z[2] > 0))
      continue;  // the image of a vertex behind the camera may be anything
    const Vec2 x[3] = {scale * (image[a] - from), scale * (image[b] - from), scale * (image[c] - from)};
    Cells cells;
    find_cells(x[0].x, x[1].x, x[2].x, across, &cells.i0, &cells.i1);
    if (cells.i0 >= cells.i1) continue;
    find_cells(x[0].y, x[1].y, x[2].y, down, &cells.j0, &cells.j1);
    if (cells.j0 < cells.j1 && faces_camera(mesh, image, f)) draw_face(x, z, cells);
  }
}

void DepthBuffer::draw_face(const Vec2 (&x)[3], const float (&z)[3], const Cells& cells) {
  const float area = doubled_area(x[0], x[1], x[2]);
  if (magnitude(area) < 1e-6f) return;
  // Barycentric coordinates are linear in the image.
  const float inverse = 1.0f / area;
  const Vec2 middle{static_cast<float>(cells.i0) + 0.5f, static_cast<float>(cells.j0) + 0.5f};
  const Vec2 a_step = inverse * Vec2{x[1].y - x[2].y, x[2].x - x[1].x},
             b_step = inverse * Vec2{x[2].y - x[0].y, x[0].x - x[2].x};
  float a_row = doubled_area(middle, x[1], x[2]) * inverse,
        b_row = doubled_area(x[0], middle, x[2]) * inverse;
  const float to_a = z[0] - z[2], to_b = z[1] - z[2];
  for (int j = cells.j0; j < cells.j1; ++j, a_row += a_step.y, b_row += b_step.y) {
    float a = a_row, b = b_row;
    for (float *cell = depth_ + j * across_ + cells.i0, *end = cell + (cells.i1 - cells.i0); cell < end;
         ++cell) {
      if (a >= 0 && b >= 0 && a + b <= 1) *cell = min(*cell, z[2] + a * to_a + b * to_b);
      a += a_step.x;
      b += b_step.x;
    }
  }
}

bool DepthBuffer::hides(Vec2 x, float depth, float margin) const {
  const Vec2 at = cells_per_px_ * (x - origin_);
  if (!(at.x >= 0 && at.y >= 0 && at.x < static_cast<float>(across_) && at.y < static_cast<float>(down_)))
    return false;
  return depth_[static_cast<int>(at.y) * across_ + static_cast<int>(at.x)] < depth - margin;
}

float nearest_on_triangle(Vec2 a, Vec2 b, Vec2 c, Vec2 x, float (&weight)[3]) {
  const float area = doubled_area(a, b, c);
  if (magnitude(area) > 1e-12f) {
    const float wa = doubled_area(x, b, c) / area, wb = doubled_area(a, x, c) / area, wc = 1 - wa - wb;
    if (wa >= 0 && wb >= 0 && wc >= 0) {
      weight[0] = wa;
      weight[1] = wb;
      weight[2] = wc;
      return 0;
    }
  }
  const Vec2 corner[3] = {a, b, c};
  float best = 0;
  for (int k = 0; k < 3; ++k) {
    const int n = k == 2 ? 0 : k + 1;
    const Vec2 edge = corner[n] - corner[k];
    const float square = dot(edge, edge);
    const float t = square > 0 ? clamp(dot(x - corner[k], edge) / square, 0, 1) : 0.0f;
    const Vec2 off = x - corner[k] - t * edge;
    if (k > 0 && dot(off, off) >= best) continue;
    best = dot(off, off);
    weight[k] = 1 - t;
    weight[n] = t;
    weight[3 - k - n] = 0;
  }
  return best;
}

}  // namespace pliant
