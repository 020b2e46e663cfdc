#include "host/render/view_rays.hpp"

#include <algorithm>
#include <cmath>

#include "host/io/calibration.hpp"
#include "pliant/camera.hpp"

namespace pliant::host {

namespace {

/// Tuning of the view rays. Each constant: unit, reason, experiment. Chosen by eye on fitted photographs of faces.
struct ViewRayTuning {
  /// Cells on a side of the grid over the chart, count: smaller than a millimetre of a face.
  int cells = 256;
  /// Cosines of the angle between normal and ray at which a point counts as not visible, and as fully visible. Near the
  /// silhouette an error of the fit of one pixel would project background onto the surface.
  float unseen_cosine = 0.22f, seen_cosine = 0.5f;
  /// Cosine above which a point's colour belongs to the surface without doubt.
  float frontal_cosine = 0.8f;
  /// Standard deviations from the frontal colours beyond which a point at seen_cosine is background, and the increase of that
  /// limit per unit of the cosine.
  float background_sds = 3, background_slope = 20;
  /// Least standard deviation of the frontal colours, fraction of red or green. Even skin would leave no tolerance.
  float least_spread = 0.015f;
  /// Cells around background that are removed as well, because both mix there, and cells up to which the weight rises to 1.
  int mixed_cells = 3, faded_cells = 14;
  /// Distance behind the nearest surface up to which a point counts as visible, millimetres. Above the error of the depth
  /// image, below the depth of a lip.
  float depth_margin_mm = 4;
  /// Largest side of the depth image, pixels. Bounds the time.
  int depth_side_px = 800;
};
constexpr ViewRayTuning kTuning{};
constexpr int kCells = kTuning.cells;

/// Median, and standard deviation estimated from the median absolute deviation.
struct Spread {
  float middle = 0, sd = 0;
};
constexpr float kNormalMad =
    1.4826f;  // standard deviation over median absolute deviation of a normal variable
Spread spread_of(std::vector<float> values) {
  if (values.empty()) return {};
  const auto half = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), half, values.end());
  Spread out{*half, 0};
  for (float& v : values) v = magnitude(v - out.middle);
  std::nth_element(values.begin(), half, values.end());
  out.sd = kNormalMad * *half;
  return out;
}

/// Fractions of red and green in a colour, which light and shade do not change.
Vec2 chroma(Vec3 colour) {
  const float sum = colour.x + colour.y + colour.z + 1;
  return {colour.x / sum, colour.y / sum};
}

}  // namespace

Vec3 photo_colour(const Image& photo, Vec2 x) {
  const int i = std::min(static_cast<int>(x.x), std::max(0, photo.width - 2)),
            j = std::min(static_cast<int>(x.y), std::max(0, photo.height - 2));
  const int i1 = std::min(i + 1, photo.width - 1), j1 = std::min(j + 1, photo.height - 1);
  const float a = x.x - static_cast<float>(i), b = x.y - static_cast<float>(j);
  const auto pixel = [&](int s, int t) {
    const std::uint8_t* p = photo.at(s, t);
    return Vec3{static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
  };
  return (1 - b) * ((1 - a) * pixel(i, j) + a * pixel(i1, j)) +
         b * ((1 - a) * pixel(i, j1) + a * pixel(i1, j1));
}

ViewRays::ViewRays(const Model& model, const FitFile& fit, const std::vector<float>& q, int width, int height)
    : texture_(model),
      sheet_(model, texture_, kCells),
      projector_(view_of(fit.pose, fit.camera), true),
      lens_(lens_of(fit.camera, {fit.width, fit.height})),
      scale_(std::min(
          1.0f, static_cast<float>(kTuning.depth_side_px) / static_cast<float>(std::max(width, height)))),
      raster_(std::max(1, static_cast<int>(static_cast<float>(width) * scale_)),
              std::max(1, static_cast<int>(static_cast<float>(height) * scale_)), 1) {
  sheet_.set(q.data());
  draw_depth();
  rays_.resize(sheet_.index(0, kCells + 1));
  for (std::size_t k = 0; k < rays_.size(); ++k)
    if (sheet_.is_used(k)) rays_[k] = ray_of(k, width, height);
}

void ViewRays::reject_background(const Image& photo) {
  std::vector<float> red, green;
  for (const ViewRay& s : rays_) {
    if (s.facing < kTuning.frontal_cosine || s.weight < 1) continue;
    const Vec2 c = chroma(photo_colour(photo, s.x));
    red.push_back(c.x);
    green.push_back(c.y);
  }
  if (red.empty()) return;  // a surface that is turned away everywhere tells no colour of its own
  const Spread r = spread_of(red), g = spread_of(green);
  const auto is_background = [&](const ViewRay& s) {
    const Vec2 c = chroma(photo_colour(photo, s.x));
    const float dr = (c.x - r.middle) / max(r.sd, kTuning.least_spread),
                dg = (c.y - g.middle) / max(g.sd, kTuning.least_spread);
    const float limit =
        kTuning.background_sds + kTuning.background_slope * max(0, s.facing - kTuning.seen_cosine);
    return dr * dr + dg * dg > limit * limit;
  };
  std::vector<std::uint8_t> passable(rays_.size());
  for (std::size_t k = 0; k < rays_.size(); ++k)
    passable[k] = !sheet_.is_used(k) || rays_[k].weight <= 0 || is_background(rays_[k]);
  fade_around(reached_from_border(passable));
}

ViewRay ViewRays::at(Vec2 uv) const {
  const float x = clamp(uv.x, 0, 1) * kCells, y = clamp(uv.y, 0, 1) * kCells;
  const int i = std::min(static_cast<int>(x), kCells - 1), j = std::min(static_cast<int>(y), kCells - 1);
  const float a = x - static_cast<float>(i), b = y - static_cast<float>(j);
  ViewRay out;
  for (int k = 0; k < 4; ++k) {
    const ViewRay& s = rays_[sheet_.index(i + k % 2, j + k / 2)];
    const float weight = (k % 2 ? a : 1 - a) * (k / 2 ? b : 1 - b);
    if (s.weight <= 0 && weight > 0) return {};
    out.x = out.x + weight * s.x;
    out.weight += weight * s.weight;
  }
  return out;
}

/// Points that are connected to the border of the chart through passable points.
std::vector<std::uint8_t> ViewRays::reached_from_border(const std::vector<std::uint8_t>& passable) const {
  std::vector<std::uint8_t> reached(passable.size(), 0);
  std::vector<std::pair<int, int>> stack;
  const auto visit = [&](int i, int j) {
    if (i < 0 || j < 0 || i > kCells || j > kCells) return;
    const std::size_t k = sheet_.index(i, j);
    if (passable[k] == 0 || reached[k] != 0) return;
    reached[k] = 1;
    stack.emplace_back(i, j);
  };
  for (int i = 0; i <= kCells; ++i) visit(i, 0), visit(i, kCells), visit(0, i), visit(kCells, i);
  while (!stack.empty()) {
    const auto [i, j] = stack.back();
    stack.pop_back();
    visit(i - 1, j), visit(i + 1, j), visit(i, j - 1), visit(i, j + 1);
  }
  return reached;
}

/// Sets the weight of these points to zero and lowers it around them.
void ViewRays::fade_around(const std::vector<std::uint8_t>& removed) {
  for (int j = 0; j <= kCells; ++j)
    for (int i = 0; i <= kCells; ++i) {
      if (removed[sheet_.index(i, j)] == 0) continue;
      for (int b = std::max(0, j - kTuning.faded_cells); b <= std::min(kCells, j + kTuning.faded_cells); ++b)
        for (int a = std::max(0, i - kTuning.faded_cells); a <= std::min(kCells, i + kTuning.faded_cells);
             ++a) {
          ViewRay& s = rays_[sheet_.index(a, b)];
          const auto distance = std::hypot(static_cast<float>(a - i), static_cast<float>(b - j));
          s.weight = min(
              s.weight,
              clamp((distance - kTuning.mixed_cells) / (kTuning.faded_cells - kTuning.mixed_cells), 0, 1));
        }
    }
}

void ViewRays::draw_depth() {
  std::vector<RasterVertex> corners(sheet_.index(0, kCells + 1));
  for (std::size_t k = 0; k < corners.size(); ++k) {
    Vec2 x;
    if (!sheet_.is_used(k) || !projector_.project(sheet_.position(k), &x)) continue;
    corners[k] = {to_depth(lens_.distort(x)), 1 / projector_.to_camera(sheet_.position(k)).z, sheet_.uv(k),
                  0};
  }
  raster_.clear();
  const auto shade = [this](Vec2 uv, float, float*) { return texture_.covers(uv); };
  const auto triangle = [&](std::size_t a, std::size_t b, std::size_t c) {
    if (corners[a].inverse_depth > 0 && corners[b].inverse_depth > 0 && corners[c].inverse_depth > 0)
      raster_.draw(corners[a], corners[b], corners[c], shade);
  };
  sheet_.for_each_triangle(triangle);
}

ViewRay ViewRays::ray_of(std::size_t k, int width, int height) const {
  ViewRay ray;
  const Vec3 p = projector_.to_camera(sheet_.position(k));
  if (!projector_.project(sheet_.position(k), &ray.x)) return {};
  ray.x = lens_.distort(ray.x);
  if (!(ray.x.x >= 0 && ray.x.y >= 0 && ray.x.x <= static_cast<float>(width - 1) &&
        ray.x.y <= static_cast<float>(height - 1)))
    return {};
  const Vec2 d = to_depth(ray.x);
  const float nearest = raster_.inverse_depth(std::min(static_cast<int>(d.x + 0.5f), raster_.width() - 1),
                                              std::min(static_cast<int>(d.y + 0.5f), raster_.height() - 1));
  if (nearest > 0 && p.z > 1 / nearest + kTuning.depth_margin_mm) return {};
  ray.facing = -dot(projector_.rotated(sheet_.normal(k)), normalised(p));
  const float t =
      clamp((ray.facing - kTuning.unseen_cosine) / (kTuning.seen_cosine - kTuning.unseen_cosine), 0, 1);
  ray.weight = t * t * (3 - 2 * t);
  return ray;
}

}  // namespace pliant::host
