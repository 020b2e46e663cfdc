// Bending modes of OBJ files as programs write them: cuts that rounding opens, polygons with corners on a line, vertices without
// area.
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

constexpr int kAcross = 12, kDown = 8;

/// A sheet of 300 x 200 mm in polygons of this many cells of a row each.
std::string sheet_of(int cells) {
  std::string text;
  for (int j = 0; j <= kDown; ++j)
    for (int i = 0; i <= kAcross; ++i) {
      const double u = i / double{kAcross}, v = j / double{kDown};
      text += numbers("v", {300 * (u - 0.5), 200 * (v - 0.5), 0}) + numbers("vt", {u, v});
    }
  for (int j = 0; j < kDown; ++j)
    for (int i = 0; i < kAcross; i += cells) {
      const int a = j * (kAcross + 1) + i + 1;
      text += "f";
      for (int k = 0; k <= cells; ++k) text += ' ' + std::to_string(a + k) + '/' + std::to_string(a + k);
      for (int k = cells; k >= 0; --k)
        text += ' ' + std::to_string(a + kAcross + 1 + k) + '/' + std::to_string(a + kAcross + 1 + k);
      text += '\n';
    }
  return text;
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

TEST_CASE("polygons with corners on a straight line have the modes of the quads that they are made of") {
  std::string error;
  BakedModel quads(with_modes(sheet_of(1), &error)), rows(with_modes(sheet_of(4), &error));
  REQUIRE_MESSAGE(error.empty(), error);
  const auto moved = [](BakedModel& model, std::size_t k) {
    std::vector<Vec3> moves;
    std::vector<float> q = model.rest(), other_way = q;
    q[k] = 1, other_way[k] = -1;  // corrective shapes are the same either way
    for (int i = 0; i <= 24; ++i)
      for (int j = 0; j <= 16; ++j) {
        const Vec2 uv{static_cast<float>(i) / 24, static_cast<float>(j) / 16};
        moves.push_back(model.at(uv, q) - model.at(uv, other_way));
      }
    return moves;
  };
  const auto product = [](const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    double sum = 0;
    for (std::size_t k = 0; k < a.size(); ++k) sum += static_cast<double>(dot(a[k], b[k]));
    return sum;
  };
  // Modes with nearly one eigenvalue mix: each is a sum of those of the quads.
  for (std::size_t k = 0; k < 4; ++k) {
    const std::vector<Vec3> own = moved(rows, k);
    double explained = 0;
    for (std::size_t other = 0; other < kModes; ++other) {
      const std::vector<Vec3> quad = moved(quads, other);
      explained += product(own, quad) * product(own, quad) / product(quad, quad);
    }
    CHECK(explained > 0.97 * product(own, own));
    const std::vector<Vec3> quad = moved(quads, k);
    CHECK(product(own, own) == doctest::Approx(product(quad, quad)).epsilon(0.2));
  }
}

TEST_CASE("a vertex none of whose faces has an area is named, since no mode tells how it moves") {
  // The quad at the rest has two more triangles along its lower side, which are none.
  const std::string text =
      "v -50 -50 0\nv 50 -50 0\nv 50 50 0\nv -50 50 0\nv 12.5 -50 0\n"
      "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 0.6 0\n"
      "f 1/1 2/2 3/3 4/4\nf 2/2 1/1 5/5\n";
  std::string error;
  CHECK(with_modes(text, &error).empty());
  CHECK(error.find("the faces at the vertex at (12.5, -50, 0) mm have no area") != std::string::npos);
}

}  // namespace surface_modes_test
