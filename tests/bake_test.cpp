// The baker: tables of text, subdivision, fields on grids, the bytes of a model table, and one line for every
// defect.
#include "bake/bake.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>

#include "bake/base_mesh.hpp"
#include "bake/chart_raster.hpp"
#include "bake/field_grid.hpp"
#include "bake/source_error.hpp"
#include "bake/subdivision.hpp"
#include "bake/table_writer.hpp"
#include "bake/text_table.hpp"
#include "bake/triangulation.hpp"
#include "baked_face.hpp"
#include "pliant/mesh.hpp"
#include "random.hpp"

using namespace pliant;
using namespace pliant::bake;
namespace fs = std::filesystem;

namespace {

/// A folder of its own for a test, gone afterwards.
struct Folder {
  fs::path path;
  explicit Folder(const std::string& name) : path(fs::temp_directory_path() / ("pliant_bake_test_" + name)) {
    fs::remove_all(path);
    fs::create_directories(path);
  }
  ~Folder() { fs::remove_all(path); }
  std::string file(const std::string& name, const std::string& text) const {
    std::ofstream(path / name) << text;
    return (path / name).string();
  }
};

/// What goes wrong, or "" when nothing does.
std::string error_of(const std::function<void()>& action) {
  try {
    action();
    return "";
  } catch (const SourceError& e) {
    return e.what();
  }
}

/// A square of n x n vertices over the chart, lifted by f, with two triangles a cell.
Source sheet(int n, const std::function<Vec3(Vec2)>& f) {
  Source source;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const Vec2 uv{static_cast<float>(i) / static_cast<float>(n - 1),
                    static_cast<float>(j) / static_cast<float>(n - 1)};
      source.uv.push_back(uv);
      source.neutral.push_back(f(uv));
    }
  for (int j = 0; j + 1 < n; ++j)
    for (int i = 0; i + 1 < n; ++i) {
      const int a = j * n + i;
      source.triangles.push_back({a, a + n, a + n + 1});
      source.triangles.push_back({a, a + n + 1, a + 1});
    }
  source.is_hole.assign(source.triangles.size(), 0);
  source.base_uv = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
  source.base_corners = {2, 0, 1, 0, 2, 3};
  return source;
}

Vec3 dome(Vec2 uv) {
  return {100 * (uv.x - 0.5f), 100 * (0.5f - uv.y), 40 * uv.x * (1 - uv.x)};
}

FieldGrid bump(int n, int components) {
  FieldGrid grid;
  grid.width = n;
  grid.height = n;
  grid.components = components;
  grid.u0 = 0.25f;
  grid.u1 = 0.75f;
  grid.v0 = 0.5f;
  grid.v1 = 1;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      for (int c = 0; c < components; ++c) {
        const bool rim = i == 0 || j == 0 || i == n - 1 || j == n - 1;
        grid.samples.push_back(rim ? 0
                                   : static_cast<float>(c + 1) * std::sin(0.3f * static_cast<float>(i * j)));
      }
  return grid;
}

}  // namespace

TEST_CASE(
    "a text table gives its rows by line, without comments, and takes the rest of a line in an open column") {
  const Folder folder("text");
  const auto path =
      folder.file("a.txt", "# units: mm\nname  x more...\n\nfirst 1.5 a b # c\n  second -2 d\n");
  const TextTable table(path, {"name", "x", "more..."});
  REQUIRE(table.rows().size() == 2);
  CHECK(table.rows()[0].line == 4);
  CHECK(table.number(table.rows()[0], 1) == 1.5f);
  CHECK(table.words(table.rows()[0], 2) == std::vector<std::string>{"a", "b"});
  CHECK(table.rows()[1].cells[0] == "second");
}

TEST_CASE("each defect of a text table is one line that names the file and the line") {
  const Folder folder("defects");
  const auto path = (folder.path / "a.txt").string();
  const auto error = [&](const std::string& text) {
    folder.file("a.txt", text);
    return error_of([&] {
      const TextTable table(path, {"name", "x"});
      for (const TextRow& row : table.rows()) table.number(row, 1);
    });
  };
  CHECK(error("name x\na 1\n") == "");
  CHECK(error("") == path + ": holds no table");
  CHECK(error("name\na 1\n") == path + ":1: expected a column 'x'");
  CHECK(error("name x y\na 1 2\n") == path + ":1: unknown column 'y'");
  CHECK(error("name x\n\na\n") == path + ":3: no value for column 'x'");
  CHECK(error("name x\na 1 2\n") == path + ":2: '2' is more than the columns take");
  CHECK(error("name x\na nan\n") == path + ":2: 'nan' in column 'x' is no number");
  CHECK(error("name x\na inf\n") == path + ":2: 'inf' in column 'x' is no number");
  CHECK(error("name x\na 1,5\n") == path + ":2: '1,5' in column 'x' is no number");
  CHECK(error_of([&] { TextTable(path + "x", {"name"}); }) == path + "x: cannot be read");
}

TEST_CASE("subdivision makes a flat cage flat, and weights that add up to one") {
  Cage cage;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) {
      cage.names.push_back(std::to_string(4 * j + i));
      cage.position.push_back({static_cast<float>(i), static_cast<float>(j), 0});
      cage.mirror.push_back(4 * j + i);
    }
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) {
      const int a = 4 * j + i;
      cage.faces.push_back({{a, a + 4, a + 5, a + 1}, i == 1 && j == 1, "patch"});
    }
  const SubdividedCage fine = subdivide(cage, 3);
  CHECK(fine.quads.size() == 9 * 64);
  for (const Stencil& s : fine.stencils) {
    float sum = 0;
    for (const auto& [point, weight] : s) sum += weight;
    CHECK(std::fabs(sum - 1) < 1e-5f);
  }
  for (const Vec3 p : fine_values(fine, cage.position)) CHECK(p.z == 0);

  SUBCASE(
      "surface and openings are separated by a sharp edge: moving the opening's far side leaves the skin") {
    // Around the hole (the middle quad) nothing but its own corners counts.
    auto lifted = cage.position;
    lifted[0].z = 1;
    const auto values = fine_values(fine, lifted);
    CHECK(values[5].z == 0);
  }
  SUBCASE("controls can be found for which the surface passes through the points, still ones excepted") {
    std::vector<float> targets(16, 0.0f);
    targets[5] = 1;
    targets[9] = -2;
    std::vector<char> is_still(16, 1);
    is_still[5] = is_still[9] = 0;
    const auto controls = controls_through(fine, targets, 12, is_still);
    const auto values = fine_values(fine, controls);
    CHECK(std::fabs(values[5] - 1) < 1e-3f);
    CHECK(std::fabs(values[9] + 2) < 1e-3f);
    CHECK(controls[0] == 0);
  }
  SUBCASE("a path follows the edges of the cage") {
    CHECK(path_through(fine, {0, 1, 2}).size() == 2 * 8 + 1);
    CHECK(path_through(fine, {2, 1}).front() == 2);
    CHECK(path_through(fine, {0, 15}).size() == 2);  // no edge between them
  }
}

TEST_CASE("a raster reproduces what is linear over the chart, beside the mesh as well") {
  Source source = sheet(9, [](Vec2 uv) { return Vec3{3 * uv.x, uv.y - 2 * uv.x, 1}; });
  for (Vec2& uv : source.uv) uv = {0.2f + 0.6f * uv.x, 0.3f + 0.5f * uv.y};
  const ChartRaster raster = rasterise(source.uv, source.triangles, source.is_hole, 41, 31);
  for (int j = 0; j < 31; ++j)
    for (int i = 0; i < 41; ++i) {
      const float u = (static_cast<float>(i) / 40 - 0.2f) / 0.6f,
                  v = (static_cast<float>(j) / 30 - 0.3f) / 0.5f;
      const float beyond = max(max(-u, u - 1) * 0.6f * 40, max(-v, v - 1) * 0.5f * 30);  // in samples
      if (beyond > 0.99f) continue;
      const Vec3 p = value_at(raster.at(i, j), source.neutral);
      CHECK(length(p - Vec3{3 * u, v - 2 * u, 1}) < 1e-3f);
      CHECK((raster.at(i, j).triangle >= 0) == (beyond <= 1e-3f));
    }
}

TEST_CASE("the table holds what was put in, to half a quantisation step") {
  for (const int bits : {16, 8}) {
    TableWriter writer;
    writer.add_parameter({"one", Group::identity, -3, 3, 1});
    writer.add_parameter({"a_name_of_more_than_27_letters", Group::expression, 0, 1, 0.25f});
    const FieldGrid vectors = bump(17, 3), weights = bump(9, 1);
    const auto v = writer.add_field(vectors, bits), w = writer.add_field(weights, bits);
    const auto mirrored = writer.add_mirrored(v);
    CascadeRecord r = empty_record(Operation::constant);
    r.field = v;
    writer.add_record(r);
    r = empty_record(Operation::rotate);
    r.source[0] = 0;
    r.parameter[0] = 1;
    r.weight = w;
    r.axis[1] = 1;
    writer.add_record(r);
    writer.add_landmark({"here", {0.25f, 0.75f}});
    writer.add_curve({"line", CurveKind::brow, {{0, 0}, {0.5f, 0.25f}, {1, 1}}});
    writer.set_base_mesh({{0, 0}, {0, 1}, {1, 1}}, {2, 0, 1});
    writer.set_mask({2, 1, {0, 1}});
    writer.set_albedo({3, 1, {7, 8, 9}});
    const BakedModel baked(writer.bytes());
    const Model& model = baked.model;

    CHECK(std::string(model.parameters()[1].name) == "a_name_of_more_than_27_lett");
    CHECK(model.parameters()[1].sd == 0.25f);
    CHECK(model.landmarks()[0].v == 0.75f);
    CHECK(model.curves()[0].point_count == 3);
    CHECK(model.curve_points()[1].y == 0.25f);
    CHECK(model.base_uv().count == 3);
    CHECK(model.mask().pixels[1] == 1);
    CHECK(model.albedo().width == 3);
    CHECK(model.albedo().pixels[2] == 9);
    CHECK(model.cascade()[1].weight == w);
    CHECK(model.cascade()[1].parameter[1] == kNone);

    const float most = bits == 16 ? 32767.0f : 127.0f;
    for (int j = 0; j < 17; ++j)
      for (int i = 0; i < 17; ++i) {
        const Vec2 uv{0.25f + 0.5f * static_cast<float>(i) / 16, 0.5f + 0.5f * static_cast<float>(j) / 16};
        const Vec3 p = pliant::sample(model, model.fields()[v], uv);
        const Vec3 m = pliant::sample(model, model.fields()[mirrored], {1 - uv.x, uv.y});
        const float* s = &vectors.samples[static_cast<std::size_t>(3 * (17 * j + i))];
        for (const float off : {p.x - s[0], (p.y - s[1]) / 2, (p.z - s[2]) / 3})
          CHECK(std::fabs(off) <= 0.51f / most);
        CHECK(m.x == -p.x);
        CHECK(m.y == p.y);
      }
    const float w7 = pliant::sample(model, model.fields()[w], {0.25f + 0.5f * 3 / 8, 0.5f + 0.5f * 5 / 8}).x;
    CHECK(std::fabs(w7 - weights.samples[5 * 9 + 3]) <= 0.51f / most);
  }
}

TEST_CASE("a field is cut to its support, with a rim of zeros, and coarser where it is smooth") {
  Source source = sheet(129, dome);
  source.parameters.push_back({"smooth", Group::expression, 0, 1, 1});
  source.parameters.push_back({"sharp", Group::expression, 0, 1, 1});
  SourceShape smooth{0, {}, {}, {}, {}, -1}, sharp{1, {}, {}, {}, {}, -1};
  for (const Vec2 uv : source.uv) {
    const float r = 4 * length(uv - Vec2{0.5f, 0.5f});
    smooth.displacement.push_back({0, 0, r < 1 ? (1 - r * r) * (1 - r * r) : 0});
    sharp.displacement.push_back(
        {0, uv.x > 0.3f && uv.x < 0.42f && uv.y > 0.3f && uv.y < 0.4f ? 4.0f : 0.0f, 0});
  }
  source.shapes = {smooth, sharp};
  BakeOptions options;
  options.size = 128;
  BakeReport report;
  BakedModel baked(bake_source(source, options, &report));
  const Field &neutral = baked.model.fields()[0], &a = baked.model.fields()[1], &b = baked.model.fields()[2];
  CHECK(neutral.width == 256);
  CHECK(a.u0 > 0.2f);
  CHECK(a.u1 < 0.8f);
  CHECK(a.width < 40);   // of 64 at full resolution
  CHECK(b.width >= 17);  // of 128, cut to an eighth
  CHECK(b.width <= 30);
  CHECK(report.neutral_max_mm < 0.01f);
  CHECK(report.shape_max_mm > 0.5f);  // a step cannot be sampled; the report says so
  CHECK(report.worst_shape == "sharp");
  const auto at = [&](Vec2 uv, float q0, float q1) { return baked.at(uv, {q0, q1}); };
  CHECK(length(at({0.5f, 0.5f}, 1, 0) - at({0.5f, 0.5f}, 0, 0) - Vec3{0, 0, 1}) < 0.05f);
  CHECK(length(at({0.9f, 0.5f}, 1, 1) - at({0.9f, 0.5f}, 0, 0)) == 0);
}

TEST_CASE("eight bits and a smaller size make a smaller table that is still close") {
  Source source = sheet(65, dome);
  source.parameters.push_back({"wave", Group::identity, -3, 3, 1});
  SourceShape wave{0, {}, {}, {}, {}, -1};
  for (const Vec2 uv : source.uv)
    wave.displacement.push_back({0, 0, 5 * std::sin(6 * uv.x) * std::sin(9 * uv.y)});
  source.shapes = {wave};
  BakeOptions fine, coarse;
  coarse.bits = 8;
  coarse.size = 64;
  BakeReport a, b;
  CHECK(bake_source(source, fine, &a).size() > 3 * bake_source(source, coarse, &b).size());
  CHECK(a.shape_max_mm <= fine.tolerance_mm);
  CHECK(b.shape_max_mm < 0.3f);
}

TEST_CASE("a triangulation keeps to its loops, covers the domain once and turns no triangle over") {
  Random random(7);
  for (int trial = 0; trial < 20; ++trial) {
    Domain domain;
    const auto circle = [&](int n, float radius) {
      std::vector<int> loop;
      for (int k = 0; k < n; ++k) {
        const float a = 6.2831853f * static_cast<float>(k) / static_cast<float>(n),
                    r = radius * random.uniform(0.8f, 1);
        loop.push_back(static_cast<int>(domain.points.size()));
        domain.points.push_back({0.5f + r * std::cos(a), 0.5f + r * std::sin(a)});
      }
      domain.loops.push_back(loop);
    };
    circle(25, 0.45f);
    circle(9 + trial % 7, 0.15f);
    for (int k = 0; k < 60; ++k) {
      const float a = random.uniform(0, 6.28f), r = random.uniform(0.17f, 0.35f);
      domain.points.push_back({0.5f + r * std::cos(a), 0.5f + r * std::sin(a)});
    }
    Triangles triangles = triangulate(domain);
    std::vector<Vec3> position;
    for (Vec2 p : domain.points) position.push_back({p.x, 3 * p.y, p.x * p.y});
    const auto check = [&] {
      const std::size_t n = domain.points.size();
      CHECK(triangles.size() == n + n - domain.loops[0].size() - domain.loops[1].size());  // Euler, one hole
      double area = 0, wanted = 0;
      for (float a : chart_areas(domain.points, triangles)) {
        CHECK(a > 0);
        area += static_cast<double>(a);
      }
      for (std::size_t l = 0; l < 2; ++l)
        for (std::size_t k = 0; k < domain.loops[l].size(); ++k) {
          const Vec2 a = domain.points[static_cast<std::size_t>(domain.loops[l][k])];
          const Vec2 b =
              domain.points[static_cast<std::size_t>(domain.loops[l][(k + 1) % domain.loops[l].size()])];
          wanted += (l == 0 ? 1.0 : -1.0) * static_cast<double>(a.x * b.y - a.y * b.x);
        }
      CHECK(area == doctest::Approx(wanted).epsilon(1e-4));
    };
    check();
    flip_by_shape(triangles, domain.points, position);
    check();
  }
  Domain crossing{{{0, 0}, {1, 1}, {1, 0}, {0, 1}}, {{0, 1, 2, 3}}};
  CHECK(triangulate(crossing).empty());
}

TEST_CASE("a base mesh has about the vertices asked for, follows an opening and is of basic blocks") {
  Source source = sheet(65, dome);
  for (std::size_t f = 0; f < source.triangles.size(); ++f)
    source.is_hole[f] =
        length(source.uv[static_cast<std::size_t>(source.triangles[f][0])] - Vec2{0.5f, 0.5f}) < 0.15f;
  source.landmarks = {{"one", {0.21f, 0.3f}}, {"near it", {0.22f, 0.3f}}, {"in the hole", {0.5f, 0.5f}}};
  for (const bool symmetric : {false, true})
    for (const int wanted : {100, 300}) {
      const BaseMesh mesh = make_base_mesh(source, wanted, symmetric);
      CHECK(mesh.uv.size() > 0.8 * wanted);
      CHECK(mesh.uv.size() < 1.25 * wanted);
      const auto closest = [&](Vec2 p) {
        float least = 1;
        for (Vec2 q : mesh.uv) least = min(least, length(p - q));
        return least;
      };
      if (!symmetric) CHECK(closest({0.21f, 0.3f}) < 1e-6f);
      CHECK(closest({0.5f, 0.5f}) > 0.1f);
      MeshLimits limits;
      std::vector<std::max_align_t> memory(measured_bytes<Mesh>(limits) / sizeof(std::max_align_t) + 1);
      Arena arena(memory.data(), memory.size() * sizeof(std::max_align_t));
      Mesh checked;
      REQUIRE(create_in(arena, checked, limits) == Status::ok);
      REQUIRE(checked.set_base({mesh.uv.data(), mesh.uv.size()},
                               {mesh.corners.data(), mesh.corners.size()}) == Status::ok);
      CHECK(checked.compute_statistics().boundary_loops == 2);
      CHECK(checked.compute_statistics().euler == 0);
    }
}

TEST_CASE("an embedded table is the table") {
  const std::vector<std::uint8_t> table{0x50, 0x4c, 0x0a, 0xff};
  const std::string source = embedded(table, "face");
  CHECK(source.find("alignas(4) const unsigned char face[] = {\n  0x50, 0x4c, 0x0a, 0xff,\n};") !=
        std::string::npos);
  CHECK(source.find("const std::size_t face_bytes = sizeof face;") != std::string::npos);
}

namespace {

/// The face's own tables with one file changed by an edit.
std::string error_after(const std::string& file, const std::function<std::string(std::string)>& edit) {
  const Folder folder("face");
  for (const auto& entry : fs::directory_iterator(PLIANT_FIXTURES "/face"))
    fs::copy(entry.path(), folder.path / entry.path().filename());
  std::ifstream in(folder.path / file);
  std::stringstream text;
  text << in.rdbuf();
  in.close();
  const std::string changed = edit(text.str());
  if (changed == text.str()) return "the edit of " + file + " changed nothing";
  fs::remove(folder.path / file);
  if (!changed.empty()) folder.file(file, changed);
  BakeOptions options;
  options.source = folder.path.string();
  options.size = 16;
  std::vector<std::uint8_t> table{1, 2, 3};
  std::string error;
  const bool baked = bake::bake(options, table, error);
  CHECK(baked == error.empty());
  if (!baked) CHECK(table == std::vector<std::uint8_t>{1, 2, 3});
  CHECK(error.find('\n') == std::string::npos);
  const std::size_t start = error.find(file);
  return start == std::string::npos ? error : error.substr(start);
}

/// The first `from` becomes `to`.
std::function<std::string(std::string)> swap(const std::string& from, const std::string& to) {
  return [=](std::string text) {
    const std::size_t at = text.find(from);
    return at == std::string::npos ? text : text.replace(at, from.size(), to);
  };
}

bool is_at_line(const std::string& error, const std::string& file, const std::string& what) {
  const std::string start = file + ":";
  return error.compare(0, start.size(), start) == 0 &&
         std::isdigit(static_cast<unsigned char>(error[start.size()])) &&
         error.find(what) != std::string::npos;
}

}  // namespace

TEST_CASE(
    "each defect of a face's tables is one line that names file and line, and the table stays as it was") {
  struct Defect {
    const char *file, *from, *to, *what;
  };
  const Defect defects[] = {
      {"points.txt", "      u       v", "      u", "expected a column 'v'"},
      {"points.txt", "16.00", "nan", "'nan' in column 'x' is no number"},
      {"points.txt", "lid_margin.1 ", "lid_margin.0 ", "given twice"},
      {"points.txt", "   16.00", "  -16.00", "not in the left half"},
      {"patches.txt", "orbit.2-15", "orbit.2-16", "unknown point 'orbit.16'"},
      {"patches.txt", "orbit.2-15", "orbit.2-x", "is no range of points"},
      {"patches.txt", "orbit.2-15", "orbit.2-14", "not as long as the last"},
      {"patches.txt", "eye skin", "eye bone", "neither skin nor hole"},
      {"parameters.txt", "identity   no", "person     no", "neither identity nor expression"},
      {"parameters.txt", "identity   no", "identity   maybe", "sided is yes or no"},
      {"parameters.txt", "faceDepth", "faceWidth", "given twice"},
      {"parameters.txt", "-3      3       1", "1       3       1", "needs minimum <= 0 <= maximum"},
      {"groups.txt", "lip_line.0-6", "lip_line.0-66", "unknown point"},
      {"followers.txt", "ball_1.0-15", "ball_1.0-14", "not as many leaders as points"},
      {"hinges.txt", "1      0      0 ", "1      1      0 ", "the axis is no unit vector"},
      {"identity.txt", "faceWidth       stretch", "faceWidht       stretch", "unknown parameter 'faceWidht'"},
      {"identity.txt", "faceWidth       stretch", "faceWidth       twist", "kind 'twist' is none of"},
      {"identity.txt", "m_nasion", "m_nasian", "unknown point 'm_nasian'"},
      {"identity.txt", "1000   all", "1000   everyone", "unknown group 'everyone'"},
      {"identity.txt", " 1000 ", " -1 ", "a radius is not negative"},
      {"expressions.txt", "lip_line.9-12", "lip_line.9-12,", "unknown point ''"},
      {"landmarks.txt", "jaw.12", "jaw.11-12", "more than one point"},
      {"landmarks.txt", "jaw.12 ", "jaw.99 ", "unknown point 'jaw.99'"},
      {"curves.txt", " lid ", " lit ", "kind 'lit' is none of"},
      {"curves.txt", "orbit.2-6", "orbit.2", "a curve has at least two points"},
      {"paint.txt", "fill  all", "fell  all", "unknown layer 'fell'"},
      {"paint.txt", "fill  all", "fill  ears", "unknown region 'ears'"},
      {"paint.txt", "orbit.2-6,orbit.7", "orbit.2", "hairs need a line"},
  };
  for (const Defect& d : defects) {
    const std::string error = error_after(d.file, swap(d.from, d.to));
    CHECK_MESSAGE(is_at_line(error, d.file, d.what), (std::string(d.what) + " expected, got: " + error));
  }
}

TEST_CASE("each missing file, and a missing row, is one line that names the file") {
  const auto remove = [](const std::string&) { return std::string(); };
  for (const char* file : {"patches.txt", "parameters.txt", "groups.txt", "followers.txt", "hinges.txt",
                           "identity.txt", "expressions.txt", "landmarks.txt", "curves.txt", "paint.txt"})
    CHECK(error_after(file, remove) == std::string(file) + ": cannot be read");
  CHECK(error_after("points.txt", remove) == "points.txt and others) nor with OBJ files");
  CHECK(error_after("hinges.txt", swap("jawOpen ", "jawShut ")) ==
        "hinges.txt: no row for parameter 'jawOpen'");
  CHECK(error_after("identity.txt", swap("\nfaceWidth ", "\n#faceWidth ")) ==
        "identity.txt: no row for parameter 'faceWidth'");
  // A point dragged across its neighbours makes the chart fold over.
  const std::string folded = error_after("points.txt", [](std::string text) {
    const std::size_t row = text.find("ring_c.4 "), end = text.find('\n', row);
    return text.replace(row, end - row, "ring_c.4 34 43 13 0.95 0.9");
  });
  CHECK_MESSAGE(folded.find("points.txt: the chart (u,v) folds over near point '") == 0, folded);
}

TEST_CASE("impossible options are refused") {
  BakeOptions options;
  options.source = PLIANT_FIXTURES "/face";
  std::vector<std::uint8_t> table;
  std::string error;
  options.bits = 12;
  CHECK_FALSE(bake::bake(options, table, error));
  options.bits = 16;
  options.size = 8;
  CHECK_FALSE(bake::bake(options, table, error));
  CHECK(table.empty());
}
