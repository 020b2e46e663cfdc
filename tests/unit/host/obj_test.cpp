// Models from folders of OBJ files: shapes by name, and principal components of scans.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "aligned_block.hpp"
#include "baked_model.hpp"
#include "host/bake/obj_source.hpp"
#include "host/bake/principal_components.hpp"
#include "obj_folder.hpp"
#include "pliant/mesh.hpp"
#include "random.hpp"

namespace obj_test {

using namespace pliant::host::bake;
using namespace obj_folder;
namespace fs = std::filesystem;

namespace {

/// The table of a folder, with a base mesh as coarse as can be. \param components  of scans; 0: the folder has shapes.
std::vector<std::uint8_t> baked_coarsely(const ObjFolder& folder, BakeReport* report, int components = 0) {
  BakeOptions options;
  options.source = folder.path.string();
  options.base_vertices = 60;
  options.components = components;
  std::vector<std::uint8_t> table;
  std::string error;
  REQUIRE_MESSAGE(bake(options, table, error, report), error);
  return table;
}

bool warns(const host::bake::BakeReport& report, const char* of) {
  return std::any_of(report.warnings.begin(), report.warnings.end(),
                     [of](const std::string& warning) { return warning.find(of) != std::string::npos; });
}

/// A curved sheet with an identity and three expressions, in centimetres, baked once.
struct BakedShapes {
  std::size_t calls = 0, last = 0, of = 0;  // of the progress of files
  BakeReport report;
  std::vector<std::uint8_t> table;
};

const BakedShapes& baked_shapes() {
  static const BakedShapes baked = [] {
    const ObjFolder folder("shapes");
    folder.write("neutral", curved_sheet);
    folder.write("identity000", [](float s, float t) { return curved_sheet(s, t) + Vec3{0, 0.5f * s, 0}; });
    folder.write("mouthSmile_L", [](float s, float t) {
      return curved_sheet(s, t) + hill(s, t) * Vec3{1, 0, 0.3f};
    });
    folder.write("jawOpen", [](float s, float t) {
      return curved_sheet(s, t) + Vec3{0, -(1 - t) * (1 - t), 0};
    });
    folder.write("wiggle_R", [](float s, float t) { return curved_sheet(s, t) + Vec3{0, 0, s * t}; });
    folder.put("landmarks.csv", "landmark,vertex\nibug36,330\nibug45,362\nnose_tip,544\n");
    BakedShapes out;
    BakeOptions options;
    options.source = folder.path.string();
    options.unit_mm = 10;
    options.base_vertices = 120;
    options.progress = [&](const char* stage, std::size_t done, std::size_t of) {
      if (std::string(stage) != "files") return;
      ++out.calls;
      out.last = done;
      out.of = of;
    };
    std::string error;
    REQUIRE_MESSAGE(host::bake::bake(options, out.table, error, &out.report), error);
    return out;
  }();
  return baked;
}

}  // namespace

TEST_CASE(
    "a folder of OBJ files bakes into its shapes: names and errors are reported, and progress is told") {
  const BakedShapes& shapes = baked_shapes();
  CHECK(shapes.calls == 4);
  CHECK(shapes.last == 5);
  CHECK(shapes.of == 5);
  const BakeReport& report = shapes.report;
  CHECK(report.unmatched == std::vector<std::string>{"wiggleRight"});
  CHECK(report.errors.rest.max_mm < 0.05f);
  CHECK(report.errors.expression.max_mm < 0.1f);
  CHECK(report.errors.parameters.size() == 4);

  const BakedModel baked(shapes.table);
  const Model& model = baked.model;
  CHECK(model.parameters().count == 4);
  CHECK(model.parameters()[0].group == Group::identity);
  CHECK(model.parameters()[0].minimum == -3);
  for (const char* name : {"identity000", "mouthSmileLeft", "jawOpen", "wiggleRight"})
    CHECK_MESSAGE(model.find_parameter(name) != kNone, std::string(name));
  const auto smile = model.find_parameter("mouthSmileLeft");
  CHECK(model.parameters()[smile].group == Group::expression);
  CHECK(model.parameters()[smile].maximum == 1);
}

TEST_CASE("the shapes of a folder keep their unit and their places") {
  BakedModel baked(baked_shapes().table);
  const Model& model = baked.model;
  const auto smile = model.find_parameter("mouthSmileLeft");
  // Vertices 330 = (0, 10) and 362 = (32, 10) of the grid are the eye corners: the origin is half way
  // between.
  const float eye_t = 10.0f / 32;
  const Vec3 origin = 10 * (0.5f * (curved_sheet(0, eye_t) + curved_sheet(1, eye_t)));
  CHECK(length(baked.at("ibug36", baked.rest()) + baked.at("ibug45", baked.rest())) < 0.1f);
  for (const auto& [s, t] : {std::pair{0.2f, 0.3f}, {0.5f, 0.5f}, {0.7f, 0.9f}}) {
    auto q = baked.rest();
    CHECK(length(baked.at(chart(s, t), q) - (10 * curved_sheet(s, t) - origin)) < 0.1f);
    const Vec3 rest = baked.at(chart(s, t), q);
    q[smile] = 0.5f;
    CHECK(length(baked.at(chart(s, t), q) - rest - 5 * hill(s, t) * Vec3{1, 0, 0.3f}) < 0.1f);
    CHECK(model.is_on_surface(chart(s, t)));
  }
  CHECK_FALSE(model.is_on_surface({0.05f, 0.5f}));
  CHECK(model.landmarks().count == 3);
  CHECK(length(baked.uv("nose_tip") - chart(16.0f / 32, 16.0f / 32)) < 1e-5f);
}

TEST_CASE("the base mesh of a folder of shapes has one boundary") {
  const BakedModel baked(baked_shapes().table);
  MeshLimits limits;
  AlignedBlock block(measured_bytes<Mesh>(limits));
  Arena arena(block.data(), block.size());
  Mesh mesh;
  REQUIRE(create_in(arena, mesh, limits) == Status::ok);
  CHECK(mesh.set_base(baked.model.base_uv(), baked.model.base_corners()) == Status::ok);
  CHECK(mesh.compute_statistics().boundary_loops == 1);
}

TEST_CASE("a mirrored chart is flipped, so that seen from outside u points right and v down") {
  const ObjFolder folder("hand");
  const auto mirrored = [](float s, float t) { return curved_sheet(1 - s, t); };
  // The faces wind clockwise in the file's (u,v): their outside is the chart's back.
  folder.put("neutral.obj", [&] {
    std::string text = folder.obj(mirrored), result;
    std::size_t start = 0;
    while (start < text.size()) {
      const std::size_t end = text.find('\n', start);
      std::string line = text.substr(start, end - start);
      if (line[0] == 'f') {
        const std::size_t b = line.find(' ', 2), c = line.find(' ', b + 1), d = line.find(' ', c + 1);
        line = "f" + line.substr(d) + line.substr(c, d - c) + line.substr(b, c - b) + " " +
               line.substr(2, b - 2);
      }
      result += line + "\n";
      start = end + 1;
    }
    return result;
  }());
  host::bake::BakeReport report;
  const auto table = baked_coarsely(folder, &report);
  CHECK_FALSE(warns(report, "shows its back"));
  BakedModel baked(table);
  const SurfaceFrame f = baked.cascade.surface_frame({0.4f, 0.6f}, baked.rest().data());
  CHECK(f.pu.x > 0);
  CHECK(f.pv.y < 0);
}

TEST_CASE("what will hardly be tracked is warned of: a surface that is tiny, or far from its origin") {
  const ObjFolder folder("warned");
  const struct {
    float size;  // of the sheet, which is 16 mm across
    Vec3 origin;
    bool is_small, is_far;
  } cases[] = {{10, {}, false, false},
               {10, {0, 0, 900}, false, true},
               {10, {300, 0, 0}, false, false},
               {1, {}, true, false}};
  for (const auto& c : cases) {
    folder.put("neutral.obj",
               folder.obj([&](float s, float t) { return c.size * curved_sheet(s, t) + c.origin; }));
    host::bake::BakeReport report;
    (void)baked_coarsely(folder, &report);
    CHECK(warns(report, "across, and nothing is tracked nearer than 50 mm") == c.is_small);
    CHECK(warns(report, "the origin is ") == c.is_far);
  }
}

TEST_CASE("a landmark whose name is nearly one of iBUG's is warned of") {
  const ObjFolder folder("misspelt");
  folder.write("neutral", curved_sheet);
  for (const bool is_misspelt : {true, false}) {
    folder.put("landmarks.csv", std::string("landmark,vertex\n") + (is_misspelt ? "ibug1" : "ibug01") + ",5\n");
    host::bake::BakeReport report;
    (void)baked_coarsely(folder, &report);
    CHECK(warns(report, "'ibug1' is not found by the name 'ibug01'") == is_misspelt);
  }
}

TEST_CASE("a surface that shows its back or its edge, seen from the front, is warned of") {
  const ObjFolder folder("back");
  enum { front, back, lying, standing };
  for (const int kind : {front, back, lying, standing}) {
    CAPTURE(kind);
    folder.put("neutral.obj", folder.obj([kind](float s, float t) {
      const Vec3 p = curved_sheet(s, t);
      return kind == front   ? p
             : kind == back  ? Vec3{-p.x, p.y, -p.z}  // half a turn about y
             : kind == lying ? Vec3{p.x, p.z, -p.y}
                             : Vec3{0, p.y, -p.x};
    }));
    host::bake::BakeReport report;
    (void)baked_coarsely(folder, &report);
    CHECK(warns(report, "shows its back") == (kind == back));
    CHECK(warns(report, "is edge-on") == (kind == lying || kind == standing));
  }
}

TEST_CASE(
    "one OBJ file is a surface without parameters; its numbers may be repeated, a v of 0 may be left out, and "
    "polygons may be concave") {
  const ObjFolder folder("one");
  std::string text = "mtllib x.mtl\nusemtl a\n";
  // An L of two cells and a concave pentagon, each with corners of its own, and a vertex that no face uses.
  const std::vector<std::vector<Vec2>> faces = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}},
                                                {{0, 1}, {1, 1}, {1, 2}, {0, 2}},
                                                {{1, 0}, {2, 0}, {2, 1}, {1.5f, 0.5f}, {1, 1}}};
  int count = 0;
  for (const auto& face : faces) {
    std::string corners;
    for (const Vec2 p : face) {
      text += "v " + std::to_string(50 * p.x) + " " + std::to_string(50 * p.y) + " 0\n";
      const std::string v = p.y > 0 ? std::to_string(0.5f * p.y) : p.x > 1 ? "# v is 0" : "";
      text += "vt " + std::to_string(0.5f * p.x) + " " + v + "\n";
      ++count;
      corners += " " + std::to_string(count) + "/" + std::to_string(count);
    }
    text += "usemtl b\nf" + corners + "\n";
  }
  folder.put("any name.obj", text + "v 1e9 0 0\n");
  BakeOptions options;
  options.source = folder / "any name.obj";
  options.base_vertices = 100;
  std::vector<std::uint8_t> table;
  std::string error;
  BakeReport report;
  REQUIRE_MESSAGE(host::bake::bake(options, table, error, &report), error);
  BakedModel baked(table);
  CHECK(baked.model.parameters().count == 0);
  CHECK(report.errors.rest.max_mm < 0.05f);
  CHECK(length(baked.at(Vec2{0.9f, 0.9f}, {}) - Vec3{90, 10, 0}) < 0.05f);
}

TEST_CASE("a parameter may go either way alone: its field is as exact at its farther limit") {
  const ObjFolder folder("one_way");
  const auto dented = [](float s, float t) {
    const float off = (s - 0.5f) * (s - 0.5f) + (t - 0.5f) * (t - 0.5f);
    return curved_sheet(s, t) + Vec3{0, 0, 3 * std::exp(-20 * off)};
  };
  folder.write("neutral", curved_sheet);
  folder.write("dent", dented);
  for (const char* const range : {"-1 1", "-1 0", "-1 0.05", "0 1"}) {
    CAPTURE(range);
    folder.put("parameters.txt",
               "parameter group minimum maximum sd\ndent expression " + std::string(range) + " 0.5\n");
    BakeOptions options;
    options.source = folder.path.string();
    std::vector<std::uint8_t> table;
    std::string error;
    REQUIRE_MESSAGE(host::bake::bake(options, table, error), error);
    BakedModel baked(table);
    const float way = range[0] == '-' ? -1.0f : 1.0f;
    for (const Vec2 at : {Vec2{0.5f, 0.5f}, Vec2{0.4f, 0.6f}, Vec2{0.7f, 0.5f}}) {
      const Vec3 rest = curved_sheet(at.x, at.y), there = rest + way * (dented(at.x, at.y) - rest);
      CHECK(length(baked.at(chart(at.x, at.y), {way}) - there) < 0.02f);
    }
  }
}

TEST_CASE("a parameter has no name of another column of a track") {
  const ObjFolder folder("column");
  folder.write("neutral", curved_sheet);
  for (const char* const name : {"tx", "state", "x_centre"}) {
    const fs::path file = folder.path / (std::string(name) + ".obj");
    folder.write(name, [](float s, float t) { return curved_sheet(s, t) + Vec3{0, 0, s}; });
    CHECK(error_of(folder).find("'" + std::string(name) + "' has the name of another column of a track") !=
          std::string::npos);
    fs::remove(file);
  }
}

TEST_CASE("a small table gives a parameter its range, so that it goes both ways") {
  const ObjFolder folder("ranges");
  folder.write("neutral", curved_sheet);
  folder.write("bend", [](float s, float t) { return curved_sheet(s, t) + Vec3{0, 0, 3 * s * (1 - s)}; });
  folder.write("roll_L", [](float s, float t) { return curved_sheet(s, t) + Vec3{0, 0, t}; });
  folder.put(
      "parameters.txt",
      "# ranges\nparameter group minimum maximum sd\nbend expression -1 1 0.5\nrollLeft identity -2 2 0.8\n");
  BakeOptions options;
  options.source = folder.path.string();
  options.base_vertices = 100;
  std::vector<std::uint8_t> table;
  std::string error;
  REQUIRE_MESSAGE(host::bake::bake(options, table, error), error);
  BakedModel baked(table);
  const Parameter& bend = baked.model.parameters()[baked.model.find_parameter("bend")];
  CHECK(bend.minimum == -1);
  CHECK(bend.maximum == 1);
  CHECK(bend.sd == 0.5f);
  CHECK(baked.model.parameters()[baked.model.find_parameter("rollLeft")].group == Group::identity);
  std::vector<float> q(2, 0.0f);
  q[baked.model.find_parameter("bend")] = -1;
  CHECK(length(baked.at(chart(0.5f, 0.5f), q) - (curved_sheet(0.5f, 0.5f) - Vec3{0, 0, 0.75f})) < 0.01f);
  const auto refused = [&](const std::string& row, const std::string& what) {
    folder.put("parameters.txt", "parameter group minimum maximum sd\n" + row);
    CHECK(error_of(folder) == folder / "parameters.txt" + ":2: " + what);
  };
  refused("flip expression -1 1 0.5\n", "there is no file for parameter 'flip'");
  refused("roll_L expression -1 1 0.5\n", "the parameter of roll_L.obj is 'rollLeft'");
  refused("bend expression 0.5 1 0.5\n",
          "needs -1000 <= minimum <= 0 <= maximum <= 1000 and 0.001 <= sd <= 1000");
  refused("bend expression -1 1 0\n",
          "needs -1000 <= minimum <= 0 <= maximum <= 1000 and 0.001 <= sd <= 1000");
  refused("bend motion -1 1 1\n", "group 'motion' is neither identity nor expression");
}

TEST_CASE(
    "bending modes of an OBJ file are parameters; a group that is fixed does not move, and a cut stays "
    "closed") {
  const ObjFolder folder("modes");
  // A tube with a cut along it; the faces of its lower end are held.
  const int n = 24, m = 16;
  std::string text;
  for (int j = 0; j <= m; ++j)
    for (int i = 0; i <= n; ++i) {
      const float a = i == n ? 0 : 6.2831853f * static_cast<float>(i) / n;
      text += "v " + std::to_string(30 * std::cos(a)) + " " + std::to_string(5 * j) + " " +
              std::to_string(-30 * std::sin(a)) + "\nvt " + std::to_string(static_cast<float>(i) / n) + " " +
              std::to_string(static_cast<float>(j) / m) + "\n";
    }
  for (int j = 0; j < m; ++j) {
    text += j == 0 ? "g end fixed\n" : "g rest\n";
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i + 1;
      text += "f";
      for (const int v : {a, a + 1, a + n + 2, a + n + 1})
        text += " " + std::to_string(v) + "/" + std::to_string(v);
      text += "\n";
    }
  }
  folder.put("tube.obj", text);
  BakeOptions options;
  options.source = folder / "tube.obj";
  options.base_vertices = 100;
  options.modes = 3;
  std::vector<std::uint8_t> table;
  std::string error;
  BakeReport report;
  REQUIRE_MESSAGE(host::bake::bake(options, table, error, &report), error);
  BakedModel baked(table);
  REQUIRE(baked.model.parameters().count == 3);
  CHECK(std::string(baked.model.parameters()[2].name) == "mode02");
  CHECK(baked.model.parameters()[2].minimum == -3);
  CHECK(baked.model.parameters()[2].sd == 1);
  CHECK(report.unmatched.empty());
  for (int k = 0; k < 3; ++k) {
    std::vector<float> q(3, 0.0f);
    q[static_cast<std::size_t>(k)] = 3;
    float moved = 0;
    for (int i = 0; i <= 20; ++i) {
      const float u = static_cast<float>(i) / 20;
      CHECK(length(baked.at(Vec2{u, 0.999f}, q) - baked.at(Vec2{u, 0.999f}, {0, 0, 0})) < 0.05f);
      moved = max(moved, length(baked.at(Vec2{u, 0}, q) - baked.at(Vec2{u, 0}, {0, 0, 0})));
      // Each shape adds the error of its grid: 0.22 mm with the corrective shapes, at nine times their size.
      CHECK(length(baked.at(Vec2{0, u}, q) - baked.at(Vec2{1, u}, q)) < 0.25f);
    }
    CHECK(moved > 5);
  }
  options.modes = 65;
  CHECK_FALSE(host::bake::bake(options, table, error));
  CHECK(error == "--modes: must be from 1 to 64");
  options.modes = 1;
  options.stiffness = 0;
  CHECK_FALSE(host::bake::bake(options, table, error));
  CHECK(error == "--stiffness: must be from 0.0001 to 10000");
}

TEST_CASE("principal components are orthogonal, have the right length and explain the variance") {
  Random random(3);
  const std::size_t vertices = 50;
  std::vector<Vec3> first, second;
  for (std::size_t v = 0; v < vertices; ++v) {
    first.push_back({random.normal(), random.normal(), random.normal()});
    second.push_back({random.normal(), random.normal(), random.normal()});
  }
  std::vector<std::vector<Vec3>> shapes;
  for (int k = 0; k < 200; ++k) {
    const float a = 3 * random.normal(), b = random.normal();
    std::vector<Vec3> shape;
    for (std::size_t v = 0; v < vertices; ++v) shape.push_back(Vec3{1, 2, 3} + a * first[v] + b * second[v]);
    shapes.push_back(shape);
  }
  const PrincipalComponents pca = find_components(shapes, 2);
  const auto product = [&](const std::vector<Vec3>& x, const std::vector<Vec3>& y) {
    double sum = 0;
    for (std::size_t v = 0; v < vertices; ++v) sum += static_cast<double>(dot(x[v], y[v]));
    return sum;
  };
  CHECK(pca.explained[0] + pca.explained[1] == doctest::Approx(1).epsilon(1e-4));
  CHECK(pca.explained[0] > 0.8f);
  CHECK(std::fabs(product(pca.components[0], pca.components[1])) < 1e-2);
  // Nearly 3 times the first direction, up to sign.
  const double along = product(pca.components[0], first) / product(first, first);
  CHECK(std::fabs(along) == doctest::Approx(3).epsilon(0.2));
  // Every shape is the mean and a sum of the components; its coefficients have unit variance.
  double squares = 0;
  for (const auto& shape : shapes) {
    std::vector<Vec3> rest;
    for (std::size_t v = 0; v < vertices; ++v) rest.push_back(shape[v] - pca.mean[v]);
    for (std::size_t c = 0; c < 2; ++c) {
      const double q = product(rest, pca.components[c]) / product(pca.components[c], pca.components[c]);
      if (c == 0) squares += q * q / 199;
      for (std::size_t v = 0; v < vertices; ++v)
        rest[v] = rest[v] - static_cast<float>(q) * pca.components[c][v];
    }
    CHECK(product(rest, rest) < 1e-4);
  }
  CHECK(squares == doctest::Approx(1).epsilon(1e-3));
}

TEST_CASE("scans without names bake into their mean and components") {
  const ObjFolder folder("scans");
  for (int k = 0; k < 6; ++k) {
    const float a = static_cast<float>(k) - 2.5f;
    folder.write("scan" + std::to_string(k), [a](float s, float t) {
      return curved_sheet(s, t) + a * Vec3{0, s, 0} + 0.2f * a * a * hill(s, t) * Vec3{0, 0, 1};
    });
  }
  BakedModel baked(baked_coarsely(folder, nullptr, 2));
  REQUIRE(baked.model.parameters().count == 2);
  CHECK(std::string(baked.model.parameters()[0].name) == "identity000");
  CHECK(baked.model.parameters()[0].sd == 1);
  // The first scan is found again among the shapes: a grid of coefficients comes close to it everywhere.
  float best = 1e9f;
  for (float q0 = -3; q0 <= 3; q0 += 0.05f)
    for (float q1 = -3; q1 <= 3; q1 += 0.05f) {
      float worst = 0;
      for (const auto& [s, t] : {std::pair{0.2f, 0.3f}, {0.5f, 0.4f}, {0.9f, 0.8f}}) {
        const Vec3 scan = curved_sheet(s, t) + Vec3{0, -2.5f * s, 0} + 0.2f * 6.25f * hill(s, t) * Vec3{0, 0, 1};
        worst = max(worst, length(baked.at(chart(s, t), {q0, q1}) - scan));
      }
      best = min(best, worst);
    }
  CHECK(best < 0.1f);
  CHECK(error_of(folder, 6) == folder.path.string() + ": 6 scans have at most 5 components");
}

TEST_CASE("a file that is the rest shape once more is told of: its parameter moves nothing") {
  const ObjFolder folder("still");
  folder.write("neutral", curved_sheet);
  folder.write("bend", [](float s, float t) { return curved_sheet(s, t) + Vec3{0, 0, s * s}; });
  folder.write("ear_L", curved_sheet);
  host::bake::BakeReport report;
  baked_coarsely(folder, &report);
  CHECK(warns(report, "ear_L.obj is the rest shape: the parameter 'earLeft' moves nothing"));
  CHECK_FALSE(warns(report, "bend"));
  folder.put("parameters.txt", "parameter group minimum maximum sd\nbend expression 0 0 1\n");
  baked_coarsely(folder, &report);
  CHECK(warns(report, "parameters.txt limits 'bend' to 0 and 0: the parameter moves nothing"));
}

TEST_CASE("scans that differ in fewer ways than components are wanted: those that move nothing are told of") {
  const ObjFolder folder("few_ways");
  for (const char* const name : {"a", "b", "c", "d"})
    folder.write(name, [by = static_cast<float>(name[0] - 'b')](float s, float t) {
      return curved_sheet(s, t) + Vec3{0, 0, by * s * s};
    });
  host::bake::BakeReport report;
  (void)baked_coarsely(folder, &report, 2);
  CHECK(warns(report, "the scans differ in fewer ways than 2: the parameter 'identity001' moves nothing"));
  CHECK_FALSE(warns(report, "identity000"));
}

}  // namespace obj_test
