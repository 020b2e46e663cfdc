#include "host/render/view_rays.hpp"

#include <algorithm>
#include <cmath>

#include "host/io/calibration.hpp"
#include "pliant/camera.hpp"

namespace pliant::host {

namespace {

constexpr int kCells = 256;
/// Cosine of normal and line of sight at which a surface is taken to be seen not at all, and fully: beside the outline a
/// fit that is a pixel off would take the background for skin.
constexpr float kUnseen = 0.22f, kSeen = 0.5f;
/// Where a surface faces the camera like this its colour is the face's own; where it turns aside (kSeen), a colour that is
/// kStrangeAside standard deviations off is taken to be background, and kStrangeSlope more a unit of the cosine.
constexpr float kFrontal = 0.8f, kStrangeAside = 3, kStrangeSlope = 20, kLeastSpread = 0.015f;
/// Cells around background that are given up as well, because both mix there, and up to which they count less.
constexpr int kMixed = 3, kFaded = 14;
/// How far (mm) behind the nearest surface a point may lie and still be that surface.
constexpr float kDepthMargin = 4;
/// Depth is looked up in a picture no larger than this, px.
constexpr int kDepthSide = 800;

/// Median, and the median distance from it as a standard deviation.
struct Spread {
  float middle = 0, sd = 0;
};
Spread spread_of(std::vector<float> values) {
  if (values.empty()) return {};
  const auto half = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), half, values.end());
  Spread out{*half, 0};
  for (float& v : values) v = magnitude(v - out.middle);
  std::nth_element(values.begin(), half, values.end());
  out.sd = 1.4826f * *half;
  return out;
}

/// Share of red and green in a colour: what light and shade leave as it is.
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

Sights::Sights(const Model& model, const FitFile& fit, const std::vector<float>& q, int width, int height)
    : texture_(model),
      sheet_(model, texture_, kCells),
      projector_(view_of(fit.pose, fit.camera), true),
      lens_(lens_of(fit.camera, {fit.width, fit.height})),
      scale_(std::min(1.0f, static_cast<float>(kDepthSide) / static_cast<float>(std::max(width, height)))),
      raster_(std::max(1, static_cast<int>(static_cast<float>(width) * scale_)),
              std::max(1, static_cast<int>(static_cast<float>(height) * scale_)), 1) {
  sheet_.set(q.data());
  draw_depth();
  sights_.resize(sheet_.index(0, kCells + 1));
  for (std::size_t k = 0; k < sights_.size(); ++k)
    if (sheet_.is_used(k)) sights_[k] = sight_of(k, width, height);
}

void Sights::reject_background(const Image& photo) {
  std::vector<float> red, green;
  for (const Sight& s : sights_) {
    if (s.facing < kFrontal || s.weight < 1) continue;
    const Vec2 c = chroma(photo_colour(photo, s.x));
    red.push_back(c.x);
    green.push_back(c.y);
  }
  const Spread r = spread_of(red), g = spread_of(green);
  const auto is_strange = [&](const Sight& s) {
    const Vec2 c = chroma(photo_colour(photo, s.x));
    const float dr = (c.x - r.middle) / max(r.sd, kLeastSpread),
                dg = (c.y - g.middle) / max(g.sd, kLeastSpread);
    const float limit = kStrangeAside + kStrangeSlope * max(0, s.facing - kSeen);
    return dr * dr + dg * dg > limit * limit;
  };
  std::vector<std::uint8_t> passable(sights_.size());
  for (std::size_t k = 0; k < sights_.size(); ++k)
    passable[k] = !sheet_.is_used(k) || sights_[k].weight <= 0 || is_strange(sights_[k]);
  fade_around(reached_from_rim(passable));
}

Sight Sights::at(Vec2 uv) const {
  const float x = clamp(uv.x, 0, 1) * kCells, y = clamp(uv.y, 0, 1) * kCells;
  const int i = std::min(static_cast<int>(x), kCells - 1), j = std::min(static_cast<int>(y), kCells - 1);
  const float a = x - static_cast<float>(i), b = y - static_cast<float>(j);
  Sight out;
  for (int k = 0; k < 4; ++k) {
    const Sight& s = sights_[sheet_.index(i + k % 2, j + k / 2)];
    const float share = (k % 2 ? a : 1 - a) * (k / 2 ? b : 1 - b);
    if (s.weight <= 0 && share > 0) return {};
    out.x = out.x + share * s.x;
    out.weight += share * s.weight;
  }
  return out;
}

/// Points that are joined to the rim of the chart through passable ones.
std::vector<std::uint8_t> Sights::reached_from_rim(const std::vector<std::uint8_t>& passable) const {
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

/// Takes the weight from these points, and some from those near them.
void Sights::fade_around(const std::vector<std::uint8_t>& given_up) {
  for (int j = 0; j <= kCells; ++j)
    for (int i = 0; i <= kCells; ++i) {
      if (given_up[sheet_.index(i, j)] == 0) continue;
      for (int b = std::max(0, j - kFaded); b <= std::min(kCells, j + kFaded); ++b)
        for (int a = std::max(0, i - kFaded); a <= std::min(kCells, i + kFaded); ++a) {
          Sight& s = sights_[sheet_.index(a, b)];
          const auto distance = std::hypot(static_cast<float>(a - i), static_cast<float>(b - j));
          s.weight = min(s.weight, clamp((distance - kMixed) / (kFaded - kMixed), 0, 1));
        }
    }
}

void Sights::draw_depth() {
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

Sight Sights::sight_of(std::size_t k, int width, int height) const {
  Sight sight;
  const Vec3 p = projector_.to_camera(sheet_.position(k));
  if (!projector_.project(sheet_.position(k), &sight.x)) return {};
  sight.x = lens_.distort(sight.x);
  if (!(sight.x.x >= 0 && sight.x.y >= 0 && sight.x.x <= static_cast<float>(width - 1) &&
        sight.x.y <= static_cast<float>(height - 1)))
    return {};
  const Vec2 d = to_depth(sight.x);
  const float nearest = raster_.inverse_depth(std::min(static_cast<int>(d.x + 0.5f), raster_.width() - 1),
                                              std::min(static_cast<int>(d.y + 0.5f), raster_.height() - 1));
  if (nearest > 0 && p.z > 1 / nearest + kDepthMargin) return {};
  sight.facing = -dot(projector_.rotated(sheet_.normal(k)), normalised(p));
  const float t = clamp((sight.facing - kUnseen) / (kSeen - kUnseen), 0, 1);
  sight.weight = t * t * (3 - 2 * t);
  return sight;
}

}  // namespace pliant::host
