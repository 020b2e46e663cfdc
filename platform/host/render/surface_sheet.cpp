#include "host/render/surface_sheet.hpp"

#include <algorithm>

namespace pliant::host {

namespace {

/// Bilinear value at (u,v) of an image over the chart, first and last pixels at 0 and 1.
float bilinear(const std::uint8_t* pixels, std::uint32_t width, std::uint32_t height, Vec2 uv) {
  const float x = clamp(uv.x, 0, 1) * static_cast<float>(width - 1),
              y = clamp(uv.y, 0, 1) * static_cast<float>(height - 1);
  const auto i = static_cast<std::uint32_t>(x), j = static_cast<std::uint32_t>(y);
  const std::uint32_t i1 = i + 1 < width ? i + 1 : i, j1 = j + 1 < height ? j + 1 : j;
  const float fx = x - static_cast<float>(i), fy = y - static_cast<float>(j);
  const auto at = [&](std::uint32_t a, std::uint32_t b) {
    return static_cast<float>(pixels[std::size_t{b} * width + a]);
  };
  const float top = at(i, j) * (1 - fx) + at(i1, j) * fx;
  return top * (1 - fy) + (at(i, j1) * (1 - fx) + at(i1, j1) * fx) * fy;
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

/// Zeros that are connected to the border are outside. All other zeros are holes and count as inside.
std::vector<std::uint8_t> fill_holes(const ChartImage& mask) {
  const int width = static_cast<int>(mask.width), height = static_cast<int>(mask.height);
  const auto index = [&](int x, int y) {
    return static_cast<std::size_t>(y) * mask.width + static_cast<std::size_t>(x);
  };
  std::vector<std::uint8_t> inside(index(0, height), 1);
  std::vector<std::pair<int, int>> stack;
  const auto visit = [&](int x, int y) {
    if (x < 0 || y < 0 || x >= width || y >= height) return;
    if (mask.pixels[index(x, y)] != 0 || inside[index(x, y)] == 0) return;
    inside[index(x, y)] = 0;
    stack.emplace_back(x, y);
  };
  for (int x = 0; x < width; ++x) visit(x, 0), visit(x, height - 1);
  for (int y = 0; y < height; ++y) visit(0, y), visit(width - 1, y);
  while (!stack.empty()) {
    const auto [x, y] = stack.back();
    stack.pop_back();
    visit(x - 1, y), visit(x + 1, y), visit(x, y - 1), visit(x, y + 1);
  }
  return inside;
}

/// Mean over 5 x 5 pixels of 0 and 255. Its contour at 1/2 is the boundary without the steps of the mask.
std::vector<std::uint8_t> smoothed(const std::vector<std::uint8_t>& inside, std::uint32_t width,
                                   std::uint32_t height) {
  std::vector<std::uint8_t> out(inside.size());
  const auto limited = [](int x, std::uint32_t size) {
    return static_cast<std::size_t>(std::clamp(x, 0, static_cast<int>(size) - 1));
  };
  for (int y = 0; y < static_cast<int>(height); ++y)
    for (int x = 0; x < static_cast<int>(width); ++x) {
      int sum = 0;
      for (int j = -2; j <= 2; ++j)
        for (int i = -2; i <= 2; ++i) sum += inside[limited(y + j, height) * width + limited(x + i, width)];
      out[limited(y, height) * width + limited(x, width)] = static_cast<std::uint8_t>(sum * 255 / 25);
    }
  return out;
}

}  // namespace

ChartTexture::ChartTexture(const Model& model)
    : albedo_(model.albedo()),
      mask_width_(model.mask().width),
      mask_height_(model.mask().height),
      cover_(smoothed(has_lids_or_lips(model) ? fill_holes(model.mask()) : inside_of(model.mask()), mask_width_,
                      mask_height_)) {}

float ChartTexture::albedo(Vec2 uv) const {
  return albedo_.pixels == nullptr ? 190.0f : bilinear(albedo_.pixels, albedo_.width, albedo_.height, uv);
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
  return bilinear(cover_.data(), mask_width_, mask_height_, uv) / 255;
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

void SurfaceSheet::bake(const float* q) {
  const auto parameters = cascade_->model().parameters();
  std::vector<float> identity;
  for (std::size_t k = 0; k < parameters.count; ++k)
    if (parameters[k].group == Group::identity) identity.push_back(q[k]);
  if (is_baked_ && identity == sampled_for_) return;
  for (std::size_t k = 0; k < uv_.size(); ++k)
    if (is_used(k)) cascade_->sample_point(uv_[k], q, samples_.data() + k * cascade_->samples_per_point());
  sampled_for_ = identity;
  is_baked_ = true;
}

void SurfaceSheet::set(const float* q) {
  bake(q);
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
