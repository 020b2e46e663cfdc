#include "host/bake/albedo_picture.hpp"

#include <algorithm>
#include <cmath>

#include "host/bake/at.hpp"
#include "host/bake/chart_raster.hpp"

namespace pliant::host::bake {

namespace {

constexpr float kUnpainted = 190;  // grey of a triangle without a picture, as of a model without albedo
constexpr int kLeastSide = 16;     // pixels

/// Bilinear value at (u,v) of a grey picture. Pixel centres lie half a pixel inside its border.
float grey_at(const Image& picture, Vec2 uv) {
  const float x = std::clamp(uv.x * static_cast<float>(picture.width) - 0.5f, 0.0f,
                             static_cast<float>(picture.width - 1)),
              y = std::clamp((1 - uv.y) * static_cast<float>(picture.height) - 0.5f, 0.0f,
                             static_cast<float>(picture.height - 1));
  const int i = static_cast<int>(x), j = static_cast<int>(y), i1 = std::min(i + 1, picture.width - 1),
            j1 = std::min(j + 1, picture.height - 1);
  const float a = x - static_cast<float>(i), b = y - static_cast<float>(j);
  const auto value = [&](int k, int l) { return static_cast<float>(*picture.at(k, l)); };
  const float upper = value(i, j) + a * (value(i1, j) - value(i, j)),
              lower = value(i, j1) + a * (value(i1, j1) - value(i, j1));
  return upper + b * (lower - upper);
}

}  // namespace

GreyImage albedo_of(const Source& source, const PaintedSurface& painted, int most_side) {
  int side = kLeastSide;
  for (const Image& picture : painted.pictures) side = std::max({side, picture.width, picture.height});
  side = std::min(side, std::max(most_side, kLeastSide));
  std::vector<Image> pictures;
  for (const Image& picture : painted.pictures) pictures.push_back(to_grey(shrunk_to(picture, side, side)));
  const ChartRaster raster = rasterise(source.uv, source.triangles, source.is_hole, side, side);
  // Samples beside the surface have its vertices, but no triangle.
  std::vector<int> picture_of(source.uv.size(), -1);
  for (std::size_t f = 0; f < source.triangles.size(); ++f)
    for (const int v : source.triangles[f]) picture_of[at(v)] = painted.picture[f];
  GreyImage albedo{static_cast<std::uint32_t>(side), static_cast<std::uint32_t>(side), {}};
  for (const ChartSample& s : raster.samples) {
    const int k = s.triangle >= 0 ? painted.picture[at(s.triangle)] : picture_of[at(s.vertex[0])];
    Vec2 uv{};
    for (std::size_t i = 0; i < 3; ++i) uv = uv + s.weight[i] * painted.picture_uv[at(s.vertex[i])];
    const float grey = k < 0 ? kUnpainted : grey_at(pictures[at(k)], uv);
    albedo.pixels.push_back(static_cast<std::uint8_t>(std::lround(std::clamp(grey, 0.0f, 255.0f))));
  }
  return albedo;
}

}  // namespace pliant::host::bake
