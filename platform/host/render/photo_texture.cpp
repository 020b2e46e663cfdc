#include "host/render/photo_texture.hpp"

#include <algorithm>

#include "host/io/owned.hpp"
#include "host/render/shown_mesh.hpp"
#include "host/render/surface_sheet.hpp"
#include "host/render/view_rays.hpp"

namespace pliant::host {

namespace {

/// Tuning of the texture. Chosen by eye on fitted photographs; no experiment.
struct PhotoTextureTuning {
  /// Vertices of the mesh in the glTF file, count, at most.
  int vertices = 4000;
  /// Weight of the mirror image where a point itself is not visible, 0 to 1.
  float mirror_weight = 0.9f;
  /// Mean distance of mirrored points up to which a model counts as symmetric, millimetres.
  float asymmetry_mm = 2;
};
constexpr PhotoTextureTuning kTuning{};

/// A colour multiplied by its weight, and the weight.
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
  return sum <= kTuning.asymmetry_mm * static_cast<float>(model.base_uv().count);
}

void add_mirrored(Layer& layer) {
  const Layer seen = layer;
  for (int j = 0; j < layer.side; ++j)
    for (int i = 0; i < layer.side; ++i) {
      Texel& texel = layer.at(i, j);
      const Texel& other = seen.at(layer.side - 1 - i, j);
      const float weight = kTuning.mirror_weight * (1 - texel.weight);
      texel.colour = texel.colour + weight * other.colour;
      texel.weight += weight * other.weight;
    }
}

/// Fills texels without weight from averages over ever larger blocks (pull-push).
void fill_gaps(Layer& layer) {
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
  fill_gaps(half);
  for (int j = 0; j < layer.side; ++j)
    for (int i = 0; i < layer.side; ++i) {
      Texel& texel = layer.at(i, j);
      if (texel.weight >= 1) continue;
      // Bilinear between the coarser texels, whose centres lie midway between two of these.
      const int i0 = std::max((i - 1) / 2, 0), j0 = std::max((j - 1) / 2, 0);
      const int i1 = std::min((i + 1) / 2, half.side - 1), j1 = std::min((j + 1) / 2, half.side - 1);
      const float a = i % 2 ? 0.25f : 0.75f, b = j % 2 ? 0.25f : 0.75f;
      const float weight[] = {(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b};
      const Texel* from[] = {&half.at(i0, j0), &half.at(i1, j0), &half.at(i0, j1), &half.at(i1, j1)};
      Texel mean;
      for (int k = 0; k < 4; ++k) {
        mean.colour = mean.colour + weight[k] * from[k]->colour;
        mean.weight += weight[k] * from[k]->weight;
      }
      if (mean.weight > 0) texel.colour = texel.colour + (1 - texel.weight) / mean.weight * mean.colour;
      if (mean.weight > 0) texel.weight = 1;
    }
}

/// Darkens openings (behind closed lips and lids) as the model's albedo is darkened there.
void add_shade(Layer& layer, const std::vector<Texel>& seen, const Model& model) {
  const ChartTexture texture(model);
  float mean = 0;
  for (const Vec2 uv : model.base_uv())
    mean += texture.albedo(uv) / static_cast<float>(model.base_uv().count);
  for (std::size_t k = 0; k < seen.size(); ++k) {
    const auto side = static_cast<std::size_t>(layer.side);
    const Vec2 uv{(static_cast<float>(k % side) + 0.5f) / static_cast<float>(side),
                  (static_cast<float>(k / side) + 0.5f) / static_cast<float>(side)};
    if (model.is_on_surface(uv) || !texture.covers(uv)) continue;
    const float shade = min(1, texture.albedo(uv) / max(mean, 1)), unseen = clamp(1 - seen[k].weight, 0, 1);
    layer.texels[k].colour = (1 - unseen + unseen * shade) * layer.texels[k].colour;
  }
}

}  // namespace

std::string textured_glb(const Model& model, const FitFile& fit, const std::vector<float>& q,
                         const Image& photo) {
  ModelSurface surface(model, q);
  const MeshData mesh =
      closed_mesh(ModelMesh(model, surface, {MeshCriterion::contour, 12, 0, kTuning.vertices}));
  return glb_bytes(
      mesh, encode_jpeg(photo_texture(model, fit, q, photo, kPhotoTextureSide), kPhotoTextureQuality), false);
}

Image photo_texture(const Model& model, const FitFile& fit, const std::vector<float>& q, const Image& photo,
                    int side) {
  ViewRays rays(model, fit, q, photo.width, photo.height);
  rays.reject_background(photo);
  Layer layer(side);
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      const ViewRay ray = rays.at({(static_cast<float>(i) + 0.5f) / static_cast<float>(side),
                                   (static_cast<float>(j) + 0.5f) / static_cast<float>(side)});
      if (ray.weight > 0) layer.at(i, j) = {ray.weight * photo_colour(photo, ray.x), ray.weight};
    }
  if (is_symmetric(model)) add_mirrored(layer);
  const std::vector<Texel> seen = layer.texels;
  fill_gaps(layer);
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

}  // namespace pliant::host
