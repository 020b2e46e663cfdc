#include "cli/photo_texture.hpp"

#include <algorithm>
#include <cmath>

#include "cli/calibration.hpp"
#include "cli/raster.hpp"
#include "cli/shown_mesh.hpp"
#include "cli/surface_sheet.hpp"
#include "pliant/camera.hpp"

namespace pliant::cli {

namespace {

constexpr int kCells = 256, kVertices = 4000;
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
/// What the other side of the face counts where this one is not seen at all.
constexpr float kMirrorShare = 0.9f;
/// Mean distance (mm) of mirrored points up to which a model counts as its own mirror image.
constexpr float kAsymmetry = 2;

struct Sight {
  Vec2 x;            // in the photograph, px
  float weight = 0;  // 0: not seen; 1: seen well
  float facing = 0;  // cosine of normal and line of sight
};

Vec3 sample(const Image& photo, Vec2 x) {
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

/// Where each point of the sheet is seen.
class Sights {
 public:
  Sights(const Model& model, const FitFile& fit, const std::vector<float>& q, int width, int height)
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

  /// Gives up what turns aside, has another colour than the rest of the face, and is joined to the outline: background,
  /// where the model is wider than the person. Hair over the forehead stays.
  void reject_background(const Image& photo) {
    std::vector<float> red, green;
    for (const Sight& s : sights_) {
      if (s.facing < kFrontal || s.weight < 1) continue;
      const Vec2 c = chroma(sample(photo, s.x));
      red.push_back(c.x);
      green.push_back(c.y);
    }
    const Spread r = spread_of(red), g = spread_of(green);
    const auto is_strange = [&](const Sight& s) {
      const Vec2 c = chroma(sample(photo, s.x));
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

  /// Interpolated at (u,v).
  Sight at(Vec2 uv) const {
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

 private:
  /// Points that are joined to the rim of the chart through passable ones.
  std::vector<std::uint8_t> reached_from_rim(const std::vector<std::uint8_t>& passable) const {
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
  void fade_around(const std::vector<std::uint8_t>& given_up) {
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

  Vec2 to_depth(Vec2 x) const { return scale_ * x; }

  void draw_depth() {
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
    for (int j = 0; j < kCells; ++j)
      for (int i = 0; i < kCells; ++i) {
        triangle(sheet_.index(i, j), sheet_.index(i + 1, j), sheet_.index(i, j + 1));
        triangle(sheet_.index(i + 1, j), sheet_.index(i + 1, j + 1), sheet_.index(i, j + 1));
      }
  }

  Sight sight_of(std::size_t k, int width, int height) const {
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

  ChartTexture texture_;
  SurfaceSheet sheet_;
  Projector projector_;
  Lens lens_;
  float scale_;
  Raster raster_;
  std::vector<Sight> sights_;
};

/// A colour that counts so much; the colour is weighted already.
struct Texel {
  Vec3 colour;
  float weight = 0;
};

struct Layer {
  int side;
  std::vector<Texel> texels;
  explicit Layer(int s) : side(s), texels(static_cast<std::size_t>(s) * static_cast<std::size_t>(s)) {}
  Texel& at(int i, int j) { return texels[index(i, j)]; }
  const Texel& at(int i, int j) const { return texels[index(i, j)]; }

 private:
  std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(side) + static_cast<std::size_t>(i);
  }
};

bool is_symmetric(const Model& model) {
  Owned<Cascade> cascade(model);
  const std::vector<float> mean(model.parameters().count, 0.0f);
  cascade->select(mean.data());
  float sum = 0;
  for (const Vec2 uv : model.base_uv()) {
    const Vec3 p = cascade->selected_point(uv), q = cascade->selected_point({1 - uv.x, uv.y});
    sum += length(p - Vec3{-q.x, q.y, q.z});
  }
  return sum <= kAsymmetry * static_cast<float>(model.base_uv().count);
}

void add_mirrored(Layer& layer) {
  const Layer seen = layer;
  for (int j = 0; j < layer.side; ++j)
    for (int i = 0; i < layer.side; ++i) {
      Texel& texel = layer.at(i, j);
      const Texel& other = seen.at(layer.side - 1 - i, j);
      const float share = kMirrorShare * (1 - texel.weight);
      texel.colour = texel.colour + share * other.colour;
      texel.weight += share * other.weight;
    }
}

/// Fills what is not seen from ever coarser means of what is: down by halves, and up again.
void continue_smoothly(Layer& layer) {
  if (layer.side < 2) return;
  Layer half((layer.side + 1) / 2);
  for (int j = 0; j < layer.side; ++j)
    for (int i = 0; i < layer.side; ++i) {
      Texel& sum = half.at(i / 2, j / 2);
      sum.colour = sum.colour + layer.at(i, j).colour;
      sum.weight += layer.at(i, j).weight;
    }
  for (Texel& t : half.texels)
    if (t.weight > 1) t = {1 / t.weight * t.colour, 1};
  continue_smoothly(half);
  for (int j = 0; j < layer.side; ++j)
    for (int i = 0; i < layer.side; ++i) {
      Texel& texel = layer.at(i, j);
      if (texel.weight >= 1) continue;
      // Bilinear between the coarser texels, whose centres lie half-way between pairs of these.
      const int i0 = std::clamp((i - 1) / 2, 0, half.side - 1),
                j0 = std::clamp((j - 1) / 2, 0, half.side - 1);
      const int i1 = std::min(i0 + 1, half.side - 1), j1 = std::min(j0 + 1, half.side - 1);
      const float a = i % 2 ? 0.25f : 0.75f, b = j % 2 ? 0.25f : 0.75f;
      const float share[] = {(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b};
      const Texel* from[] = {&half.at(i0, j0), &half.at(i1, j0), &half.at(i0, j1), &half.at(i1, j1)};
      Texel mean;
      for (int k = 0; k < 4; ++k) {
        mean.colour = mean.colour + share[k] * from[k]->colour;
        mean.weight += share[k] * from[k]->weight;
      }
      if (mean.weight > 0) texel.colour = texel.colour + (1 - texel.weight) / mean.weight * mean.colour;
      if (mean.weight > 0) texel.weight = 1;
    }
}

/// Behind lips and lids that are closed in the photograph: darkened as the model's own paint is there.
void add_shade(Layer& layer, const std::vector<Texel>& seen, const Model& model) {
  const ChartTexture texture(model);
  float skin = 0;
  for (const Vec2 uv : model.base_uv())
    skin += texture.albedo(uv) / static_cast<float>(model.base_uv().count);
  for (std::size_t k = 0; k < seen.size(); ++k) {
    const auto side = static_cast<std::size_t>(layer.side);
    const Vec2 uv{(static_cast<float>(k % side) + 0.5f) / static_cast<float>(side),
                  (static_cast<float>(k / side) + 0.5f) / static_cast<float>(side)};
    if (model.is_on_surface(uv) || !texture.covers(uv)) continue;
    const float shade = min(1, texture.albedo(uv) / max(skin, 1)), unseen = clamp(1 - seen[k].weight, 0, 1);
    layer.texels[k].colour = (1 - unseen + unseen * shade) * layer.texels[k].colour;
  }
}

}  // namespace

std::string textured_glb(const Model& model, const FitFile& fit, const std::vector<float>& q,
                         const Image& photo) {
  ModelSurface surface(model, q);
  const MeshData mesh = closed_mesh(ModelMesh(model, surface, {MeshCriterion::contour, 12, 0, kVertices}));
  return glb_bytes(
      mesh, encode_jpeg(photo_texture(model, fit, q, photo, kPhotoTextureSide), kPhotoTextureQuality), false);
}

Image photo_texture(const Model& model, const FitFile& fit, const std::vector<float>& q, const Image& photo,
                    int side) {
  Sights sights(model, fit, q, photo.width, photo.height);
  sights.reject_background(photo);
  Layer layer(side);
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      const Sight sight = sights.at({(static_cast<float>(i) + 0.5f) / static_cast<float>(side),
                                     (static_cast<float>(j) + 0.5f) / static_cast<float>(side)});
      if (sight.weight > 0) layer.at(i, j) = {sight.weight * sample(photo, sight.x), sight.weight};
    }
  if (is_symmetric(model)) add_mirrored(layer);
  const std::vector<Texel> seen = layer.texels;
  continue_smoothly(layer);
  if (model.albedo().pixels != nullptr) add_shade(layer, seen, model);
  Image out(side, side, 3);
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      const Vec3 c = layer.at(i, j).colour;
      const float values[] = {c.x, c.y, c.z};
      for (int k = 0; k < 3; ++k)
        out.at(i, j)[k] = static_cast<std::uint8_t>(clamp(values[k], 0, 255) + 0.5f);
    }
  return out;
}

}  // namespace pliant::cli
