// Bending modes of OBJ files as programs write them: cuts that rounding opens.
#include "host/bake/surface_modes.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>
#include <initializer_list>

#include "baked_model.hpp"
#include "obj_folder.hpp"

namespace surface_modes_test {

using namespace pliant;
using namespace pliant::host::bake;
using obj_folder::ObjFolder;

namespace {

constexpr int kModes = 6;

/// The table of an OBJ file with bending modes; empty with an error.
std::vector<std::uint8_t> with_modes(const std::string& text, std::string* error) {
  const ObjFolder folder("surface_modes");
  BakeOptions options;
  options.source = folder.put("surface.obj", text);
  options.base_vertices = 100;
  options.modes = kModes;
  std::vector<std::uint8_t> table;
  (void)host::bake::bake(options, table, *error);
  return table;
}

std::string numbers(const char* key, std::initializer_list<double> values) {
  std::string line = key;
  for (const double v : values) {
    char digits[32];
    std::snprintf(digits, sizeof digits, " %.6g", v);
    line += digits;
  }
  return line + '\n';
}

/// A can whose cut has two columns of vertices.
std::string can() {
  constexpr int kAround = 32, kUp = 8;
  std::string text;
  for (int j = 0; j <= kUp; ++j)
    for (int i = 0; i <= kAround; ++i) {
      const double u = i / double{kAround}, v = j / double{kUp}, a = 2 * 3.14159265358979 * u;
      text += numbers("v", {41 * std::sin(a), 95 * (v - 0.5), 41 * std::cos(a)}) + numbers("vt", {u, v});
    }
  for (int j = 0; j < kUp; ++j)
    for (int i = 0; i < kAround; ++i) {
      const int a = j * (kAround + 1) + i + 1;
      text += "f";
      for (const int v : {a, a + 1, a + kAround + 2, a + kAround + 1})
        text += ' ' + std::to_string(v) + '/' + std::to_string(v);
      text += '\n';
    }
  return text;
}

}  // namespace

TEST_CASE("a cut whose sides six digits have rounded apart stays shut in all modes") {
  std::string error;
  BakedModel baked(with_modes(can(), &error));
  REQUIRE_MESSAGE(error.empty(), error);
  for (std::size_t k = 0; k < kModes; ++k) {
    std::vector<float> q = baked.rest();
    q[k] = 1;
    float moved = 0;
    for (int j = 0; j <= 10; ++j) {
      const float v = 0.1f * static_cast<float>(j);
      CHECK(length(baked.at(Vec2{0, v}, q) - baked.at(Vec2{1, v}, q)) < 0.1f);
      moved = max(moved, length(baked.at(Vec2{0.3f, v}, q) - baked.at(Vec2{0.3f, v}, baked.rest())));
    }
    CHECK(moved > 0.5f);
  }
}

}  // namespace surface_modes_test
