#include "pliant/visibility.hpp"

namespace pliant {

namespace {
constexpr float kFar = 1e30f;
}

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
  Vec2 low{kFar, kFar}, high{-kFar, -kFar};
  for (VertexId v : mesh.vertices()) {
    if (!(depth[v] > 0)) continue;
    low = {min(low.x, image[v].x), min(low.y, image[v].y)};
    high = {max(high.x, image[v].x), max(high.y, image[v].y)};
  }
  for (int i = 0; i < across_ * down_; ++i) depth_[i] = kFar;
  const float width = max(high.x - low.x, 1), height = max(high.y - low.y, 1);
  origin_ = low;
  cells_per_px_ = min(static_cast<float>(across_) / width, static_cast<float>(down_) / height);
  for (FaceId f : mesh.faces()) {
    Vec2 x[3];
    float z[3];
    bool in_front = true;
    for (int k = 0; k < 3; ++k) {
      const VertexId v = mesh.corner(f, k);
      x[k] = cells_per_px_ * (image[v] - origin_);
      z[k] = depth[v];
      in_front = in_front && z[k] > 0;
    }
    if (in_front && faces_camera(mesh, image, f)) draw_face(x, z);
  }
}

void DepthBuffer::draw_face(const Vec2 (&x)[3], const float (&z)[3]) {
  const float area = doubled_area(x[0], x[1], x[2]);
  if (magnitude(area) < 1e-6f) return;
  const auto cell = [](float value, int count) {
    return static_cast<int>(clamp(value, 0, static_cast<float>(count - 1)));
  };
  const int i0 = cell(min(x[0].x, min(x[1].x, x[2].x)), across_),
            i1 = cell(max(x[0].x, max(x[1].x, x[2].x)), across_);
  const int j0 = cell(min(x[0].y, min(x[1].y, x[2].y)), down_),
            j1 = cell(max(x[0].y, max(x[1].y, x[2].y)), down_);
  const float inverse = 1.0f / area;
  for (int j = j0; j <= j1; ++j)
    for (int i = i0; i <= i1; ++i) {
      const Vec2 centre{static_cast<float>(i) + 0.5f, static_cast<float>(j) + 0.5f};
      const float a = doubled_area(centre, x[1], x[2]) * inverse,
                  b = doubled_area(x[0], centre, x[2]) * inverse;
      const float c = 1 - a - b;
      if (a < 0 || b < 0 || c < 0) continue;
      float& nearest = depth_[j * across_ + i];
      nearest = min(nearest, a * z[0] + b * z[1] + c * z[2]);
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
  float best = kFar;
  for (int k = 0; k < 3; ++k) {
    const int n = k == 2 ? 0 : k + 1;
    const Vec2 edge = corner[n] - corner[k];
    const float square = dot(edge, edge);
    const float t = square > 0 ? clamp(dot(x - corner[k], edge) / square, 0, 1) : 0.0f;
    const Vec2 off = x - corner[k] - t * edge;
    if (dot(off, off) >= best) continue;
    best = dot(off, off);
    weight[k] = 1 - t;
    weight[n] = t;
    weight[3 - k - n] = 0;
  }
  return best;
}

}  // namespace pliant
