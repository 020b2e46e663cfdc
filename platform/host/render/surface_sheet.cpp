#include "host/render/surface_sheet.hpp"

#include <algorithm>

#include "host/render/synthetic.hpp"

namespace pliant::host {

namespace {

int width_of(const Model& model) {
  return static_cast<int>(model.mask().width);
}
int height_of(const Model& model) {
  return static_cast<int>(model.mask().height);
}

/// Whether holes of the chart are eyes and mouths, where the surface goes on behind lids and lips.
bool has_lids_or_lips(const Model& model) {
  return std::any_of(model.curves().begin(), model.curves().end(),
                     [](const Curve& c) { return c.kind == CurveKind::lid || c.kind == CurveKind::lip; });
}

std::vector<std::uint8_t> inside_of(const ChartImage& mask) {
  std::vector<std::uint8_t> inside(std::size_t{mask.width} * mask.height);
  for (std::size_t k = 0; k < inside.size(); ++k) inside[k] = mask.pixels[k] != 0 ? 1 : 0;
  return inside;
}

}  // namespace

ChartTexture::ChartTexture(const Model& model)
    : albedo_(model.albedo()),
      mask_width_(model.mask().width),
      mask_height_(model.mask().height),
      cover_(smooth_cover(has_lids_or_lips(model)
                              ? without_holes(model.mask().pixels, width_of(model), height_of(model))
                              : inside_of(model.mask()),
                          width_of(model), height_of(model))) {}

float ChartTexture::albedo(Vec2 uv) const {
  return albedo_.pixels == nullptr ? 190.0f : chart_value(albedo_.pixels, albedo_.width, albedo_.height, uv);
}

bool ChartTexture::covers(Vec2 uv) const {
  // Almost everywhere the four pixels around tell, without interpolation.
  const auto i = static_cast<std::uint32_t>(clamp(uv.x, 0, 1) * static_cast<float>(mask_width_ - 1)),
             j = static_cast<std::uint32_t>(clamp(uv.y, 0, 1) * static_cast<float>(mask_height_ - 1));
  const std::size_t right = i + 1 < mask_width_ ? 1 : 0, down = j + 1 < mask_height_ ? mask_width_ : 0;
  const std::uint8_t* const p = cover_.data() + std::size_t{j} * mask_width_ + i;
  if (p[0] == 255 && p[right] == 255 && p[down] == 255 && p[down + right] == 255) return true;
  return cover(uv) >= 0.5f;
}

float ChartTexture::cover(Vec2 uv) const {
  return chart_value(cover_.data(), mask_width_, mask_height_, uv) / 255;
}

SurfaceSheet::SurfaceSheet(const Model& model, const ChartTexture& texture, int cells)
    : cascade_(model), cells_(cells) {
  cascade_->set_free(Group::expression);
  const std::size_t count = index(0, cells + 1);
  uv_.resize(count);
  position_.resize(count);
  normal_.resize(count);
  used_.resize(count);
  samples_.resize(count * cascade_->samples_per_point());
  const float step = 1.0f / static_cast<float>(cells);
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i)
      uv_[index(i, j)] = {min(static_cast<float>(i) * step, 1), min(static_cast<float>(j) * step, 1)};
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i) {
      if (texture.cover(uv_[index(i, j)]) <= 0) continue;
      for (int b = j > 0 ? j - 1 : 0; b <= j + 1 && b <= cells; ++b)
        for (int a = i > 0 ? i - 1 : 0; a <= i + 1 && a <= cells; ++a) used_[index(a, b)] = 1;
    }
}

void SurfaceSheet::sample_points(const float* q) {
  const auto parameters = cascade_->model().parameters();
  std::vector<float> identity;
  for (std::size_t k = 0; k < parameters.count; ++k)
    if (parameters[k].group == Group::identity) identity.push_back(q[k]);
  if (is_sampled_ && identity == sampled_for_) return;
  for (std::size_t k = 0; k < uv_.size(); ++k)
    if (is_used(k)) cascade_->sample_point(uv_[k], q, samples_.data() + k * cascade_->samples_per_point());
  sampled_for_ = identity;
  is_sampled_ = true;
}

void SurfaceSheet::set(const float* q) {
  sample_points(q);
  for (std::size_t k = 0; k < uv_.size(); ++k)
    if (is_used(k)) position_[k] = cascade_->evaluate(samples_.data() + k * cascade_->samples_per_point(), q);
  compute_normals();
}

void SurfaceSheet::compute_normals() {
  // Central differences over the used neighbours; one-sided at the boundary.
  const auto difference = [&](int i, int j, int di, int dj) {
    const int a = i + di, b = j + dj, c = i - di, d = j - dj;
    const bool has_next = a <= cells_ && b <= cells_ && is_used(index(a, b));
    const bool has_previous = c >= 0 && d >= 0 && is_used(index(c, d));
    return position_[has_next ? index(a, b) : index(i, j)] -
           position_[has_previous ? index(c, d) : index(i, j)];
  };
  for (int j = 0; j <= cells_; ++j)
    for (int i = 0; i <= cells_; ++i)
      if (is_used(index(i, j)))
        normal_[index(i, j)] = normalised(cross(difference(i, j, 0, 1), difference(i, j, 1, 0)));
}

}  // namespace pliant::host
