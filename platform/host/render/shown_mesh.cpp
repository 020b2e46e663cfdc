#include "host/render/shown_mesh.hpp"

#include <algorithm>
#include <cmath>

#include "host/bake/boundary_loops.hpp"
#include "host/bake/triangulation.hpp"
#include "host/io/bounding_box.hpp"
#include "host/io/image.hpp"
#include "host/io/polygon.hpp"
#include "host/render/synthetic.hpp"
#include "pliant/visibility.hpp"

namespace pliant::host {

namespace {

/// Spacing of vertices inside an opening, as a fraction of the spacing around it. Chosen by eye.
constexpr float kLatticeFraction = 0.5f;

/// Vertex numbers around each opening: all boundary loops but the one with the largest area.
std::vector<std::vector<int>> find_openings(const MeshData& mesh) {
  std::vector<int> next(mesh.position.size(), -1);  // along the boundary
  std::vector<std::array<std::uint16_t, 2>> edges;
  for (const auto& f : mesh.faces)
    for (std::size_t k = 0; k < 3; ++k) edges.push_back({f[k], f[(k + 1) % 3]});
  std::sort(edges.begin(), edges.end());
  for (const auto& [a, b] : edges)
    if (!std::binary_search(edges.begin(), edges.end(), std::array<std::uint16_t, 2>{b, a})) next[a] = b;
  auto loops = bake::trace_loops(std::move(next));
  const auto area = [&](const std::vector<int>& loop) {
    return std::fabs(bake::doubled_loop_area(mesh.uv, loop));
  };
  const auto outer = std::max_element(loops.begin(), loops.end(),
                                      [&](const auto& a, const auto& b) { return area(a) < area(b); });
  if (outer != loops.end()) loops.erase(outer);
  return loops;
}

/// Points of a lattice inside the loop, closer together than those of the loop: the surface behind lips and lids is curved
/// more strongly.
std::vector<Vec2> lattice_within(const std::vector<Vec2>& loop) {
  const BoundingBox<Vec2> box(loop);
  float spacing = 0;
  for (std::size_t k = 0; k < loop.size(); ++k)
    spacing +=
        kLatticeFraction * length(loop[(k + 1) % loop.size()] - loop[k]) / static_cast<float>(loop.size());
  std::vector<Vec2> points;
  if (!(spacing > 1e-4f)) return points;
  for (float y = box.low.y + 0.5f * spacing; y < box.high.y; y += spacing)
    for (float x = box.low.x + 0.5f * spacing; x < box.high.x; x += spacing) {
      const bool is_close = std::any_of(loop.begin(), loop.end(), [&](Vec2 p) {
        return length(p - Vec2{x, y}) < 0.6f * spacing;
      });
      if (!is_close && is_inside(loop, Vec2{x, y})) points.push_back({x, y});
    }
  return points;
}

/// Fills the opening, unless that takes more vertices than `most`: a part of the filling would be vertices without faces.
void close_opening(MeshData& mesh, const std::vector<int>& loop, ModelSurface& surface, std::size_t most) {
  bake::Domain domain;
  std::vector<std::uint16_t> number;  // index in the mesh of each point of the domain
  domain.loops.emplace_back();
  for (const int v : loop) {
    domain.loops[0].push_back(static_cast<int>(domain.points.size()));
    domain.points.push_back(mesh.uv[static_cast<std::size_t>(v)]);
    number.push_back(static_cast<std::uint16_t>(v));
  }
  const std::vector<Vec2> lattice = lattice_within(domain.points);
  if (mesh.position.size() + lattice.size() > most) return;
  for (const Vec2 uv : lattice) {
    domain.points.push_back(uv);
    number.push_back(static_cast<std::uint16_t>(mesh.position.size()));
    mesh.position.push_back(surface.sample(uv));
    mesh.normal.push_back(surface.normal(uv));
    mesh.uv.push_back(uv);
  }
  const auto& f = mesh.faces.front();
  const bool turns =
      doubled_area(mesh.uv[f[0]], mesh.uv[f[1]], mesh.uv[f[2]]) < 0;  // triangulate gives positive areas
  for (const auto& t : bake::triangulate(domain)) {
    const std::uint16_t a = number[static_cast<std::size_t>(t[0])],
                        b = number[static_cast<std::size_t>(t[1])],
                        c = number[static_cast<std::size_t>(t[2])];
    mesh.faces.push_back(turns ? std::array<std::uint16_t, 3>{a, c, b}
                               : std::array<std::uint16_t, 3>{a, b, c});
    mesh.level.push_back(0);
  }
}

}  // namespace

MeshData mesh_data(const ModelMesh& adapted) {
  const Mesh& mesh = adapted.mesh();
  MeshData data;
  std::vector<std::uint16_t> number(mesh.limits().vertices, 0);
  for (const VertexId v : mesh.vertices()) {
    number[v] = static_cast<std::uint16_t>(data.position.size());
    data.position.push_back(adapted.position(v));
    data.normal.push_back(adapted.surface().normal(mesh.uv(v)));
    data.uv.push_back(mesh.uv(v));
  }
  for (const FaceId f : mesh.faces()) {
    data.faces.push_back({number[mesh.corner(f, 0)], number[mesh.corner(f, 1)], number[mesh.corner(f, 2)]});
    data.level.push_back(mesh.face_level(f));
  }
  return data;
}

MeshData closed_mesh(const ModelMesh& adapted, std::size_t most_vertices) {
  MeshData mesh = mesh_data(adapted);
  for (const auto& loop : find_openings(mesh)) close_opening(mesh, loop, adapted.surface(), most_vertices);
  return mesh;
}

std::vector<Vec3> compute_normals(const std::vector<Vec3>& position,
                                  const std::vector<std::array<std::uint16_t, 3>>& faces) {
  std::vector<Vec3> normal(position.size());
  for (const auto& f : faces) {
    const Vec3 n = cross(position[f[1]] - position[f[0]], position[f[2]] - position[f[0]]);
    for (const std::uint16_t v : f) normal[v] = normal[v] + n;
  }
  for (Vec3& n : normal) n = normalised(n);
  return normal;
}

std::string albedo_png(const Model& model) {
  const ChartImage albedo = model.albedo();
  if (albedo.pixels == nullptr) return {};
  Image image(static_cast<int>(albedo.width), static_cast<int>(albedo.height), 1);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Vec2 uv{(static_cast<float>(x) + 0.5f) / static_cast<float>(image.width),
                    (static_cast<float>(y) + 0.5f) / static_cast<float>(image.height)};
      const float grey = chart_value(albedo.pixels, albedo.width, albedo.height, uv);
      *image.at(x, y) = static_cast<std::uint8_t>(grey + 0.5f);
    }
  return encode_png(image);
}

}  // namespace pliant::host
