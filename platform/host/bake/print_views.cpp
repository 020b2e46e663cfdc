#include "host/bake/print_views.hpp"

#include <algorithm>
#include <cmath>

#include "host/io/bounding_box.hpp"
#include "host/render/raster.hpp"
#include "pliant/camera.hpp"
#include "print/descriptor.hpp"

namespace pliant::host::bake {

namespace {

/// Tuning of the views. Each constant: unit, reason, experiment.
struct PrintViewTuning {
  /// Cosine of the angle up to which a view shows surface well: 37 degrees. Round value, not tuned.
  float least_cosine = 0.8f;
  /// What a further side adds, at least, as fractions of the surface and of what the first side shows, the smaller one; and sides,
  /// count, at most: keypoints are shared among the views. A side of a ball shows a tenth of it: with the first fraction alone
  /// chance decides which of its sides are left out. Round values, not tuned.
  float least_side = 0.1f, least_of_first = 0.25f;
  std::size_t most_sides = 14;
  /// Up to so many sides each is also seen tilted, by this angle, radians (43 degrees), in so many directions, count. Round
  /// values, not tuned.
  std::size_t most_tilted_sides = 2;
  float tilt = 0.75f;
  int tilts = 6;
  /// Grey of the surroundings: the middle.
  float background = 128;
  /// Distance of the eye, in extents, of the nearly parallel projection. Round value, not tuned.
  float eye_extents = 1000;
};
constexpr PrintViewTuning kTuning;

struct Facet {
  Vec3 normal;
  float area;
};

std::vector<Facet> facets_of(const SurfaceSheet& sheet) {
  std::vector<Facet> facets;
  sheet.for_each_triangle([&](std::size_t a, std::size_t b, std::size_t c) {
    if (!sheet.is_used(a) || !sheet.is_used(b) || !sheet.is_used(c)) return;
    // Seen from outside, u points right and v down.
    const Vec3 n = cross(sheet.position(c) - sheet.position(a), sheet.position(b) - sheet.position(a));
    facets.push_back({normalised(n), length(n)});
  });
  return facets;
}

/// The rotation that shows a side with this normal (model axes) from the front.
Quat facing(Vec3 normal) {
  const Vec3 n{normal.x, -normal.y, -normal.z};  // camera axes; it is to become (0,0,-1)
  const Vec3 axis = cross(n, Vec3{0, 0, -1});
  if (n.z < -0.999999f) return {};
  if (n.z > 0.999999f) return {0, 0, 1, 0};
  return normalised(Quat{1 - n.z, axis.x, axis.y, axis.z});
}

/// Directions of a ball, and the mean normal first.
std::vector<Vec3> candidates(const std::vector<Facet>& facets) {
  Vec3 mean;
  for (const Facet& f : facets) mean = mean + f.area * f.normal;
  std::vector<Vec3> all;
  if (length(mean) > 0) all.push_back(normalised(mean));
  for (int k = 0; k < 27; ++k)
    if (k != 13)
      all.push_back(normalised(Vec3{static_cast<float>(k % 3 - 1), static_cast<float>(k / 3 % 3 - 1),
                                    static_cast<float>(k / 9 - 1)}));
  return all;
}

/// The sides that show most surface not yet shown.
std::vector<Vec3> choose_sides(const std::vector<Facet>& facets) {
  const std::vector<Vec3> all = candidates(facets);
  std::vector<char> is_shown(facets.size(), 0);
  float whole = 0;
  for (const Facet& f : facets) whole += f.area;
  std::vector<Vec3> sides;
  float least = 0;
  while (sides.size() < kTuning.most_sides) {
    float best = 0;
    Vec3 side;
    for (const Vec3 d : all) {
      float gain = 0;
      for (std::size_t k = 0; k < facets.size(); ++k)
        if (is_shown[k] == 0 && dot(facets[k].normal, d) >= kTuning.least_cosine) gain += facets[k].area;
      if (gain > best) best = gain, side = d;
    }
    if (sides.empty()) least = std::min(kTuning.least_side * whole, kTuning.least_of_first * best);
    if (!(best > least)) break;
    sides.push_back(side);
    for (std::size_t k = 0; k < facets.size(); ++k)
      is_shown[k] |= static_cast<char>(dot(facets[k].normal, side) >= kTuning.least_cosine);
  }
  return sides;
}

}  // namespace

std::vector<Quat> choose_print_views(const SurfaceSheet& sheet) {
  const std::vector<Vec3> sides = choose_sides(facets_of(sheet));
  std::vector<Quat> views;
  for (const Vec3 side : sides) views.push_back(facing(side));
  if (sides.size() > kTuning.most_tilted_sides) return views;
  for (std::size_t k = 0; k < sides.size(); ++k)
    for (int t = 0; t < kTuning.tilts; ++t) {
      const float angle = 6.2831853f * static_cast<float>(t) / static_cast<float>(kTuning.tilts);
      const Quat tilt = exp_rotation(kTuning.tilt * Vec3{std::cos(angle), std::sin(angle), 0});
      views.push_back(normalised(tilt * views[k]));
    }
  return views;
}

namespace {

constexpr int kMargin = descriptor_reach(PatchScale::whole) + 1;  // px, around the surface

/// Images of the sheet's points, and the size of the picture that holds them.
struct PrintProjection {
  std::vector<RasterVertex> corners;
  int width = 0, height = 0;

  PrintProjection(const SurfaceSheet& sheet, Quat view, float scale) {
    const Projector rotation(View{view, 1, {}, kMinRho, {}}, true);
    std::vector<Vec3> p(sheet.index(0, sheet.cells() + 1));
    BoundingBox<Vec3> box;
    for (std::size_t k = 0; k < p.size(); ++k) {
      if (!sheet.is_used(k)) continue;
      p[k] = rotation.rotated(sheet.position(k));
      box.add(p[k]);
    }
    const Vec3 low = box.low, size = box.size();
    width = static_cast<int>(scale * size.x) + 2 * kMargin + 1;
    height = static_cast<int>(scale * size.y) + 2 * kMargin + 1;
    const float eye = kTuning.eye_extents * (length(size) + 1e-6f);
    corners.resize(p.size());
    for (std::size_t k = 0; k < p.size(); ++k)
      if (sheet.is_used(k))
        corners[k] = {{kMargin + scale * (p[k].x - low.x), kMargin + scale * (p[k].y - low.y)},
                      eye / (eye + p[k].z - low.z),
                      sheet.uv(k),
                      1};
  }
};

/// Draws a value of (u,v) over the picture, where the surface faces the eye. Its back shows no print, and of a card that is
/// modelled without thickness it lies where the front of the other side does.
template <class Value>
Raster draw_values(const SurfaceSheet& sheet, const ChartTexture& texture, const PrintProjection& projection,
                   int samples, const Value& value) {
  Raster raster(projection.width, projection.height, samples);
  raster.clear();
  const auto shade = [&](Vec2 uv, float, float* grey) {
    if (!texture.covers(uv)) return false;
    *grey = value(uv);
    return true;
  };
  sheet.for_each_triangle([&](std::size_t a, std::size_t b, std::size_t c) {
    const auto& v = projection.corners;
    if (v[a].inverse_depth > 0 && v[b].inverse_depth > 0 && v[c].inverse_depth > 0 &&
        is_clockwise(v[a], v[b], v[c]))
      raster.draw(v[a], v[b], v[c], shade);
  });
  return raster;
}

}  // namespace

PrintPicture draw_print(const SurfaceSheet& sheet, const ChartTexture& texture, Quat view, float px_per_mm,
                        float albedo_px_per_mm) {
  const PrintProjection projection(sheet, view, px_per_mm);
  const int samples = std::clamp(static_cast<int>(std::ceil(albedo_px_per_mm / px_per_mm)), 2, 8);
  const Raster grey = draw_values(sheet, texture, projection, samples,
                                  [&](Vec2 uv) { return texture.albedo(uv); }),
               u = draw_values(sheet, texture, projection, 1, [](Vec2 uv) { return uv.x; }),
               v = draw_values(sheet, texture, projection, 1, [](Vec2 uv) { return uv.y; });
  PrintPicture picture{Image(projection.width, projection.height, 1), {}};
  for (int y = 0; y < projection.height; ++y)
    for (int x = 0; x < projection.width; ++x) {
      *picture.grey.at(x, y) = static_cast<std::uint8_t>(grey.value(x, y, kTuning.background) + 0.5f);
      picture.uv.push_back(u.coverage(x, y) > 0 ? Vec2{u.value(x, y, 0), v.value(x, y, 0)} : Vec2{-1, -1});
    }
  return picture;
}

}  // namespace pliant::host::bake
