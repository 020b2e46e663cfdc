#include "host/render/scene.hpp"

#include <algorithm>
#include <cmath>

#include "host/io/calibration.hpp"
#include "host/render/synthetic.hpp"

namespace pliant::host {

namespace {

/// 1 / depth of a surface's back, as a fraction of its own: the two sides of a card that is modelled without thickness differ by
/// rounding only, 1e-7 of the depth, and would be seen mixed. 0.01 mm at 1 m: less than a sheet of paper is thick.
constexpr float kBackInverseDepth = 0.99999f;

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
    RasterVertex p = corners_[a], q3 = corners_[b], r = corners_[c];
    if (!(p.inverse_depth > 0 && q3.inverse_depth > 0 && r.inverse_depth > 0)) return;
    if (!is_clockwise(p, q3, r))
      for (RasterVertex* const corner : {&p, &q3, &r}) corner->inverse_depth *= kBackInverseDepth;
    raster_.draw(p, q3, r, shade);
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
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      *image.at(x, y) = static_cast<std::uint8_t>(backdrop_grey(x, y, std::max(width, height), seed));
  return image;
}

void add_noise(Image& image, float sd, std::uint32_t seed) {
  if (sd > 0) add_normal_noise(image.pixels, static_cast<std::size_t>(image.channels), sd, seed);
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
