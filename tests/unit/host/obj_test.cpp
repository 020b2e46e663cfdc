// Models from folders of OBJ files: shapes by name, principal components of scans, and one line for every
// defect.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>

#include "aligned_block.hpp"
#include "baked_model.hpp"
#include "host/bake/bake.hpp"
#include "host/bake/obj_source.hpp"
#include "host/bake/principal_components.hpp"
#include "pliant/mesh.hpp"
#include "random.hpp"
#include "scratch_folder.hpp"

using namespace pliant;
using namespace pliant::host::bake;
namespace fs = std::filesystem;

namespace {

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
  void write(const std::string& name, const std::string& text) const { std::ofstream(path / name) << text; }
  void write(const std::string& name, const Shape& shape) const { write(name + ".obj", obj(shape)); }
  std::string file(const std::string& name) const { return (path / name).string(); }
};

Vec3 sheet(float s, float t) {
  return {10 * s - 5, 12 * t - 6, 4 * s * (1 - s)};
}
float hill(float s, float t) {
  return std::exp(-20 * ((s - 0.5f) * (s - 0.5f) + (t - 0.4f) * (t - 0.4f)));
}

/// Where (s,t) lies in the chart of the table: v points down there.
Vec2 chart(float s, float t) {
  return {0.1f + 0.8f * s, 0.95f - 0.9f * t};
}

std::string swapped(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

std::string error_of(const ObjFolder& folder, int components = 0) {
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

/// A folder of defects, and the line of the first face of an OBJ file in it.
struct Defects {
  ObjFolder folder{"defects"};
  std::string good = folder.obj(sheet), neutral = folder.file("neutral.obj");
  std::string first_face = "f 1/1/ 2/2/ 35/35/ 34/34/\n";
  int face_line = static_cast<int>(std::count(
                      good.begin(), good.begin() + static_cast<std::ptrdiff_t>(good.find("\nf ")), '\n')) +
                  2;

  /// The error with this text as a file.
  std::string error_with(const char* file, const std::string& text) const {
    folder.write(file, text);
    return error_of(folder);
  }
};

}  // namespace

TEST_CASE("a folder of OBJ files bakes into its shapes: unit, names and places are kept") {
  const ObjFolder folder("shapes");
  folder.write("neutral", sheet);
  folder.write("identity000", [](float s, float t) { return sheet(s, t) + Vec3{0, 0.5f * s, 0}; });
  folder.write("mouthSmile_L", [](float s, float t) { return sheet(s, t) + hill(s, t) * Vec3{1, 0, 0.3f}; });
  folder.write("jawOpen", [](float s, float t) { return sheet(s, t) + Vec3{0, -(1 - t) * (1 - t), 0}; });
  folder.write("wiggle_R", [](float s, float t) { return sheet(s, t) + Vec3{0, 0, s * t}; });
  folder.write("landmarks.csv", "landmark,vertex\nibug36,330\nibug45,362\nnose_tip,544\n");
  BakeOptions options;
  options.source = folder.path.string();
  options.unit_mm = 10;
  options.base_vertices = 120;
  std::size_t calls = 0, last = 0;
  options.progress = [&](const char* stage, std::size_t done, std::size_t of) {
    if (std::string(stage) != "files") return;
    ++calls;
    last = done;
    CHECK(of == 5);
  };
  std::vector<std::uint8_t> table;
  std::string error;
  BakeReport report;
  REQUIRE_MESSAGE(host::bake::bake(options, table, error, &report), error);
  BakedModel baked(table);
  CHECK(calls == 4);
  CHECK(last == 5);
  CHECK(report.unmatched == std::vector<std::string>{"wiggleRight"});
  CHECK(report.errors.rest.max_mm < 0.05f);
  CHECK(report.errors.expression.max_mm < 0.1f);
  CHECK(report.errors.parameters.size() == 4);

  const Model& model = baked.model;
  CHECK(model.parameters().count == 4);
  CHECK(model.parameters()[0].group == Group::identity);
  CHECK(model.parameters()[0].minimum == -3);
  for (const char* name : {"identity000", "mouthSmileLeft", "jawOpen", "wiggleRight"})
    CHECK_MESSAGE(model.find_parameter(name) != kNone, std::string(name));
  const auto smile = model.find_parameter("mouthSmileLeft");
  CHECK(model.parameters()[smile].group == Group::expression);
  CHECK(model.parameters()[smile].maximum == 1);

  // Vertices 330 = (0, 10) and 362 = (32, 10) of the grid are the eye corners: the origin is half way
  // between.
  const float eye_t = 10.0f / 32;
  const Vec3 origin = 10 * (0.5f * (sheet(0, eye_t) + sheet(1, eye_t)));
  CHECK(length(baked.at("ibug36", baked.rest()) + baked.at("ibug45", baked.rest())) < 0.1f);
  for (const auto& [s, t] : {std::pair{0.2f, 0.3f}, {0.5f, 0.5f}, {0.7f, 0.9f}}) {
    auto q = baked.rest();
    CHECK(length(baked.at(chart(s, t), q) - (10 * sheet(s, t) - origin)) < 0.1f);
    const Vec3 rest = baked.at(chart(s, t), q);
    q[smile] = 0.5f;
    CHECK(length(baked.at(chart(s, t), q) - rest - 5 * hill(s, t) * Vec3{1, 0, 0.3f}) < 0.1f);
    CHECK(model.is_on_surface(chart(s, t)));
  }
  CHECK_FALSE(model.is_on_surface({0.05f, 0.5f}));
  CHECK(model.landmarks().count == 3);
  CHECK(length(baked.uv("nose_tip") - chart(16.0f / 32, 16.0f / 32)) < 1e-5f);

  MeshLimits limits;
  AlignedBlock block(measured_bytes<Mesh>(limits));
  Arena arena(block.data(), block.size());
  Mesh mesh;
  REQUIRE(create_in(arena, mesh, limits) == Status::ok);
  CHECK(mesh.set_base(model.base_uv(), model.base_corners()) == Status::ok);
  CHECK(mesh.compute_statistics().boundary_loops == 1);
}

TEST_CASE("a mirrored chart is flipped, so that seen from outside u points right and v down") {
  const ObjFolder folder("hand");
  const auto mirrored = [](float s, float t) { return sheet(1 - s, t); };
  // The faces wind clockwise in the file's (u,v): their outside is the chart's back.
  folder.write("neutral.obj", [&] {
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
  BakeOptions options;
  options.source = folder.path.string();
  options.base_vertices = 60;
  std::vector<std::uint8_t> table;
  std::string error;
  REQUIRE_MESSAGE(host::bake::bake(options, table, error), error);
  BakedModel baked(table);
  const SurfaceFrame f = baked.cascade.surface_frame({0.4f, 0.6f}, baked.rest().data());
  CHECK(f.pu.x > 0);
  CHECK(f.pv.y < 0);
}

TEST_CASE(
    "one OBJ file is a surface without parameters; its numbers may be repeated, and polygons may be "
    "concave") {
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
      text += "vt " + std::to_string(0.5f * p.x) + " " + std::to_string(0.5f * p.y) + "\n";
      ++count;
      corners += " " + std::to_string(count) + "/" + std::to_string(count);
    }
    text += "usemtl b\nf" + corners + "\n";
  }
  folder.write("any name.obj", text + "v 1e9 0 0\n");
  BakeOptions options;
  options.source = folder.file("any name.obj");
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

TEST_CASE("a small table gives a parameter its range, so that it goes both ways") {
  const ObjFolder folder("ranges");
  folder.write("neutral", sheet);
  folder.write("bend", [](float s, float t) { return sheet(s, t) + Vec3{0, 0, 3 * s * (1 - s)}; });
  folder.write("roll_L", [](float s, float t) { return sheet(s, t) + Vec3{0, 0, t}; });
  folder.write(
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
  CHECK(length(baked.at(chart(0.5f, 0.5f), q) - (sheet(0.5f, 0.5f) - Vec3{0, 0, 0.75f})) < 0.01f);
  const auto refused = [&](const std::string& row, const std::string& what) {
    folder.write("parameters.txt", "parameter group minimum maximum sd\n" + row);
    CHECK(error_of(folder) == folder.file("parameters.txt") + ":2: " + what);
  };
  refused("flip expression -1 1 0.5\n", "there is no file for parameter 'flip'");
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
  folder.write("tube.obj", text);
  BakeOptions options;
  options.source = folder.file("tube.obj");
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
      return sheet(s, t) + a * Vec3{0, s, 0} + 0.2f * a * a * hill(s, t) * Vec3{0, 0, 1};
    });
  }
  BakeOptions options;
  options.source = folder.path.string();
  options.components = 2;
  options.base_vertices = 60;
  std::vector<std::uint8_t> table;
  std::string error;
  REQUIRE_MESSAGE(host::bake::bake(options, table, error), error);
  BakedModel baked(table);
  REQUIRE(baked.model.parameters().count == 2);
  CHECK(std::string(baked.model.parameters()[0].name) == "identity000");
  CHECK(baked.model.parameters()[0].sd == 1);
  // The first scan is found again among the shapes: a grid of coefficients comes close to it everywhere.
  float best = 1e9f;
  for (float q0 = -3; q0 <= 3; q0 += 0.05f)
    for (float q1 = -3; q1 <= 3; q1 += 0.05f) {
      float worst = 0;
      for (const auto& [s, t] : {std::pair{0.2f, 0.3f}, {0.5f, 0.4f}, {0.9f, 0.8f}}) {
        const Vec3 scan = sheet(s, t) + Vec3{0, -2.5f * s, 0} + 0.2f * 6.25f * hill(s, t) * Vec3{0, 0, 1};
        worst = max(worst, length(baked.at(chart(s, t), {q0, q1}) - scan));
      }
      best = min(best, worst);
    }
  CHECK(best < 0.1f);
  CHECK(error_of(folder, 6) == folder.path.string() + ": 6 scans have at most 5 components");
}

TEST_CASE("each defect of an OBJ file is one line that names the file and the line") {
  const Defects d;
  const std::string &good = d.good, &neutral = d.neutral, &first_face = d.first_face;
  const auto at_face = [&](const std::string& what) {
    return neutral + ":" + std::to_string(d.face_line) + ": " + what;
  };
  const auto neutral_error = [&](const std::string& text) { return d.error_with("neutral.obj", text); };
  CHECK(neutral_error(good) == "");
  CHECK(neutral_error("") == neutral + ": holds no vertices");
  CHECK(neutral_error("v 1 2\n") == neutral + ":1: '' is not a number");
  CHECK(neutral_error("v 1 2 nan\n") == neutral + ":1: 'nan' is not a number");
  CHECK(neutral_error("v 1 2 3\n") == neutral + ": holds no faces");
  CHECK(neutral_error(swapped(good, first_face, "f 1/1/ 2/2/\n")) ==
        at_face("a face has at least three corners"));
  CHECK(neutral_error(swapped(good, first_face, "f 1/1/ 2/2/ 9999/35/ 34/34/\n")) ==
        at_face("there is no vertex 9999"));
  CHECK(neutral_error(swapped(good, first_face, "f 1/1/ 2/2/ 0/35/ 34/34/\n")) ==
        at_face("there is no vertex 0"));
  CHECK(neutral_error(swapped(good, first_face, "f 1/1/ 2/2/ x/35/ 34/34/\n")) ==
        at_face("'x' is not an index"));
  CHECK(neutral_error(swapped(good, first_face, "f 1/1/ 2/2/ 35/9999/ 34/34/\n")) ==
        at_face("there is no texture coordinate 9999"));
  CHECK(neutral_error(swapped(good, first_face, "f 1 2 35 34\n")) ==
        at_face("the face has no texture coordinates"));
  CHECK(neutral_error(swapped(good, first_face, "f 1/1/ 2/2/ 35/34/ 34/35/\n")) ==
        at_face("the chart has a fold-over at this face"));
  CHECK(neutral_error(swapped(good, "v 5.000000 ", "v 5e9 ")) ==
        neutral + ": vertex 33 is more than 100 m from the origin: check it and --unit");
  CHECK(neutral_error(swapped(good, first_face, first_face + first_face)) ==
        neutral + ":" + std::to_string(d.face_line + 1) +
            ": the face and its neighbour have opposite windings");
  CHECK(neutral_error(swapped(good, "vt 0.100000", "vt -0.10000")) ==
        at_face("a texture coordinate of the face is outside 0 to 1"));
}

TEST_CASE("a file of an OBJ folder that differs from neutral.obj in more than places is refused by name") {
  const Defects d;
  const std::string &good = d.good, &neutral = d.neutral, &first_face = d.first_face;
  const std::string smile = d.folder.file("mouthSmile_L.obj");
  d.folder.write("neutral.obj", good);
  const auto smile_error = [&](const std::string& text) { return d.error_with("mouthSmile_L.obj", text); };
  CHECK(smile_error("v 1 2 3\n") == smile + ": has 1 vertices, not 1089 as " + neutral);
  CHECK(smile_error(swapped(good, first_face, "")) == smile + ": has 1023 faces, not 1024 as " + neutral);
  CHECK(smile_error(swapped(good, first_face, "f 1/1/ 2/2/ 35/35/\n")) ==
        smile + ": has 4095 corners of faces, not 4096 as " + neutral);
  CHECK(smile_error(swapped(good, first_face, "f 1/1/ 2/2/ 36/35/ 34/34/\n")) ==
        smile + ":" + std::to_string(d.face_line) + ": the face differs from that of " + neutral);
}

TEST_CASE("bad landmarks and a missing rest shape of an OBJ folder are refused by name") {
  const Defects d;
  const ObjFolder& folder = d.folder;
  const std::string csv = folder.file("landmarks.csv");
  folder.write("neutral.obj", d.good);
  const auto csv_error = [&](const std::string& text) { return d.error_with("landmarks.csv", text); };
  CHECK(csv_error("landmark,vertex\nibug30,5\n") == "");
  CHECK(csv_error("name,vertex\n") == csv + ":1: expected the columns landmark,vertex");
  CHECK(csv_error("landmark,vertex\nibug30\n") == csv + ":2: 'ibug30' is not a landmark and a vertex");
  CHECK(csv_error("landmark,vertex\nibug30,x\n") == csv + ":2: 'ibug30,x' is not a landmark and a vertex");
  CHECK(csv_error("landmark,vertex\n\nibug30,1089\n") == csv + ":3: there is no vertex 1089 on a face");
  fs::remove(folder.path / "landmarks.csv");

  fs::remove(folder.path / "neutral.obj");
  CHECK(error_of(folder).find("nor OBJ files") != std::string::npos);
  folder.write("jawOpen.obj", d.good);
  folder.write("jawLeft.obj", d.good);
  CHECK(error_of(folder) == d.neutral + ": cannot be read");
  fs::remove(folder.path / "jawLeft.obj");  // the only file is the rest shape
  CHECK(error_of(folder) == "");
}
