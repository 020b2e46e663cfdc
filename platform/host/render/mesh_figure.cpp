#include "host/render/mesh_figure.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

#include "host/io/bounding_box.hpp"
#include "host/io/level_tints.hpp"
#include "host/render/draw.hpp"
#include "host/render/raster.hpp"
#include "host/render/surface_sheet.hpp"

namespace pliant::host {

namespace {

constexpr int kWidth = 232, kHeight = 280, kSpace = 8, kCaption = 52;
constexpr Colour kInk{40, 40, 44}, kFaint{215, 60, 60};

/// An orthographic view of the model, turned by 25 degrees and scaled to a panel.
class Viewpoint {
 public:
  explicit Viewpoint(const ModelMesh& mesh) {
    BoundingBox<Vec2> box;
    for (const VertexId v : mesh.mesh().vertices()) {
      const Vec3 at = turned(mesh.position(v));
      box.add({at.x, at.y});
    }
    centre_ = 0.5f * (box.low + box.high);
    scale_ = 0.96f * min(kWidth / box.size().x, kHeight / box.size().y);
  }
  /// View axes: y up, z to the viewer.
  static Vec3 turned(Vec3 p) {
    constexpr float kCos = 0.90630779f, kSin = 0.42261826f;  // 25 degrees
    return {kCos * p.x + kSin * p.z, p.y, kCos * p.z - kSin * p.x};
  }
  RasterVertex corner(Vec3 p, Vec2 uv, float light) const {
    const Vec3 t = turned(p);
    const Vec2 x{0.5f * (kWidth - 1) + scale_ * (t.x - centre_.x),
                 0.5f * (kHeight - 1) - scale_ * (t.y - centre_.y)};
    return {x, 1 / (10000 - t.z), uv, light};  // far away, so that depth is nearly linear
  }

 private:
  Vec2 centre_;
  float scale_ = 1;
};

float drawn_light(Vec3 n) {
  static const Vec3 key = normalised(Vec3{-0.5f, 0.55f, 0.9f});
  return 0.3f + 0.7f * max(0, (dot(Viewpoint::turned(n), key) + 0.15f) / 1.15f);
}

Image picture_of(const Raster& raster) {
  Image image(raster.width(), raster.height(), 1);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      *image.at(x, y) = static_cast<std::uint8_t>(clamp(raster.value(x, y, 255) + 0.5f, 0, 255));
  return to_colour(image);
}

struct Corners {
  std::array<Vec3, 3> p;
  std::array<Vec2, 3> uv;
};

Corners corners_of(const ModelMesh& mesh, FaceId f) {
  Corners c;
  for (int k = 0; k < 3; ++k) {
    const VertexId v = mesh.mesh().corner(f, k);
    c.p[static_cast<std::size_t>(k)] = mesh.position(v);
    c.uv[static_cast<std::size_t>(k)] = mesh.mesh().uv(v);
  }
  return c;
}

/// Draws flat faces with dark edges and hidden surfaces removed; with `blocks_only` without subdivision edges.
Image draw_wire(const ModelMesh& mesh, const Viewpoint& view, bool blocks_only) {
  Raster raster(kWidth, kHeight, 3);
  raster.clear();
  for (const FaceId f : mesh.mesh().faces()) {
    const Corners c = corners_of(mesh, f);
    const float light = drawn_light(normalised(cross(c.p[1] - c.p[0], c.p[2] - c.p[0])));
    // Two barycentric coordinates take the place of (u,v); they give the distance to each edge.
    const RasterVertex a = view.corner(c.p[0], {1, 0}, light), b = view.corner(c.p[1], {0, 1}, light),
                       d = view.corner(c.p[2], {0, 0}, light);
    const Vec2 ab = b.x - a.x, ad = d.x - a.x;
    const float area = magnitude(ab.x * ad.y - ab.y * ad.x);
    const bool is_whole = mesh.mesh().twin(Mesh::half_edge(f, 0)) != kNone;
    const float height[3] = {area / max(length(d.x - b.x), 1e-6f), area / max(length(ad), 1e-6f),
                             blocks_only && is_whole ? 1e6f : area / max(length(ab), 1e-6f)};
    raster.draw(a, b, d, [&](Vec2 w, float, float* grey) {
      const float third = 1 - w.x - w.y;
      const float edge = std::min({w.x * height[0], w.y * height[1], max(third, 0) * height[2]});
      *grey = edge < 0.35f ? 60 : 250 * min(light, 1);
      return true;
    });
  }
  return picture_of(raster);
}

/// Draws the surface with smooth light and the model's albedo.
Image draw_textured(const ModelMesh& mesh, const Viewpoint& view, const ChartTexture& texture) {
  std::vector<RasterVertex> corner(mesh.mesh().limits().vertices);
  for (const VertexId v : mesh.mesh().vertices()) {
    const Vec2 uv = mesh.mesh().uv(v);
    corner[v] = view.corner(mesh.position(v), uv, drawn_light(mesh.surface().normal(uv)));
  }
  Raster raster(kWidth, kHeight, 2);
  raster.clear();
  const auto shade = [&](Vec2 uv, float light, float* grey) {
    *grey = min(250, 1.25f * texture.albedo(uv) * light);
    return true;
  };
  for (const FaceId f : mesh.mesh().faces())
    raster.draw(corner[mesh.mesh().corner(f, 0)], corner[mesh.mesh().corner(f, 1)],
                corner[mesh.mesh().corner(f, 2)], shade);
  return picture_of(raster);
}

void fill_triangle(Image& image, const std::array<Vec2, 3>& x, Colour colour) {
  const auto side = [](Vec2 a, Vec2 b, Vec2 p) {
    return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
  };
  const auto [left, right] = std::minmax({x[0].x, x[1].x, x[2].x});
  const auto [top, bottom] = std::minmax({x[0].y, x[1].y, x[2].y});
  for (int j = static_cast<int>(top); j <= static_cast<int>(bottom) + 1; ++j)
    for (int i = static_cast<int>(left); i <= static_cast<int>(right) + 1; ++i) {
      const Vec2 p{static_cast<float>(i), static_cast<float>(j)};
      const float a = side(x[0], x[1], p), b = side(x[1], x[2], p), c = side(x[2], x[0], p);
      if ((a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0)) blend(image, i, j, colour, 1);
    }
}

/// Draws the mesh over (u,v), each face in the colour of its level; with `shows_blocks` subdivision edges are red.
Image draw_chart(const ModelMesh& adapted, bool shows_blocks) {
  const Mesh& mesh = adapted.mesh();
  Image image(kWidth, kHeight, 3, 255);
  const auto place = [](Vec2 uv) { return Vec2{uv.x * (kWidth - 1), uv.y * (kHeight - 1)}; };
  for (const FaceId f : mesh.faces()) {
    const Corners c = corners_of(adapted, f);
    fill_triangle(image, {place(c.uv[0]), place(c.uv[1]), place(c.uv[2])}, level_tint(mesh.face_level(f)));
  }
  for (const FaceId f : mesh.faces())
    for (int k = 0; k < 3; ++k) {
      const HalfEdgeId h = Mesh::half_edge(f, k);
      if (!mesh.represents_edge(h) && !mesh.is_boundary_edge(h)) continue;
      const bool is_inner = shows_blocks && k == 0 && !mesh.is_boundary_edge(h);
      draw_line(image, place(mesh.uv(mesh.origin(h))), place(mesh.uv(mesh.destination(h))), 0.4f,
                is_inner ? kFaint : kInk, is_inner ? 0.9f : 0.7f);
    }
  return image;
}

void draw_caption(Image& figure, int x, int y, const char* title, const ModelMesh& mesh) {
  const ContourError error = mesh.measure();
  char text[2][48];
  std::snprintf(text[0], sizeof text[0], "%d vertices, %d faces", mesh.mesh().vertex_count(),
                mesh.mesh().face_count());
  std::snprintf(text[1], sizeof text[1], "error: mean %.2f max %.1f mm", static_cast<double>(error.mean_mm),
                static_cast<double>(error.max_mm));
  draw_text(figure, x + 4, y, title, {2, kInk, 1});
  draw_text(figure, x + 4, y + 23, text[0], {1.4f, kInk, 1});
  draw_text(figure, x + 4, y + 39, text[1], {1.4f, kInk, 1});
}

struct Column {
  const char* title;
  MeshRequest request;
  bool shows_blocks;
};

}  // namespace

Image draw_mesh_figure(const Model& model, ModelSurface& surface) {
  const Column columns[] = {{"a  base mesh", {}, false},
                            {"b  basic blocks", {}, true},
                            {"c  unconditional", {MeshCriterion::uniform, 3, 0, 0}, false},
                            {"d  normals", {MeshCriterion::normals, 12, 45, 0}, false},
                            {"e  contour error", {MeshCriterion::contour, 12, 0.3f, 0}, false}};
  constexpr int kColumns = static_cast<int>(sizeof columns / sizeof columns[0]);
  const ChartTexture texture(model);
  const Viewpoint view(ModelMesh(model, surface, {}));
  Image figure(kColumns * (kWidth + kSpace) + kSpace, kCaption + 3 * (kHeight + kSpace) + 2 * kSpace, 3, 255);
  for (int k = 0; k < kColumns; ++k) {
    const Column& column = columns[k];
    const ModelMesh mesh(model, surface, column.request);
    const int x = kSpace + k * (kWidth + kSpace);
    int y = kSpace;
    draw_caption(figure, x, y, column.title, mesh);
    y += kCaption + kSpace;
    for (const Image& panel :
         {draw_chart(mesh, column.shows_blocks), draw_wire(mesh, view, column.shows_blocks),
          draw_textured(mesh, view, texture)}) {
      paste(figure, panel, x, y);
      y += kHeight + kSpace;
    }
  }
  return figure;
}

}  // namespace pliant::host
