// `pliant mesh`: what it writes is read back, every criterion does what it says, and bad words are refused.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "cli_run.hpp"
#include "host/io/image.hpp"
#include "mesh_reader.hpp"

namespace cli_mesh_test {

using namespace cli_run;
using namespace mesh_reader;

namespace {

Parsed parse_ply(const std::string& bytes) {
  Parsed mesh;
  const std::string end = "end_header\n";
  const std::size_t body = bytes.find(end) + end.size();
  const std::string header = bytes.substr(0, body);
  CHECK(header.rfind("ply\nformat binary_little_endian 1.0\n", 0) == 0);
  const auto count = [&](const std::string& of) {
    return static_cast<std::size_t>(std::stoi(header.substr(header.find("element " + of) + 9 + of.size())));
  };
  std::size_t at = body;
  for (std::size_t v = 0; v < count("vertex"); ++v, at += 32) {
    float f[8];
    for (std::size_t k = 0; k < 8; ++k) f[k] = take<float>(bytes, at + 4 * k);
    mesh.position.push_back({f[0], f[1], f[2]});
    mesh.normal.push_back({f[3], f[4], f[5]});
    mesh.uv.push_back({f[6], 1 - f[7]});
  }
  for (std::size_t k = 0; k < count("face"); ++k, at += 7) {
    CHECK(bytes[at] == 3);
    mesh.faces.push_back({take<std::uint16_t>(bytes, at + 1), take<std::uint16_t>(bytes, at + 3),
                          take<std::uint16_t>(bytes, at + 5)});
  }
  CHECK(at == bytes.size());
  return mesh;
}

void check_mesh(const Parsed& mesh, std::size_t vertices, std::size_t faces) {
  REQUIRE(mesh.position.size() == vertices);
  REQUIRE(mesh.normal.size() == vertices);
  REQUIRE(mesh.uv.size() == vertices);
  REQUIRE(mesh.faces.size() == faces);
  std::set<int> used;
  int inward = 0;
  for (const auto& f : mesh.faces) {
    for (int v : f) {
      REQUIRE(v >= 0);
      REQUIRE(v < static_cast<int>(vertices));
      used.insert(v);
    }
    const auto corner = [&](std::size_t k) { return static_cast<std::size_t>(f[k]); };
    const Vec3 a = mesh.position[corner(0)], b = mesh.position[corner(1)], c = mesh.position[corner(2)];
    inward += dot(cross(b - a, c - a), mesh.normal[corner(0)]) <= 0;
  }
  CHECK(inward == 0);
  CHECK(used.size() == vertices);
  for (const Vec3 n : mesh.normal) CHECK(length(n) == doctest::Approx(1).epsilon(1e-3));
}

/// A number of the report, behind `before`.
double reported(const std::string& out, const std::string& before) {
  const std::size_t at = out.find(before);
  REQUIRE(at != std::string::npos);
  return std::stod(out.substr(at + before.size()));
}

struct MeshFolder : Folder {
  std::string path = put("m.plm", model_bytes());

  Ran mesh(std::vector<std::string> words) const {
    words.insert(words.begin(), {"mesh", path});
    const Ran r = run_words(words);
    CAPTURE(r.err);
    REQUIRE(r.code == 0);
    return r;
  }
  int vertices(const std::vector<std::string>& words) const {
    return static_cast<int>(reported(mesh(words).out, "m.plm: "));
  }
};

}  // namespace

TEST_CASE("OBJ, PLY and GLB hold the same mesh, and it lies on the model's surface") {
  const MeshFolder m;
  const TexturedModel truth;
  Parsed parsed[3];
  const char* names[] = {"a.obj", "a.ply", "a.glb"};
  for (std::size_t k = 0; k < 3; ++k) {
    const Ran r = m.mesh({"--criterion", "uniform", "--depth", "2", "-o", m / names[k]});
    CHECK(r.err == "");
    const std::string bytes = read_file(m / names[k]);
    parsed[k] = k == 0 ? parse_obj(bytes) : k == 1 ? parse_ply(bytes) : parse_glb(bytes);
    // 6 x 6 squares of two faces, each edge halved: a grid of 12 x 12 squares.
    check_mesh(parsed[k], 169, 288);
    CHECK(parsed[k].faces == parsed[0].faces);
  }
  for (std::size_t v = 0; v < 169; ++v) {
    const Vec2 t = parsed[2].uv[v];
    CHECK(length(parsed[2].position[v] - truth.rest(t.x, t.y)) < 0.3f);  // a field of 65 x 65 samples
    for (std::size_t k = 0; k < 2; ++k) {
      CHECK(length(parsed[k].position[v] - parsed[2].position[v]) < 1e-3f);
      CHECK(length(parsed[k].uv[v] - t) < 1e-5f);
    }
  }
}

TEST_CASE("a GLB is in metres by its node, says how large it is, and carries the albedo as a PNG") {
  const MeshFolder m;
  m.mesh({"--criterion", "none", "-o", m / "a.glb"});
  const Glb glb(read_file(m / "a.glb"));
  CHECK(glb.json.at("asset").at("version") == "2.0");
  CHECK(glb.at("nodes", 0).at("scale").at(1).get<float>() == 0.001f);
  const Parsed mesh = parse_glb(read_file(m / "a.glb"));
  float low = 1e9f, high = -1e9f;
  for (const Vec3 p : mesh.position) low = min(low, p.y), high = max(high, p.y);
  const Json& positions = glb.at("accessors", 0);
  CHECK(positions.at("min").at(1).get<double>() == doctest::Approx(static_cast<double>(low)));
  CHECK(positions.at("max").at(1).get<double>() == doctest::Approx(static_cast<double>(high)));
  CHECK(high > 75);
  CHECK(glb.view(Glb::number(glb.at("images", 0), "bufferView")).substr(1, 3) == "PNG");
  // The chart reaches the picture's border, where a picture that repeats blends in the opposite one.
  CHECK(std::any_of(mesh.uv.begin(), mesh.uv.end(), [](Vec2 uv) { return uv.x == 0; }));
  const Json& sampler = glb.at("samplers", Glb::number(glb.at("textures", 0), "sampler"));
  CHECK(Glb::number(sampler, "wrapS") == 33071);  // CLAMP_TO_EDGE
  CHECK(Glb::number(sampler, "wrapT") == 33071);
}

TEST_CASE("the chart has every face once, within the picture, tinted by level") {
  const MeshFolder m;
  const Ran r = m.mesh({"--criterion", "contour", "--threshold", "0.5", "--uv-svg", m / "c.svg"});
  const std::string svg = read_file(m / "c.svg");
  CHECK(svg.rfind("<svg xmlns=", 0) == 0);
  CHECK(contains(svg, "</svg>\n"));
  CHECK(std::count(svg.begin(), svg.end(), 'M') == static_cast<int>(reported(r.out, "vertices, ")));
  CHECK(std::count(svg.begin(), svg.end(), 'Z') == std::count(svg.begin(), svg.end(), 'M'));
  const auto levels = static_cast<int>(reported(r.out, "deepest level "));
  std::size_t paths = 0;
  for (std::size_t at = svg.find("<path"); at != std::string::npos; at = svg.find("<path", at + 1)) ++paths;
  CHECK(paths == static_cast<std::size_t>(levels) + 1);
}

TEST_CASE("each criterion refines more where more is asked, and the error falls") {
  const MeshFolder m;
  CHECK(m.vertices({"--criterion", "none"}) == 49);
  CHECK(m.vertices({"--criterion", "uniform", "--depth", "0"}) == 49);
  CHECK(m.vertices({"--criterion", "uniform"}) == m.vertices({"--criterion", "uniform", "--depth", "3"}));
  struct Row {
    const char *criterion, *option, *less, *more;
  };
  for (const Row& row : {Row{"uniform", "--depth", "1", "4"}, Row{"normals", "--threshold", "40", "12"},
                         Row{"contour", "--threshold", "1", "0.1"}, Row{"contour", "--budget", "80", "400"},
                         Row{"uniform", "--budget", "60", "90"}, Row{"normals", "--budget", "80", "400"}}) {
    CAPTURE(row.criterion);
    CAPTURE(row.option);
    const Ran less = m.mesh({"--criterion", row.criterion, row.option, row.less});
    const Ran more = m.mesh({"--criterion", row.criterion, row.option, row.more});
    CHECK(reported(less.out, "m.plm: ") < reported(more.out, "m.plm: "));
    CHECK(reported(less.out, "mean ") > reported(more.out, "mean "));
    CHECK(reported(less.out, "mean ") < reported(less.out, "maximum "));
  }
}

TEST_CASE("the mean error of every triangle is within the contour threshold where the mesh converged") {
  const MeshFolder m;
  for (const char* threshold : {"1", "0.3", "0.1"}) {
    const Ran r = m.mesh({"--criterion", "contour", "--threshold", threshold});
    CHECK(contains(r.out, "within tolerance"));
    CHECK(reported(r.out, "mean ") <= std::stod(threshold));
  }
}

TEST_CASE(
    "a mesh that just needs the depth it may have is within tolerance, and one that needs more is not") {
  const MeshFolder m;
  const auto at_depth = [&m](double depth) {
    return m.mesh({"--threshold", "0.1", "--depth", std::to_string(static_cast<int>(depth))});
  };
  const Ran free = at_depth(20);
  const double deepest = reported(free.out, "deepest level ");
  const Ran enough = at_depth(deepest), short_of_one = at_depth(deepest - 1);
  CHECK(reported(enough.out, "m.plm: ") == reported(free.out, "m.plm: "));
  CHECK(contains(enough.out, "within tolerance"));
  CHECK(contains(short_of_one.out, "as deep as --depth allows"));
  CHECK(contains(m.mesh({"--criterion", "uniform", "--depth", "2"}).out, "as deep as --depth allows"));
  CHECK_FALSE(contains(m.mesh({"--criterion", "none"}).out, "within tolerance"));
}

TEST_CASE("a budget is kept, whatever the criterion, and a depth as well") {
  const MeshFolder m;
  for (const char* criterion : {"uniform", "normals", "contour"})
    for (const int budget : {50, 51, 77, 200, 333}) {
      const Ran r = m.mesh({"--criterion", criterion, "--budget", std::to_string(budget), "--depth", "14"});
      CHECK(reported(r.out, "m.plm: ") <= budget);
      CHECK(reported(r.out, "m.plm: ") >= 0.95 * budget);
    }
  for (const char* criterion : {"normals", "contour"}) {
    const Ran r = m.mesh({"--criterion", criterion, "--threshold", "0.5", "--depth", "2"});
    CHECK(reported(r.out, "deepest level ") == 2);
    CHECK(contains(r.out, "as deep as --depth allows"));
  }
  const Ran below = m.mesh({"--budget", "20"});
  CHECK(reported(below.out, "m.plm: ") == 49);
  CHECK(is_one_line(below.err));
}

TEST_CASE("parameters move the mesh, one name drives a pair, and refinement follows the shape") {
  const MeshFolder m;
  m.mesh({"--criterion", "none", "-o", m / "rest.obj"});
  m.mesh({"--criterion", "none", "-o", m / "brow.obj", "--param", "browUp=1"});
  m.mesh({"--criterion", "none", "-o", m / "jaw.obj", "--param", "jawOpen=0.5", "--param", "width=-2"});
  const Parsed rest = parse_obj(read_file(m / "rest.obj")), brow = parse_obj(read_file(m / "brow.obj")),
               jaw = parse_obj(read_file(m / "jaw.obj"));
  float left = 0, right = 0;
  for (std::size_t v = 0; v < rest.uv.size(); ++v) {
    float& side = rest.uv[v].x > 0.5f ? left : right;
    side = max(side, brow.position[v].y - rest.position[v].y);
    const Vec3 expected =
        rest.position[v] + -8 * Vec3{2 * rest.uv[v].x - 1, 0, 0} +
        0.5f * TexturedModel::bump(0.5f, 0.8f, 0.35f, {0, -16, 0})(rest.uv[v].x, rest.uv[v].y);
    CHECK(length(jaw.position[v] - expected) < 0.2f);
  }
  CHECK(left > 8);
  CHECK(right == doctest::Approx(static_cast<double>(left)).epsilon(0.05));
  check_refused({"mesh", m.path, "--param", "browUpRight=0", "--param", "browUp=1"},
                {"--param: 'browUpRight' and 'browUp' give the same parameter"});
  CHECK(m.vertices({"--threshold", "0.1", "--param", "jawOpen=1"}) > m.vertices({"--threshold", "0.1"}));
}

TEST_CASE("one command makes a picture and a table of all criteria") {
  const MeshFolder m;
  const Ran r = m.mesh({"--figure", m / "f.png", "--curve", "--param", "jawOpen=1"});
  const Image figure = read_image(m / "f.png");
  CHECK(figure.width > figure.height);
  CHECK(contains(r.out, "| criterion | setting | vertices | faces | mean mm | max mm |\n"));
  CHECK(contains(r.out, "| base mesh |  | 49 | 72 |"));
  for (const char* row :
       {"| unconditional | depth 4 |", "| normals | 45 degrees |", "| contour | 0.12 mm |", "| budget | "})
    CHECK(contains(r.out, row));
}

TEST_CASE(
    "an OBJ that is baked and written again has its u, with --mirror-u also where the chart was mirrored") {
  const Folder f;
  for (const bool is_mirrored : {false, true}) {
    std::string text;
    for (int k = 0; k < 9; ++k)
      text += "v " + std::to_string(k % 3 * 50) + " " + std::to_string(k / 3 * 50) + " 0\n";
    for (int k = 0; k < 9; ++k)
      text += "vt " + std::to_string(is_mirrored ? 1 - 0.5 * (k % 3) : 0.5 * (k % 3)) + " " +
              std::to_string(0.5 * (k / 3)) + "\n";
    for (const int a : {1, 2, 4, 5}) {
      text += "f";
      for (const int v : {a, a + 1, a + 4, a + 3}) text += " " + std::to_string(v) + "/" + std::to_string(v);
      text += "\n";
    }
    const Ran baked =
        run_words({"bake", f.put("in.obj", text), "-o", f / "m.plm", "--base-mesh", "60", "--size", "32"});
    REQUIRE(baked.code == 0);
    CHECK(contains(baked.err, "--mirror-u") == is_mirrored);
    std::vector<std::string> words{"mesh", f / "m.plm", "-o", f / "out.obj"};
    if (is_mirrored) words.push_back("--mirror-u");
    REQUIRE(run_words(words).code == 0);
    const Parsed out = parse_obj(read_file(f / "out.obj"));
    for (std::size_t v = 0; v < out.uv.size(); ++v) {
      const Vec2 place = 0.01f * Vec2{out.position[v].x, out.position[v].y};
      CHECK(magnitude(out.uv[v].x - (is_mirrored ? 1 - place.x : place.x)) < 1e-3f);
      CHECK(magnitude(out.uv[v].y - (1 - place.y)) < 1e-3f);
    }
  }
  CHECK(run_words({"mesh", f / "m.plm", "-o", f / "out.glb", "--mirror-u"}).code == 2);
  CHECK(run_words({"mesh", f / "m.plm", "--mirror-u"}).code == 2);
}

TEST_CASE("the same arguments give the same bytes") {
  const MeshFolder m;
  for (const char* name : {"a.glb", "b.glb"}) m.mesh({"--budget", "300", "-o", m / name});
  CHECK(read_file(m / "a.glb") == read_file(m / "b.glb"));
}

TEST_CASE("-o=FILE is -o FILE") {
  const MeshFolder m;
  m.mesh({"--criterion", "none", "-o=" + m / "a.obj"});
  CHECK(m.has("a.obj"));
  CHECK(run_words({"mesh", m.path, "-o="}).code == 2);
}

TEST_CASE("a path of any length is told whole") {
  const MeshFolder m;
  const std::string folder = m / std::string(200, 'a') + "/" + std::string(200, 'b');
  std::filesystem::create_directories(folder);
  const std::string model = folder + "/m.plm";
  write_file(model, read_file(m.path));
  CHECK(contains(run_words({"info", model}).out, model + ": " + std::to_string(read_file(model).size()) + " bytes, crc "));
  CHECK(contains(run_words({"mesh", model, "--criterion", "none"}).out, model + ": "));
  CHECK(contains(run_words({"mesh", model, "--criterion", "none"}).out, " faces)\nerror: "));
}

TEST_CASE("bad arguments and bad files are refused with a message that names them, and nothing is written") {
  const MeshFolder m;
  const auto refused = [&](std::vector<std::string> words, const std::string& part) {
    words.insert(words.begin(), {"mesh", m.path, "-o", m / "out.obj"});
    const Ran r = run_words(words);
    CAPTURE(r.err);
    CHECK(r.code == 2);
    CHECK(contains(r.err, part));
    CHECK_FALSE(m.has("out.obj"));
  };
  refused({"--criterion", "sharp"}, "--criterion must be none, uniform, normals or contour: sharp");
  refused({"--criterion", "none", "--budget", "100"}, "--budget does not apply");
  refused({"--criterion", "none", "--depth", "1"}, "--depth does not apply");
  refused({"--criterion", "uniform", "--threshold", "1"}, "--threshold does not apply");
  refused({"--depth", "25"}, "--depth");
  refused({"--depth", "1.5"}, "whole number");
  refused({"--threshold", "0"}, "--threshold");
  refused({"--threshold", "nan"}, "--threshold");
  refused({"--budget", "70000"}, "--budget");
  refused({"--param", "jawOpen"}, "NAME=VALUE");
  refused({"--param", "jawOpen=wide"}, "NAME=VALUE");
  refused({"--param", "jawOpen=1e300"}, "NAME=VALUE");
  refused({"--param", "jawOpen=0.1", "--param", "jawOpen=0.2"}, "--param gives jawOpen twice");
  refused({"--budget", "9", "--budget", "9"}, "--budget is given more than once");
  refused({"--figure", m / "f.png"}, "-o does not apply to --figure");
  refused({"--curve"}, "-o does not apply to --figure and --curve");
  CHECK(run_words({"mesh", m.path, "-o", m / "out.stl"}).code == 2);
  CHECK(run_words({"mesh"}).code == 2);

  check_refused({"mesh", m.path, "--param", "smirk=1"}, {"m.plm", "'smirk'"});
  check_refused({"mesh", m.path, "--param", "jawOpen=1.5"}, {"jawOpen", "limits 0 and 1"});
  check_refused({"mesh", PLIANT_BAKED_FACE, "--param", "jawOpen=0.46"}, {"jawOpen", "limits 0 and 0.45\n"});
  for (const char* name : {"jaw", "mouth"})  // whose Left and Right are directions
    check_refused({"mesh", PLIANT_BAKED_FACE, "--param", name + std::string("=0.3")}, {"has no parameter", name});
  check_refused({"mesh", m / "none.plm"}, {"none.plm"});
  check_refused({"mesh", m.put("bad.plm", "PLM1")}, {"bad.plm"});
  check_refused({"mesh", m.path, "-o", m / "no/out.obj"}, {"no/out.obj"});
}

TEST_CASE("the ending of a mesh's name may be in capitals") {
  const MeshFolder m;
  for (const auto& [name, head] : {std::pair{"m.OBJ", "# "}, {"m.Ply", "ply\n"}, {"m.GLB", "glTF"}}) {
    REQUIRE(run_words({"mesh", m.path, "-o", m / name}).code == 0);
    CHECK(read_file(m / name).substr(0, std::string(head).size()) == head);
  }
}

}  // namespace cli_mesh_test
