#include "host/render/overlay.hpp"

#include <algorithm>
#include <cmath>

#include "host/io/calibration.hpp"
#include "host/io/owned.hpp"
#include "pliant/visibility.hpp"

namespace pliant::host {

namespace {

constexpr Colour kMesh{96, 232, 214}, kMeshOnBright{0, 96, 110}, kLandmark{255, 206, 92},
    kMarker{255, 110, 150}, kGiven{255, 255, 255}, kUnused{255, 80, 70}, kGood{70, 190, 90},
    kFair{240, 170, 40}, kBad{225, 60, 50}, kEdge{0, 0, 0};

/// Grey level from which on the mesh is drawn dark; between the lumas of the two colours, 189 and 69; above the middle,
/// as skin changes colour less often so.
constexpr int kBright = 150;

/// Opacity of the mesh's lines, and the fraction of a face that they cover, at most.
constexpr float kMeshOpacity = 0.42f, kMostCovered = 0.2f;

/// Unit of the marks on a face, at most, as a fraction of its side. With it the dots of 68 landmarks cover 3 % of a face, and the
/// lines of the built-in face's mesh a quarter; with lines of one pixel a face of 40 pixels was not to be seen.
constexpr float kMostFaceUnit = 0.0075f;

constexpr Vec2 kNowhere{-1e9f, -1e9f}, kUnknown{-2e9f, -2e9f};

/// Whether a picture of three channels is bright at this place.
bool is_bright(const Image& image, Vec2 x) {
  if (!(x.x >= 0 && x.y >= 0 && x.x < static_cast<float>(image.width) &&
        x.y < static_cast<float>(image.height)))
    return false;
  const std::uint8_t* p = image.at(static_cast<int>(x.x), static_cast<int>(x.y));
  return 299 * p[0] + 587 * p[1] + 114 * p[2] >= 1000 * kBright;
}

/// Width of the pixels that a line of this width covers (draw_line): a thin one is as pale as it is thin.
float drawn_width(float width) {
  return width < 1 ? 0.25f * (1 + width) * (1 + width) : width;
}

}  // namespace

WireMesh wire_of(const Model& model, const FitFile& fit, const std::vector<float>& q) {
  Owned<Cascade> cascade(model);
  const Projector projector(view_of(fit.pose, fit.camera), true);
  const Lens lens = lens_of(fit.camera, {fit.width, fit.height});
  WireMesh mesh;
  for (const Vec2 uv : model.base_uv()) {
    Vec2 x = kNowhere;
    if (projector.project(cascade->surface_point(uv, q.data()), &x)) x = lens.distort(x);
    mesh.x.push_back(x);
  }
  const auto corners = model.base_corners();
  const Vec2* uv = model.base_uv().data;
  for (std::size_t i = 0; i + 2 < corners.count; i += 3) {
    const std::uint16_t a = corners[i], b = corners[i + 1], c = corners[i + 2];
    if (doubled_area(mesh.x[a], mesh.x[b], mesh.x[c]) * doubled_area(uv[a], uv[b], uv[c]) > 0)
      mesh.faces.push_back({a, b, c});
  }
  return mesh;
}

WireMesh wire_of(Estimator& estimator) {
  const Mesh& mesh = estimator.mesh();
  WireMesh wire;
  for (const FaceId f : mesh.faces()) {
    const std::array<std::uint16_t, 3> corners{mesh.corner(f, 0), mesh.corner(f, 1), mesh.corner(f, 2)};
    for (const std::uint16_t v : corners) {
      if (v >= wire.x.size()) wire.x.resize(v + std::size_t{1}, kUnknown);
      if (wire.x[v].x == kUnknown.x && !estimator.project(mesh.uv(v), &wire.x[v])) wire.x[v] = kNowhere;
    }
    const Vec2 *x = wire.x.data(), uv[] = {mesh.uv(corners[0]), mesh.uv(corners[1]), mesh.uv(corners[2])};
    if (doubled_area(x[corners[0]], x[corners[1]], x[corners[2]]) * doubled_area(uv[0], uv[1], uv[2]) > 0)
      wire.faces.push_back(corners);
  }
  return wire;
}

std::vector<std::optional<Vec2>> project_landmarks(const Model& model, Cascade& cascade, const Pose& pose,
                                                   const Camera& camera, const ImageSize& size,
                                                   const float* q) {
  const Projector projector(view_of(pose, camera), true);
  const Lens lens = lens_of(camera, size);
  std::vector<std::optional<Vec2>> out;
  for (const Landmark& landmark : model.landmarks()) {
    Vec2 x;
    const bool is_seen = projector.project(cascade.surface_point(landmark.uv(), q), &x);
    out.push_back(is_seen ? std::optional<Vec2>(lens.distort(x)) : std::nullopt);
  }
  return out;
}

Overlay::Overlay(const Image& picture)
    : scale_(picture.width < 480 ? 2 : 1), image_(to_colour(enlarged(picture, scale_))), face_unit_(unit()) {}

Vec2 Overlay::scaled(Vec2 x) const {
  const auto s = static_cast<float>(scale_);
  return {s * (x.x + 0.5f) - 0.5f, s * (x.y + 0.5f) - 0.5f};
}

void Overlay::set_face(float side) {
  face_unit_ = std::min(unit(), kMostFaceUnit * side);
}

void Overlay::draw_mesh(const WireMesh& mesh) {
  std::vector<std::array<std::uint16_t, 2>> edges;
  float area = 0;
  for (const auto& f : mesh.faces) {
    area += 0.5f * std::abs(doubled_area(scaled(mesh.x[f[0]]), scaled(mesh.x[f[1]]), scaled(mesh.x[f[2]])));
    for (std::size_t k = 0; k < 3; ++k)
      edges.push_back({std::min(f[k], f[(k + 1) % 3]), std::max(f[k], f[(k + 1) % 3])});
  }
  if (area > 0) set_face(std::sqrt(area));
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  float length_px = 0;
  for (const auto& [a, b] : edges) length_px += length(scaled(mesh.x[b]) - scaled(mesh.x[a]));
  const float covered = length_px * drawn_width(face_unit_) * kMeshOpacity / area;
  const float opacity = kMeshOpacity * (covered > kMostCovered ? kMostCovered / covered : 1);
  const Image below = image_;  // the colour of an edge must not depend on those that are drawn already
  for (const auto& [a, b] : edges) {
    const Vec2 from = scaled(mesh.x[a]), to = scaled(mesh.x[b]);
    draw_line(image_, from, to, face_unit_, is_bright(below, 0.5f * (from + to)) ? kMeshOnBright : kMesh,
              opacity);
  }
}

// Light marks have a dark edge, so that they are seen on bright pictures.
void Overlay::draw_landmark(Vec2 x) {
  draw_dot(image_, scaled(x), 2.3f * face_unit_, kEdge, 0.4f);
  draw_dot(image_, scaled(x), 1.6f * face_unit_, kLandmark, 0.95f);
}

void Overlay::draw_box(Vec2 centre, float side) {
  set_face(static_cast<float>(scale_) * side);
  const float half = side / 2;
  const Vec2 corners[] = {{-half, -half}, {half, -half}, {half, half}, {-half, half}};
  for (std::size_t k = 0; k < 4; ++k)
    draw_line(image_, scaled(centre + corners[k]), scaled(centre + corners[(k + 1) % 4]), 1.5f * unit(),
              kMarker, 0.9f);
}

void Overlay::draw_marker(Vec2 x) {
  draw_ring(image_, scaled(x), 3.5f * unit(), unit(), kMarker, 0.9f);
}

void Overlay::draw_residual(Vec2 given, Vec2 residual, bool used) {
  const Colour colour = used ? kGiven : kUnused;
  draw_ring(image_, scaled(given), 3.2f * unit(), 2.4f * unit(), kEdge, 0.4f);
  draw_line(image_, scaled(given), scaled(given + residual), 2.4f * unit(), kEdge, 0.4f);
  draw_ring(image_, scaled(given), 3.2f * unit(), unit(), colour, 0.8f);
  draw_line(image_, scaled(given), scaled(given + residual), unit(), colour, 0.8f);
}

void Overlay::draw_caption(const std::string& text) {
  const float scale = std::max(1.3f, static_cast<float>(image_.width) / 340);
  const int margin = static_cast<int>(2.5f * scale), border = 4;
  const int height = static_cast<int>(kTextHeight * scale) + 2 * margin;
  const int y = image_.height - border - height;
  fill_box(image_, {border, y, text_width(text, scale) + 2 * margin, height}, {0, 0, 0}, 0.55f);
  draw_text(image_, border + margin, y + margin, text, {scale, {255, 255, 255}, 0.95f});
}

void Overlay::draw_state(TrackState state) {
  draw_border(image_, 4,
              state == TrackState::tracking   ? kGood
              : state == TrackState::degraded ? kFair
                                              : kBad);
}

}  // namespace pliant::host
