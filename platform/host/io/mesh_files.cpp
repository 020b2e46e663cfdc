#include "host/io/mesh_files.hpp"

#include <algorithm>
#include <cstdio>

#include "host/io/append.hpp"
#include "host/io/glb.hpp"
#include "host/io/level_tints.hpp"

namespace pliant::host {

namespace {

double wide(float x) {
  return static_cast<double>(x);
}

}  // namespace

std::string obj_text(const MeshData& mesh) {
  std::string out = "# millimetres; x to the subject's left, y up, z out of the face\n";
  for (Vec3 p : mesh.position) append(out, "v %.6g %.6g %.6g\n", wide(p.x), wide(p.y), wide(p.z));
  for (Vec2 t : mesh.uv) append(out, "vt %.7g %.7g\n", wide(t.x), 1 - wide(t.y));
  for (Vec3 n : mesh.normal) append(out, "vn %.5f %.5f %.5f\n", wide(n.x), wide(n.y), wide(n.z));
  for (const auto& f : mesh.faces) {
    const int a = f[0] + 1, b = f[1] + 1, c = f[2] + 1;
    append(out, "f %d/%d/%d %d/%d/%d %d/%d/%d\n", a, a, a, b, b, b, c, c, c);
  }
  return out;
}

std::string ply_bytes(const MeshData& mesh) {
  std::string out = "ply\nformat binary_little_endian 1.0\n";
  append(out, "element vertex %zu\n", mesh.position.size());
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "s", "t"})
    append(out, "property float %s\n", name);
  append(out, "element face %zu\nproperty list uchar ushort vertex_indices\nend_header\n", mesh.faces.size());
  for (std::size_t v = 0; v < mesh.position.size(); ++v) {
    put(out, mesh.position[v]);
    put(out, mesh.normal[v]);
    put(out, mesh.uv[v].x);
    put(out, 1 - mesh.uv[v].y);
  }
  for (const auto& face : mesh.faces) {
    put(out, 3, 1);
    for (std::uint16_t v : face) put(out, v, 2);
  }
  return out;
}

std::string glb_bytes(const MeshData& mesh, const std::string& picture, bool is_lit) {
  GlbFile file;
  const Json attributes = Json::object({{"POSITION", file.add(mesh.position, GlbFile::Use::vertices)},
                                        {"NORMAL", file.add(mesh.normal, GlbFile::Use::vertices)},
                                        {"TEXCOORD_0", file.add(mesh.uv)}});
  const int indices = file.add(mesh.faces);
  const Json primitive = Json::object(
      {{"attributes", attributes}, {"indices", indices}, {"material", file.add_material(picture, is_lit)}});
  const Json node = Json::object({{"mesh", 0}, {"scale", metres_per_millimetre()}});
  Json root;
  root["scene"] = 0;
  root["scenes"][0]["nodes"] = Json::array({0});
  root["nodes"][0] = node;
  root["meshes"][0]["primitives"][0] = primitive;
  return file.bytes(std::move(root));
}

std::string chart_svg(const MeshData& mesh) {
  std::string out =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"-10 -10 1020 1020\" "
      "stroke=\"#222\" stroke-width=\"0.6\" stroke-linejoin=\"round\">\n";
  const int deepest = mesh.level.empty() ? 0 : *std::max_element(mesh.level.begin(), mesh.level.end());
  for (int level = 0; level <= deepest; ++level) {
    const Colour tint = level_tint(level);
    append(out, "<path fill=\"#%02x%02x%02x\" d=\"", tint.r, tint.g, tint.b);
    for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
      if (mesh.level[f] != level) continue;
      const auto at = [&](std::size_t k) { return 1000 * mesh.uv[mesh.faces[f][k]]; };
      append(out, "M%.2f %.2fL%.2f %.2fL%.2f %.2fZ", wide(at(0).x), wide(at(0).y), wide(at(1).x),
             wide(at(1).y), wide(at(2).x), wide(at(2).y));
    }
    out += "\"/>\n";
  }
  return out + "</svg>\n";
}

}  // namespace pliant::host
