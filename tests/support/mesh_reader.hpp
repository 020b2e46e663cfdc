#pragma once
// Small readers of our own for the mesh files that the command writes.
#include <doctest/doctest.h>

#include <array>
#include <cstring>

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

Parsed parse_obj(const std::string& text);

/// A GLB taken apart: its JSON and the bytes behind.
struct Glb {
  Json json;
  std::string binary;

  explicit Glb(const std::string& bytes);
  ~Glb();
  const Json& at(const char* array, std::size_t k) const;
  static std::size_t number(const Json& of, const char* name);
  /// The bytes of a buffer view.
  std::string view(std::size_t k) const;
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

extern template std::vector<float> Glb::values<float>(std::size_t, std::size_t, std::size_t) const;

Parsed parse_glb(const std::string& bytes);

}  // namespace mesh_reader
