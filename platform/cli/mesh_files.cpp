#include "cli/mesh_files.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>

#include "cli/json.hpp"
#include "cli/level_tints.hpp"

namespace pliant::cli {

namespace {

/// printf into a string.
template <class... Values>
void append(std::string& out, const char* format, Values... values) {
  char line[160];
  std::snprintf(line, sizeof line, format, values...);
  out += line;
}

double wide(float x) {
  return static_cast<double>(x);
}

// Little endian whatever the host is.
void put(std::string& out, std::uint32_t value, int bytes) {
  for (int k = 0; k < bytes; ++k) out += static_cast<char>(value >> (8 * k) & 255u);
}

void put(std::string& out, float value) {
  std::uint32_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  put(out, bits, 4);
}

void put(std::string& out, Vec3 v) {
  put(out, v.x);
  put(out, v.y);
  put(out, v.z);
}

/// The buffer of a GLB: every part is a view and starts at a multiple of four bytes.
struct GlbBuffer {
  std::string bytes;
  Json::Array views;

  int add(const std::string& part, int target) {
    Json::Object view{{"buffer", 0},
                      {"byteOffset", static_cast<double>(bytes.size())},
                      {"byteLength", static_cast<double>(part.size())}};
    if (target != 0) view.push_back({"target", target});
    views.push_back(view);
    bytes += part;
    bytes.resize((bytes.size() + 3) / 4 * 4, '\0');
    return static_cast<int>(views.size()) - 1;
  }
};

Json::Object accessor(int view, int component, std::size_t count, const char* type) {
  return {{"bufferView", view},
          {"componentType", component},
          {"count", static_cast<double>(count)},
          {"type", type}};
}

/// glTF asks for the extent of the positions.
void add_extent(Json::Object& of, const std::vector<Vec3>& positions) {
  Vec3 low = positions.empty() ? Vec3{} : positions[0], high = low;
  for (Vec3 p : positions) {
    low = {min(low.x, p.x), min(low.y, p.y), min(low.z, p.z)};
    high = {max(high.x, p.x), max(high.y, p.y), max(high.z, p.z)};
  }
  of.push_back({"min", Json::Array{wide(low.x), wide(low.y), wide(low.z)}});
  of.push_back({"max", Json::Array{wide(high.x), wide(high.y), wide(high.z)}});
}

constexpr int kFloat = 5126, kUint16 = 5123, kVertexData = 34962, kIndices = 34963;

/// Adds the mesh to the buffer. \return the accessors: positions, normals, u,v, indices.
Json::Array add_mesh(GlbBuffer& buffer, const MeshData& mesh) {
  std::string positions, normals, uvs, indices;
  for (Vec3 p : mesh.position) put(positions, p);
  for (Vec3 n : mesh.normal) put(normals, n);
  for (Vec2 t : mesh.uv) {
    put(uvs, t.x);
    put(uvs, t.y);
  }
  for (const auto& face : mesh.faces)
    for (std::uint16_t v : face) put(indices, v, 2);
  const std::size_t vertices = mesh.position.size();
  Json::Object position = accessor(buffer.add(positions, kVertexData), kFloat, vertices, "VEC3");
  add_extent(position, mesh.position);
  return {position, accessor(buffer.add(normals, kVertexData), kFloat, vertices, "VEC3"),
          accessor(buffer.add(uvs, kVertexData), kFloat, vertices, "VEC2"),
          accessor(buffer.add(indices, kIndices), kUint16, 3 * mesh.faces.size(), "SCALAR")};
}

/// A chunk of a GLB: length, kind, contents filled up to a multiple of four bytes.
std::string chunk(std::uint32_t kind, std::string contents, char filler) {
  contents.resize((contents.size() + 3) / 4 * 4, filler);
  std::string out;
  put(out, static_cast<std::uint32_t>(contents.size()), 4);
  put(out, kind, 4);
  return out + contents;
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

std::string glb_bytes(const MeshData& mesh, const std::string& png) {
  GlbBuffer buffer;
  const Json::Array accessors = add_mesh(buffer, mesh);
  Json::Object surface{{"metallicFactor", 0}, {"roughnessFactor", 0.8}};
  if (!png.empty()) surface.push_back({"baseColorTexture", Json::Object{{"index", 0}}});
  const Json::Object attributes{{"POSITION", 0}, {"NORMAL", 1}, {"TEXCOORD_0", 2}};
  const Json::Object primitive{{"attributes", attributes}, {"indices", 3}, {"material", 0}};
  const Json::Object node{{"mesh", 0}, {"scale", Json::Array{0.001, 0.001, 0.001}}};
  Json::Object root{
      {"asset", Json::Object{{"version", "2.0"}, {"generator", "pliant"}}},
      {"scene", 0},
      {"scenes", Json::Array{Json::Object{{"nodes", Json::Array{0}}}}},
      {"nodes", Json::Array{node}},
      {"meshes", Json::Array{Json::Object{{"primitives", Json::Array{primitive}}}}},
      {"materials", Json::Array{Json::Object{{"pbrMetallicRoughness", surface}, {"doubleSided", true}}}},
      {"accessors", accessors}};
  if (!png.empty()) {
    const int view = buffer.add(png, 0);
    root.push_back({"images", Json::Array{Json::Object{{"bufferView", view}, {"mimeType", "image/png"}}}});
    root.push_back({"textures", Json::Array{Json::Object{{"source", 0}}}});
  }
  root.push_back({"bufferViews", buffer.views});
  root.push_back(
      {"buffers", Json::Array{Json::Object{{"byteLength", static_cast<double>(buffer.bytes.size())}}}});
  const std::string chunks =
      chunk(0x4e4f534a, Json(root).text(), ' ') + chunk(0x004e4942, buffer.bytes, '\0');
  std::string out = "glTF";
  put(out, 2, 4);
  put(out, static_cast<std::uint32_t>(12 + chunks.size()), 4);
  return out + chunks;
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

}  // namespace pliant::cli
