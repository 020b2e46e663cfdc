#pragma once
// Small readers of our own for the mesh files that the command writes.
#include <doctest/doctest.h>

#include <array>
#include <cstring>
#include <sstream>

#include "host/io/json.hpp"
#include "pliant/geometry.hpp"

namespace mesh_reader {

using pliant::Vec2;
using pliant::Vec3;
using pliant::host::Json;

/// A mesh as a file has it.
struct Parsed {
  std::vector<Vec3> position, normal;
  std::vector<Vec2> uv;
  std::vector<std::array<int, 3>> faces;
};

template <class T>
T take(const std::string& bytes, std::size_t at) {
  REQUIRE(at + sizeof(T) <= bytes.size());
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

inline Parsed parse_obj(const std::string& text) {
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

/// A GLB taken apart: its JSON and the bytes behind.
struct Glb {
  Json json;
  std::string binary;

  explicit Glb(const std::string& bytes) {
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
  const Json& at(const char* array, std::size_t k) const { return json.at(array).at(k); }
  static std::size_t number(const Json& of, const char* name) { return of.at(name).get<std::size_t>(); }
  /// The bytes of a buffer view.
  std::string view(std::size_t k) const {
    const Json& v = at("bufferViews", k);
    CHECK(number(v, "byteOffset") % 4 == 0);
    REQUIRE(number(v, "byteOffset") + number(v, "byteLength") <= binary.size());
    return binary.substr(number(v, "byteOffset"), number(v, "byteLength"));
  }
  template <class T>
  std::vector<T> values(std::size_t accessor, std::size_t component_type, std::size_t components) const {
    const Json& a = at("accessors", accessor);
    CHECK(number(a, "componentType") == component_type);
    const std::string bytes = view(number(a, "bufferView"));
    CHECK(bytes.size() == number(a, "count") * components * sizeof(T));
    std::vector<T> out;
    for (std::size_t k = 0; k < bytes.size(); k += sizeof(T)) out.push_back(take<T>(bytes, k));
    return out;
  }
};

inline Parsed parse_glb(const std::string& bytes) {
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

}  // namespace mesh_reader
