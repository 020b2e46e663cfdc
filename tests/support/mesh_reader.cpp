#include "mesh_reader.hpp"

#include <sstream>

namespace mesh_reader {

Parsed parse_obj(const std::string& text) {
  Parsed mesh;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    Vec3 p;
    Vec2 t;
    if (kind == "v" && words >> p.x >> p.y >> p.z) mesh.position.push_back(p);
    if (kind == "vn" && words >> p.x >> p.y >> p.z) mesh.normal.push_back(p);
    if (kind == "vt" && words >> t.x >> t.y) mesh.uv.push_back({t.x, 1 - t.y});
    if (kind != "f") continue;
    std::array<int, 3> face{};
    for (int& corner : face) {
      char slash = 0;
      int vt = 0, vn = 0;
      words >> corner >> slash >> vt >> slash >> vn;
      REQUIRE((words.good() || words.eof()));
      CHECK(vt == corner);
      CHECK(vn == corner);
      --corner;
    }
    mesh.faces.push_back(face);
  }
  return mesh;
}

Parsed parse_glb(const std::string& bytes) {
  const Glb glb(bytes);
  const Json& primitive = glb.at("meshes", 0).at("primitives").at(0);
  const Json& attributes = primitive.at("attributes");
  const auto p = glb.values<float>(Glb::number(attributes, "POSITION"), 5126, 3);
  const auto n = glb.values<float>(Glb::number(attributes, "NORMAL"), 5126, 3);
  const auto t = glb.values<float>(Glb::number(attributes, "TEXCOORD_0"), 5126, 2);
  const auto corners = glb.values<std::uint16_t>(Glb::number(primitive, "indices"), 5123, 1);
  Parsed mesh;
  for (std::size_t v = 0; v < p.size() / 3; ++v) {
    mesh.position.push_back({p[3 * v], p[3 * v + 1], p[3 * v + 2]});
    mesh.normal.push_back({n[3 * v], n[3 * v + 1], n[3 * v + 2]});
    mesh.uv.push_back({t[2 * v], t[2 * v + 1]});
  }
  for (std::size_t k = 0; k < corners.size(); k += 3)
    mesh.faces.push_back({corners[k], corners[k + 1], corners[k + 2]});
  return mesh;
}

Glb::Glb(const std::string& bytes) {
  REQUIRE(bytes.substr(0, 4) == "glTF");
  CHECK(take<std::uint32_t>(bytes, 4) == 2);
  CHECK(take<std::uint32_t>(bytes, 8) == bytes.size());
  const std::size_t length = take<std::uint32_t>(bytes, 12);
  CHECK(length % 4 == 0);
  CHECK(bytes.substr(16, 4) == "JSON");
  json = pliant::host::parse_json("glb", bytes.substr(20, length));
  CHECK(take<std::uint32_t>(bytes, 20 + length) % 4 == 0);
  CHECK(bytes.substr(24 + length, 4) == std::string("BIN\0", 4));
  binary = bytes.substr(28 + length);
  CHECK(binary.size() == take<std::uint32_t>(bytes, 20 + length));
  CHECK(number(at("buffers", 0), "byteLength") == binary.size());
}

const Json& Glb::at(const char* array, std::size_t k) const {
  return json.at(array).at(k);
}

std::size_t Glb::number(const Json& of, const char* name) {
  return of.at(name).get<std::size_t>();
}

std::string Glb::view(std::size_t k) const {
  const Json& v = at("bufferViews", k);
  CHECK(number(v, "byteOffset") % 4 == 0);
  REQUIRE(number(v, "byteOffset") + number(v, "byteLength") <= binary.size());
  return binary.substr(number(v, "byteOffset"), number(v, "byteLength"));
}

Glb::~Glb() = default;

template std::vector<float> Glb::values<float>(std::size_t, std::size_t, std::size_t) const;

}  // namespace mesh_reader
