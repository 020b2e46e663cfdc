#include "host/render/scene.hpp"

#include <algorithm>
#include <cmath>

#include "host/io/calibration.hpp"

namespace pliant::host {

namespace {

/// Brightness of a surface with unit normal n (camera axes: x right, y down, z away). Wrapped diffuse light,
/// so that the shadow side still shows its shape.
float light_on(Vec3 n) {
  static const Vec3 key = normalised(Vec3{-0.55f, -0.65f, -0.85f}),
                    fill = normalised(Vec3{0.8f, 0.1f, -0.6f});
  const float k = std::max(0.0f, (dot(n, key) + 0.2f) / 1.2f), f = std::max(0.0f, dot(n, fill));
  return 0.22f + 0.78f * k + 0.16f * f;
}

/// A 32-bit hash of two numbers.
std::uint32_t hash(std::uint32_t a, std::uint32_t b) {
  std::uint32_t h = a * 0x9e3779b1u ^ (b + 0x85ebca6bu) * 0xc2b2ae35u;
  h = (h ^ h >> 15) * 0x2c1b3c6du;
  h = (h ^ h >> 12) * 0x297a2d39u;
  return h ^ h >> 15;
}

float uniform(std::uint32_t bits) {
  return static_cast<float>(bits >> 8) * (1.0f / 16777216.0f);
}

/// Smooth noise in [0,1] with one random value for each unit square.
float value_noise(float x, float y, std::uint32_t seed) {
  const auto rounded_down = [](float t) {
    const int i = static_cast<int>(t);
    return static_cast<float>(i) > t ? i - 1 : i;
  };
  const int i = rounded_down(x), j = rounded_down(y);
  const std::uint32_t left = hash(static_cast<std::uint32_t>(i), seed),
                      right = hash(static_cast<std::uint32_t>(i + 1), seed);
  const auto corner = [&](std::uint32_t column, int b) {
    return uniform(hash(column, static_cast<std::uint32_t>(b)));
  };
  const auto ease = [](float t) { return t * t * (3 - 2 * t); };
  const float fx = ease(x - static_cast<float>(i)), fy = ease(y - static_cast<float>(j));
  const float top = corner(left, j) * (1 - fx) + corner(right, j) * fx;
  return top * (1 - fy) + (corner(left, j + 1) * (1 - fx) + corner(right, j + 1) * fx) * fy;
}

}  // namespace

Scene::Scene(const Model& model, int width, int height, int cells, int samples)
    : model_(model), texture_(model), sheet_(model, texture_, cells), raster_(width, height, samples) {}

float Scene::albedo(Vec2 uv) const {
  constexpr float kBlotches = 56;  // along a side of the chart: some 3 mm each; chosen by eye
  float grey = texture_.albedo(uv);
  if (flat_step_ > 0 && uv.x < 0.5f) grey = flat_step_ * (0.5f + std::floor(grey / flat_step_));
  if (speckle_ > 0) grey *= 1 + speckle_ * (2 * value_noise(kBlotches * uv.x, kBlotches * uv.y, 11) - 1);
  return grey;
}

Image Scene::draw(const float* q, const Pose& pose, const Camera& camera, const Image& background,
                  float tone) {
  sheet_.set(q);
  const Projector projector(view_of(pose, camera), true);
  const Lens lens = lens_of(camera, {raster_.width(), raster_.height()});
  corners_.assign(sheet_.index(0, sheet_.cells() + 1), {});
  for (std::size_t k = 0; k < corners_.size(); ++k) {
    RasterVertex& corner = corners_[k];
    if (!sheet_.is_used(k) || !projector.project(sheet_.position(k), &corner.x)) continue;
    corner.x = lens.distort(corner.x);
    corner.inverse_depth = 1 / projector.to_camera(sheet_.position(k)).z;
    corner.uv = sheet_.uv(k);
    corner.light = tone * light_on(projector.rotated(sheet_.normal(k)));
  }
  raster_.clear();
  const auto shade = [this](Vec2 uv, float light, float* grey) {
    if (!texture_.covers(uv)) return false;
    *grey = std::min(255.0f, albedo(uv) * light);
    return true;
  };
  const auto triangle = [&](std::size_t a, std::size_t b, std::size_t c) {
    const RasterVertex &p = corners_[a], &q3 = corners_[b], &r = corners_[c];
    if (p.inverse_depth > 0 && q3.inverse_depth > 0 && r.inverse_depth > 0) raster_.draw(p, q3, r, shade);
  };
  sheet_.for_each_triangle(triangle);
  Image image = background;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (int c = 0; c < image.channels; ++c) {
        std::uint8_t& value = image.at(x, y)[c];
        value = static_cast<std::uint8_t>(raster_.value(x, y, static_cast<float>(value)) + 0.5f);
      }
  return image;
}

Image make_background(int width, int height, std::uint32_t seed) {
  Image image(width, height, 1);
  const float unit = 6.0f / static_cast<float>(std::max(width, height));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const float u = static_cast<float>(x) * unit, v = static_cast<float>(y) * unit;
      const float blotches = 0.6f * value_noise(u, v, seed) + 0.3f * value_noise(3 * u, 3 * v, seed + 1) +
                             0.1f * value_noise(11 * u, 11 * v, seed + 2);
      *image.at(x, y) = static_cast<std::uint8_t>(45 + 90 * blotches);
    }
  return image;
}

void add_noise(Image& image, float sd, std::uint32_t seed) {
  if (!(sd > 0)) return;
  const auto channels = static_cast<std::size_t>(image.channels), count = image.pixels.size() / channels;
  for (std::size_t i = 0; i < count; i += 2) {
    // Box and Muller: two uniform numbers give two normal ones.
    const auto k = static_cast<std::uint32_t>(i);
    const float u = uniform(hash(seed, k)) + 1.0f / 33554432.0f,
                angle = 6.2831853f * uniform(hash(seed, k + 1));
    const float radius = sd * std::sqrt(-2 * std::log(u));
    const float noise[2] = {radius * std::cos(angle), radius * std::sin(angle)};
    for (std::size_t n = 0; n < 2 && i + n < count; ++n)
      for (std::size_t c = 0; c < channels; ++c) {
        std::uint8_t& value = image.pixels[(i + n) * channels + c];
        value = static_cast<std::uint8_t>(clamp(static_cast<float>(value) + noise[n] + 0.5f, 0, 255));
      }
  }
}

Pose frontal_pose(const Model& model, const float* q, const Camera& camera, int height, float fraction) {
  Owned<Cascade> cascade(model);
  float low = 1e9f, high = -1e9f;
  for (const Vec2 uv : model.base_uv()) {
    const float y = cascade->surface_point(uv, q).y;
    low = min(low, y);
    high = max(high, y);
  }
  const float distance = camera.f * max(high - low, 1.0f) / (fraction * static_cast<float>(height));
  return {{}, {0, 0.5f * (low + high), clamp(distance, 1 / kMaxRho, 1 / kMinRho)}};
}

}  // namespace pliant::host
