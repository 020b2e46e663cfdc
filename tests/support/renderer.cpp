#include "renderer.hpp"

#include <cmath>

#include "host/render/synthetic.hpp"
#include "pliant/visibility.hpp"

using namespace pliant;

namespace {

constexpr int kSamples = 2;  // along each side of a pixel

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
      corner(i, j).drawn.uv = {static_cast<float>(i) / static_cast<float>(cells_),
                               static_cast<float>(j) / static_cast<float>(cells_)};
  for (int j = 0; j <= cells_; ++j)
    for (int i = 0; i <= cells_; ++i) {
      if (!(cover(corner(i, j).drawn.uv) > 0)) continue;
      for (int b = j > 0 ? j - 1 : 0; b <= j + 1 && b <= cells_; ++b)
        for (int a = i > 0 ? i - 1 : 0; a <= i + 1 && a <= cells_; ++a) corner(a, b).is_used = true;
    }
  std::vector<Vec2> used;
  for (Corner& c : corners_) {
    if (c.is_used) used.push_back(c.drawn.uv);
    c.begins_whole_cell = c.is_used && is_covered_from(c.drawn.uv);
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
      c.drawn.inverse_depth = 0;
      if (!c.is_used || !projector.project(c.position, &c.drawn.x)) continue;
      c.drawn.inverse_depth = 1 / projector.to_camera(c.position).z;
      c.drawn.light = tone * host::light_on(projector.rotated(normal(i, j)));
    }
}

Picture Renderer::draw(const float* q, const Pose& pose, const Camera& camera, const Picture& backdrop,
                       float tone) {
  Picture out = backdrop;
  if (raster_.width() != out.width || raster_.height() != out.height)
    raster_ = host::Raster(out.width, out.height, kSamples);
  raster_.clear();
  pose_corners(q, pose, camera, tone);
  for (int j = 0; j < cells_; ++j)
    for (int i = 0; i < cells_; ++i) {
      const bool is_whole = corner(i, j).begins_whole_cell;
      const auto shade = [&](Vec2 uv, float light, float* grey) {
        if (!is_whole && cover(uv) < 0.5f) return false;
        *grey = min(255.0f, albedo(uv) * light);
        return true;
      };
      const auto triangle = [&](const Corner& a, const Corner& b, const Corner& c) {
        if (a.drawn.inverse_depth > 0 && b.drawn.inverse_depth > 0 && c.drawn.inverse_depth > 0)
          raster_.draw(a.drawn, b.drawn, c.drawn, shade);
      };
      triangle(corner(i, j), corner(i + 1, j), corner(i, j + 1));
      triangle(corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1));
    }
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x)
      out.at(x, y) = static_cast<std::uint8_t>(raster_.value(x, y, static_cast<float>(out.at(x, y))) + 0.5f);
  return out;
}
