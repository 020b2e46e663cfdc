#include "face/rendered_template.hpp"

#include "face/face_detector_tuning.hpp"
#include "pliant/visibility.hpp"
#include "vision/bilinear.hpp"

namespace pliant {

namespace {

constexpr const FaceDetectorTuning& kTuning = kFaceDetectorTuning;
constexpr float kFar = 1e9f;

}  // namespace

void RenderedTemplate::lay_out(Arena& arena, const Model& model) {
  cascade_.lay_out(arena, model);
  albedo_ = arena.take<std::uint8_t>(kAlbedoSide * kAlbedoSide);
  grey_ = arena.take<std::uint8_t>(kPixels);
  inner_ = arena.take<std::uint8_t>(kPixels);
  depth_ = arena.take<float>(kPixels);
  const std::size_t vertices = model.base_uv().count;
  position_ = arena.take<Vec3>(vertices);
  normal_ = arena.take<Vec3>(vertices);
  place_ = arena.take<Vec2>(vertices);
  corner_ = arena.take<Corner>(vertices);
  rest_ = arena.take<float>(model.parameters().count);
}

// Means over cells of the chart.
void RenderedTemplate::reduce_albedo() {
  const ChartImage from = cascade_.model().albedo();
  for (std::uint32_t j = 0; j < kAlbedoSide; ++j)
    for (std::uint32_t i = 0; i < kAlbedoSide; ++i) {
      const std::uint32_t x0 = i * from.width / kAlbedoSide, x1 = (i + 1) * from.width / kAlbedoSide;
      const std::uint32_t y0 = j * from.height / kAlbedoSide, y1 = (j + 1) * from.height / kAlbedoSide;
      std::uint32_t sum = 0, count = 0;
      for (std::uint32_t y = y0; y < (y1 > y0 ? y1 : y0 + 1); ++y)
        for (std::uint32_t x = x0; x < (x1 > x0 ? x1 : x0 + 1); ++x, ++count)
          sum += from.pixels[y * from.width + x];
      albedo_[j * kAlbedoSide + i] = static_cast<std::uint8_t>(sum / count);
    }
}

bool RenderedTemplate::find_region() {
  const Model& model = cascade_.model();
  Vec2 low{1e9f, 1e9f}, high{-1e9f, -1e9f};
  float front = 0;
  std::size_t count = 0;
  for (const Curve& curve : model.curves()) {
    if (curve.kind == CurveKind::boundary) continue;
    for (std::size_t k = 0; k < curve.point_count; ++k, ++count) {
      const Vec3 p = cascade_.surface_point(model.curve_points()[curve.first_point + k], rest_);
      low = {min(low.x, p.x), min(low.y, p.y)};
      high = {max(high.x, p.x), max(high.y, p.y)};
      front += p.z;
    }
  }
  if (count == 0) return false;
  low = low - Vec2{kTuning.margin_beside_mm, kTuning.margin_below_mm};
  high = high + Vec2{kTuning.margin_beside_mm, kTuning.margin_beside_mm};
  half_ = 0.5f * (high - low);
  middle_ = {0.5f * (low.x + high.x), 0.5f * (low.y + high.y), front / static_cast<float>(count)};
  return half_.x > 0 && half_.y > 0;
}

Status RenderedTemplate::prepare() {
  const Model& model = cascade_.model();
  for (std::size_t k = 0; k < model.parameters().count; ++k) rest_[k] = 0;
  if (model.albedo().pixels == nullptr || !find_region()) return Status::not_found;
  reduce_albedo();
  set(rest_);
  for (std::size_t v = 0; v < model.base_uv().count; ++v)
    place_[v] = {position_[v].x - middle_.x, position_[v].y - middle_.y};
  return Status::ok;
}

void RenderedTemplate::set(const float* q) {
  const Model& model = cascade_.model();
  const std::size_t vertices = model.base_uv().count;
  cascade_.select(q);
  for (std::size_t v = 0; v < vertices; ++v) {
    position_[v] = cascade_.selected_point(model.base_uv()[v]);
    normal_[v] = {};
  }
  const Span<const std::uint16_t> corners = model.base_corners();
  for (std::size_t f = 0; f + 2 < corners.count; f += 3) {
    const Vec3 a = position_[corners[f]], b = position_[corners[f + 1]], c = position_[corners[f + 2]];
    Vec3 n = cross(b - a, c - a);
    const Vec2* uv = model.base_uv().data;
    // Seen from outside, v points down and u to the right: the sign of the chart's area is the winding of the face.
    if (doubled_area(uv[corners[f]], uv[corners[f + 1]], uv[corners[f + 2]]) > 0) n = -1.0f * n;
    for (std::size_t k = 0; k < 3; ++k) normal_[corners[f + k]] = normal_[corners[f + k]] + n;
  }
  for (std::size_t v = 0; v < vertices; ++v) normal_[v] = normalised(normal_[v]);
}

float RenderedTemplate::albedo_at(Vec2 uv) const {
  const float x = clamp(uv.x * kAlbedoSide - 0.5f, 0, kAlbedoSide - 1.001f),
              y = clamp(uv.y * kAlbedoSide - 0.5f, 0, kAlbedoSide - 1.001f);
  const int i = static_cast<int>(x), j = static_cast<int>(y);
  const std::uint8_t* p = albedo_ + j * kAlbedoSide + i;
  return bilinear(p, p + kAlbedoSide, 1, x - static_cast<float>(i), y - static_cast<float>(j));
}

void RenderedTemplate::draw(const View& view, Vec3 light) {
  constexpr float kAmbient = kTuning.ambient_light;
  const Model& model = cascade_.model();
  const Projector projector(view, true);
  for (int k = 0; k < kPixels; ++k) {
    grey_[k] = std::uint8_t{kTuning.background_grey};
    inner_[k] = 0;
    depth_[k] = kFar;
  }
  for (std::size_t v = 0; v < model.base_uv().count; ++v) {
    Corner& c = corner_[v];
    c.uv = model.base_uv()[v];
    c.place = place_[v];
    c.depth = projector.project(position_[v], &c.x) ? projector.to_camera(position_[v]).z : -1;
    c.light = kAmbient + (1 - kAmbient) * max(0, dot(projector.rotated(normal_[v]), light));
  }
  const Span<const std::uint16_t> corners = model.base_corners();
  for (std::size_t f = 0; f + 2 < corners.count; f += 3)
    draw_face(corner_[corners[f]], corner_[corners[f + 1]], corner_[corners[f + 2]]);
  clear_silhouette();
}

// Takes pixels close to the silhouette out of the inner face: gradients there depend on the background.
void RenderedTemplate::clear_silhouette() {
  constexpr int kReach = kTuning.silhouette_margin_px;
  const auto is_empty = [this](int x, int y) { return depth_[y * kSide + x] >= kFar; };
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      std::uint8_t& inner = inner_[y * kSide + x];
      if (inner == 0) continue;
      const bool is_inside = x >= kReach && y >= kReach && x + kReach < kSide && y + kReach < kSide;
      if (!is_inside || is_empty(x - kReach, y) || is_empty(x + kReach, y) || is_empty(x, y - kReach) ||
          is_empty(x, y + kReach))
        inner = 0;
    }
}

void RenderedTemplate::draw_face(const Corner& a, const Corner& b, const Corner& c) {
  if (a.depth <= 0 || b.depth <= 0 || c.depth <= 0) return;
  const float area = doubled_area(a.x, b.x, c.x);
  const bool faces = area * doubled_area(a.uv, b.uv, c.uv) > 0;
  if (!faces || magnitude(area) < 1e-6f) return;
  const float last = static_cast<float>(kSide - 1);
  const int i0 = static_cast<int>(clamp(min(a.x.x, min(b.x.x, c.x.x)), 0, last)),
            i1 = static_cast<int>(clamp(max(a.x.x, max(b.x.x, c.x.x)) + 1, 0, last)),
            j0 = static_cast<int>(clamp(min(a.x.y, min(b.x.y, c.x.y)), 0, last)),
            j1 = static_cast<int>(clamp(max(a.x.y, max(b.x.y, c.x.y)) + 1, 0, last));
  for (int j = j0; j <= j1; ++j)
    for (int i = i0; i <= i1; ++i) {
      const Vec2 x{static_cast<float>(i), static_cast<float>(j)};
      const float wa = doubled_area(b.x, c.x, x) / area, wb = doubled_area(c.x, a.x, x) / area,
                  wc = 1 - wa - wb;
      if (wa < 0 || wb < 0 || wc < 0) continue;
      const float depth = wa * a.depth + wb * b.depth + wc * c.depth;
      const int at = j * kSide + i;
      if (depth >= depth_[at]) continue;
      depth_[at] = depth;
      const Vec2 uv = wa * a.uv + wb * b.uv + wc * c.uv, place = wa * a.place + wb * b.place + wc * c.place;
      const float light = wa * a.light + wb * b.light + wc * c.light;
      grey_[at] = static_cast<std::uint8_t>(clamp(light * albedo_at(uv) + 0.5f, 0, 255));
      inner_[at] = magnitude(place.x) < half_.x && magnitude(place.y) < half_.y;
    }
}

}  // namespace pliant
