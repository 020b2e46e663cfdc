#pragma once
// Folders of OBJ files over one grid of quads, and what `pliant bake` says of them.
#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <initializer_list>
#include <string>
#include <vector>

#include "host/bake/bake.hpp"
#include "scratch_folder.hpp"

namespace obj_folder {

using namespace pliant;
using host::bake::BakeOptions;

using Shape = std::function<Vec3(float s, float t)>;

/// A folder of OBJ files over one grid of quads, n vertices a side, s to the right and t up, gone after the
/// test.
struct ObjFolder : Folder {
  int n = 33;

  explicit ObjFolder(const std::string& name) : Folder("obj_" + name) {}

  std::string obj(const Shape& shape) const {
    std::string text = "# a comment\no sheet\n";
    const auto line = [&text](const char* key, std::initializer_list<float> values) {
      text += key;
      for (float v : values) text += ' ' + std::to_string(v);
      text += '\n';
    };
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const Vec3 p = shape(static_cast<float>(i) / static_cast<float>(n - 1),
                             static_cast<float>(j) / static_cast<float>(n - 1));
        line("v", {p.x, p.y, p.z});
      }
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        line("vt", {0.1f + 0.8f * static_cast<float>(i) / static_cast<float>(n - 1),
                    0.05f + 0.9f * static_cast<float>(j) / static_cast<float>(n - 1)});
    for (int j = 0; j + 1 < n; ++j)
      for (int i = 0; i + 1 < n; ++i) {
        const int a = j * n + i + 1;
        text += "f";
        for (const int v : {a, a + 1, a + n + 1, a + n})
          text += ' ' + std::to_string(v) + '/' + std::to_string(v) + '/';
        text += '\n';
      }
    return text;
  }
  void write(const std::string& name, const Shape& shape) const { put(name + ".obj", obj(shape)); }
};

inline Vec3 curved_sheet(float s, float t) {
  return {10 * s - 5, 12 * t - 6, 4 * s * (1 - s)};
}
inline float hill(float s, float t) {
  return std::exp(-20 * ((s - 0.5f) * (s - 0.5f) + (t - 0.4f) * (t - 0.4f)));
}

/// Where (s,t) lies in the chart of the table: v points down there.
inline Vec2 chart(float s, float t) {
  return {0.1f + 0.8f * s, 0.95f - 0.9f * t};
}

inline std::string swapped(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

inline std::string error_of(const ObjFolder& folder, int components = 0) {
  BakeOptions options;
  options.source = folder.path.string();
  options.size = 32;
  options.components = components;
  options.base_vertices = 60;
  std::vector<std::uint8_t> table;
  std::string error;
  const bool baked = host::bake::bake(options, table, error);
  CHECK(baked == error.empty());
  CHECK(table.empty() == !error.empty());
  return error;
}

}  // namespace obj_folder
