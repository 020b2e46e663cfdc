#include "renderer.hpp"

#include <cmath>

#include "host/render/synthetic.hpp"
#include "pliant/visibility.hpp"

using namespace pliant;

namespace {

constexpr int kSamples = 2;  // along each side of a pixel

float least(float a, float b, float c) {
  return min(a, min(b, c));
}
float most(float a, float b, float c) {
  return max(a, max(b, c));
}

}  // namespace

Picture make_backdrop(int width, int height, std::uint32_t seed) {
  Picture picture(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      picture.at(x, y) =
          static_cast<std::uint8_t>(host::backdrop_grey(x, y, width > height ? width : height, seed));
  return picture;
}

void add_noise(Picture& picture, float sd, std::uint32_t seed) {
  host::add_normal_noise(picture.pixels, 1, sd, seed);
}

Pose frontal_pose(Cascade& cascade, const float* q, const Camera& camera, int height, float fraction) {
  float low = 1e9f, high = -1e9f;
  for (const Vec2 uv : cascade.model().base_uv()) {
    const float y = cascade.surface_point(uv, q).y;
    low = min(low, y);
    high = max(high, y);
  }
  const float depth = camera.f * max(high - low, 1.0f) / (fraction * static_cast<float>(height));
  return {{}, {0, 0.5f * (low + high), depth}};
}

Renderer::Renderer(Cascade& cascade, int cells)
    : mask_(cascade.model().mask()),
      albedo_(cascade.model().albedo()),
      cells_(cells),
      cover_(host::smooth_cover(
          host::without_holes(mask_.pixels, static_cast<int>(mask_.width), static_cast<int>(mask_.height)),
          static_cast<int>(mask_.width), static_cast<int>(mask_.height))),
      corners_(static_cast<std::size_t>((cells + 1) * (cells + 1))),
      surface_(cascade, use_corners()) {}

/// Places the corners in the chart and chooses those whose position is used. \return these.
std::vector<Vec2> Renderer::use_corners() {
  for (int j = 0; j <= cells_; ++j)
    for (int i = 0; i <= cells_; ++i)
      corner(i, j).uv = {static_cast<float>(i) / static_cast<float>(cells_),
                         static_cast<float>(j) / static_cast<float>(cells_)};
  for (int j = 0; j <= cells_; ++j)
    for (int i = 0; i <= cells_; ++i) {
      if (!(cover(corner(i, j).uv) > 0)) continue;
      for (int b = j > 0 ? j - 1 : 0; b <= j + 1 && b <= cells_; ++b)
        for (int a = i > 0 ? i - 1 : 0; a <= i + 1 && a <= cells_; ++a) corner(a, b).is_used = true;
    }
  std::vector<Vec2> used;
  for (Corner& c : corners_) {
    if (c.is_used) used.push_back(c.uv);
    c.begins_whole_cell = c.is_used && is_covered_from(c.uv);
  }
  return used;
}

/// Whether the cover is whole all over the cell that begins at a corner, and a pixel around.
bool Renderer::is_covered_from(Vec2 uv) const {
  const float side = 1 / static_cast<float>(cells_);
  const auto pixel = [](float t, std::uint32_t count, int more) {
    return static_cast<int>(t * static_cast<float>(count - 1)) + more;
  };
  const int width = static_cast<int>(mask_.width), height = static_cast<int>(mask_.height);
  for (int y = pixel(uv.y, mask_.height, -1); y <= pixel(uv.y + side, mask_.height, 2); ++y)
    for (int x = pixel(uv.x, mask_.width, -1); x <= pixel(uv.x + side, mask_.width, 2); ++x)
      if (x < 0 || y < 0 || x >= width || y >= height ||
          cover_[static_cast<std::size_t>(y * width + x)] != 255)
        return false;
  return true;
}

float Renderer::cover(Vec2 uv) const {
  return host::chart_value(cover_.data(), mask_.width, mask_.height, uv) / 255;
}

float Renderer::albedo(Vec2 uv) const {
  if (albedo_.pixels == nullptr) return 190;
  const float grey = host::chart_value(albedo_.pixels, albedo_.width, albedo_.height, uv);
  if (!(flat_step_ > 0) || uv.x >= 0.5f) return grey;
  return flat_step_ * (0.5f + static_cast<float>(static_cast<int>(grey / flat_step_)));
}

/// Unit length, outwards, by central differences over the used neighbours; one-sided at the border.
Vec3 Renderer::normal(int i, int j) {
  const auto position = [&](int a, int b) {
    const bool is_there = a >= 0 && b >= 0 && a <= cells_ && b <= cells_ && corner(a, b).is_used;
    return is_there ? corner(a, b).position : corner(i, j).position;
  };
  return normalised(cross(position(i, j + 1) - position(i, j - 1), position(i + 1, j) - position(i - 1, j)));
}

void Renderer::pose_corners(const float* q, const Pose& pose, const Camera& camera, float tone) {
  auto position = surface_.at(q).begin();
  for (Corner& c : corners_)
    if (c.is_used) c.position = *position++;
  const Projector projector(view_of(pose, camera), true);
  for (int j = 0; j <= cells_; ++j)
    for (int i = 0; i <= cells_; ++i) {
      Corner& c = corner(i, j);
      c.inverse_depth = 0;
      if (!c.is_used || !projector.project(c.position, &c.x)) continue;
      c.x = kSamples * (c.x + Vec2{0.5f, 0.5f}) - Vec2{0.5f, 0.5f};
      c.inverse_depth = 1 / projector.to_camera(c.position).z;
      c.light = tone * host::light_on(projector.rotated(normal(i, j)));
    }
}

void Renderer::draw_triangle(const Corner& a, const Corner& b, const Corner& c, bool is_whole) {
  if (!(a.inverse_depth > 0 && b.inverse_depth > 0 && c.inverse_depth > 0)) return;
  const float area = doubled_area(a.x, b.x, c.x);
  if (!(magnitude(area) > 1e-12f)) return;
  const float side = area < 0 ? -1.0f : 1.0f;
  const auto right = static_cast<float>(columns_ - 1), bottom = static_cast<float>(rows_ - 1);
  // Rounded up and down for values from -1.
  const int i0 = static_cast<int>(clamp(least(a.x.x, b.x.x, c.x.x), 0, right + 1) + 0.9999f);
  const int i1 = static_cast<int>(clamp(most(a.x.x, b.x.x, c.x.x), -1, right) + 1) - 1;
  const int j0 = static_cast<int>(clamp(least(a.x.y, b.x.y, c.x.y), 0, bottom + 1) + 0.9999f);
  const int j1 = static_cast<int>(clamp(most(a.x.y, b.x.y, c.x.y), -1, bottom) + 1) - 1;
  for (int j = j0; j <= j1; ++j)
    for (int i = i0; i <= i1; ++i) {
      // Barycentric in the image; divided by the depth they are barycentric on the surface.
      const Vec2 s{static_cast<float>(i), static_cast<float>(j)};
      const float of_a = doubled_area(s, b.x, c.x), of_b = doubled_area(a.x, s, c.x);
      if (side * of_a < 0 || side * of_b < 0) continue;  // most of them, without a division
      const float wa = of_a / area, wb = of_b / area;
      if (wa + wb > 1) continue;
      const float za = wa * a.inverse_depth, zb = wb * b.inverse_depth, zc = (1 - wa - wb) * c.inverse_depth;
      const float z = za + zb + zc;
      const auto k = static_cast<std::size_t>(j * columns_ + i);
      if (!(z > inverse_depth_[k])) continue;
      const Vec2 uv = (1 / z) * (za * a.uv + zb * b.uv + zc * c.uv);
      if (!is_whole && cover(uv) < 0.5f) continue;
      inverse_depth_[k] = z;
      grey_[k] = min(255.0f, albedo(uv) * (za * a.light + zb * b.light + zc * c.light) / z);
    }
}

float Renderer::mean_grey(int x, int y, float backdrop) const {
  float sum = 0;
  for (int k = 0; k < kSamples * kSamples; ++k) {
    const auto at =
        static_cast<std::size_t>((y * kSamples + k / kSamples) * columns_ + x * kSamples + k % kSamples);
    sum += inverse_depth_[at] > 0 ? grey_[at] : backdrop;
  }
  return sum / (kSamples * kSamples);
}

Picture Renderer::draw(const float* q, const Pose& pose, const Camera& camera, const Picture& backdrop,
                       float tone) {
  Picture out = backdrop;
  columns_ = kSamples * out.width;
  rows_ = kSamples * out.height;
  grey_.resize(static_cast<std::size_t>(columns_ * rows_));
  inverse_depth_.assign(grey_.size(), 0);
  pose_corners(q, pose, camera, tone);
  for (int j = 0; j < cells_; ++j)
    for (int i = 0; i < cells_; ++i) {
      const bool is_whole = corner(i, j).begins_whole_cell;
      draw_triangle(corner(i, j), corner(i + 1, j), corner(i, j + 1), is_whole);
      draw_triangle(corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1), is_whole);
    }
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x)
      out.at(x, y) = static_cast<std::uint8_t>(mean_grey(x, y, static_cast<float>(out.at(x, y))) + 0.5f);
  return out;
}
