// `pliant animate`: what a viewer computes from the GLB is what the model says, on any person and any model.
#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <sstream>

#include "baked_face.hpp"
#include "cli_run.hpp"
#include "host/io/csv.hpp"
#include "host/io/fit_file.hpp"
#include "mesh_reader.hpp"

namespace cli_animate_test {

using namespace cli_run;
using namespace mesh_reader;

namespace {

/// An animation as a viewer reads it.
struct Animation {
  Glb glb;
  Parsed rest;
  std::vector<std::string> names;
  std::vector<std::vector<float>> targets;  // three floats a vertex
  std::vector<float> times, weights, translations, rotations;

  explicit Animation(const std::string& bytes) : glb(bytes), rest(parse_glb(bytes)) {
    const Json& mesh = glb.at("meshes", 0);
    const Json& primitive = mesh.at("primitives").at(0);
    if (primitive.contains("targets")) {
      for (const Json& name : mesh.at("extras").at("targetNames")) names.push_back(name.get<std::string>());
      for (const Json& target : primitive.at("targets")) {
        targets.push_back(glb.values<float>(Glb::number(target, "POSITION"), 5126, 3));
        CHECK(glb.values<float>(Glb::number(target, "NORMAL"), 5126, 3).size() == targets.back().size());
      }
      REQUIRE(names.size() == targets.size());
      REQUIRE(mesh.at("weights").size() == targets.size());
    }
    if (!glb.json.contains("animations")) return;
    const Json& animation = glb.at("animations", 0);
    for (const Json& channel : animation.at("channels")) {
      const Json& sampler = animation.at("samplers").at(Glb::number(channel, "sampler"));
      const std::string path = channel.at("target").at("path").get<std::string>();
      times = glb.values<float>(Glb::number(sampler, "input"), 5126, 1);
      const std::size_t output = Glb::number(sampler, "output");
      if (path == "weights") weights = glb.values<float>(output, 5126, 1);
      if (path == "translation") translations = glb.values<float>(output, 5126, 3);
      if (path == "rotation") rotations = glb.values<float>(output, 5126, 4);
    }
    CHECK(weights.size() == times.size() * targets.size());
  }
  std::size_t target(const std::string& name) const {
    for (std::size_t t = 0; t < names.size(); ++t)
      if (names[t] == name) return t;
    FAIL("no target " << name);
    return 0;
  }
  float weight(std::size_t frame, const std::string& name) const {
    return weights.at(frame * targets.size() + target(name));
  }
  /// Vertex v in a frame, in millimetres; without correctives the targets of single expressions only.
  Vec3 vertex(std::size_t frame, std::size_t v, bool with_correctives = true) const {
    Vec3 p = rest.position[v];
    for (std::size_t t = 0; t < targets.size(); ++t) {
      if (!with_correctives && names[t].find('*') != std::string::npos) continue;
      const float* d = &targets[t][3 * v];
      p = p + weights[frame * targets.size() + t] * Vec3{d[0], d[1], d[2]};
    }
    return p;
  }
  /// A point of the mesh in the scene, metres.
  Vec3 placed(std::size_t frame, Vec3 p) const {
    const float *r = &rotations[4 * frame], *t = &translations[3 * frame];
    return rotation_matrix(Quat{r[3], r[0], r[1], r[2]}) * (0.001f * p) + Vec3{t[0], t[1], t[2]};
  }
};

/// The built-in face in a folder, to run the command on.
struct FaceFolder : Folder {
  BakedModel& face = baked_face();
  std::string model;
  FaceFolder() {
    const auto* bytes = reinterpret_cast<const char*>(face.words.data());
    model = put("face.plm", std::string(bytes, face.model.table_bytes()));
  }
  std::vector<float> q(const NamedValues& values) const {
    auto out = face.rest();
    CHECK(apply(values, "test", face.model, out.data()).empty());
    return out;
  }
  /// Largest distance (mm) between the animation's vertices in a frame and the model's surface at q.
  float error(const Animation& animation, std::size_t frame, const std::vector<float>& at,
              bool with_correctives = true) {
    float worst = 0;
    for (std::size_t v = 0; v < animation.rest.position.size(); ++v)
      worst = max(worst,
                  length(animation.vertex(frame, v, with_correctives) - face.at(animation.rest.uv[v], at)));
    return worst;
  }
};

Animation animate(const std::vector<std::string>& words, const std::string& output) {
  auto all = words;
  all.insert(all.end(), {"-o", output});
  const Ran r = run_words(all);
  CAPTURE(r.err);
  REQUIRE(r.code == 0);
  return Animation(read_file(output));
}

}  // namespace

TEST_CASE("morph targets and weights give the model's surface, turning jaw included") {
  FaceFolder f;
  const std::string params =
      f.put("t.csv",
            "time_s,jawOpen,mouthSmileLeft,eyeBlinkRight,mouthPucker,faceWidth,noseLength\n"
            "0,0,0,0,0,1.5,-1\n0.5,0.45,0,1,0,1.5,-1\n1,0.225,0.7,0.5,0.3,1.5,-1\n"
            "1.25,0.4,1,0,0.2,1.5,-1\n");
  const Animation a = animate({"animate", f.model, "--params", params}, f / "a.glb");
  const NamedValues rows[] = {
      {},
      {{"jawOpen", 0.45f}, {"eyeBlinkRight", 1.0f}},
      {{"jawOpen", 0.225f}, {"mouthSmileLeft", 0.7f}, {"eyeBlinkRight", 0.5f}, {"mouthPucker", 0.3f}},
      {{"jawOpen", 0.4f}, {"mouthSmileLeft", 1.0f}, {"mouthPucker", 0.2f}}};
  CHECK(a.times == std::vector<float>{0, 0.5f, 1, 1.25f});
  float without = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    NamedValues values = rows[k];
    values.insert(values.end(), {{"faceWidth", 1.5f}, {"noseLength", -1.0f}});
    CAPTURE(k);
    CHECK(f.error(a, k, f.q(values)) < 0.15f);
    without = max(without, f.error(a, k, f.q(values), false));
  }
  CHECK(without > 1);  // the jaw is no straight line
  CHECK(a.target("jawOpen*(1-jawOpen)") >= 4);
  // The openings are closed: the only boundary is the outline.
  std::map<std::pair<int, int>, int> edges;
  for (const auto& t : a.rest.faces)
    for (std::size_t k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
  for (const auto& [edge, count] : edges) {
    CHECK(count == 1);
    if (edges.count({edge.second, edge.first}) != 0) continue;
    const Vec2 uv = a.rest.uv[static_cast<std::size_t>(edge.first)];
    CHECK(max(magnitude(uv.x - 0.5f), magnitude(uv.y - 0.5f)) > 0.3f);
  }
}

TEST_CASE("a tolerance decides about correctives, and the printed error is the true one") {
  FaceFolder f;
  const std::string params = f.put("t.csv", "frame,jawOpen\n0,0\n1,0.2\n2,0.45\n");
  const auto words = [&](const char* tolerance) {
    return std::vector<std::string>{"animate", f.model, "--params", params, "--tolerance", tolerance};
  };
  const Animation with = animate(words("0.1"), f / "a.glb"), without = animate(words("50"), f / "b.glb");
  CHECK(with.names == std::vector<std::string>{"jawOpen", "jawOpen*(1-jawOpen)"});
  CHECK(without.names == std::vector<std::string>{"jawOpen"});
  const Ran r = run_words({"animate", f.model, "--params", params, "--tolerance", "50", "-o", f / "b.glb"});
  float worst = 0;
  for (std::size_t k = 0; k < 3; ++k)
    worst = max(worst, f.error(without, k, f.q({{"jawOpen", std::vector<float>{0, 0.2f, 0.45f}[k]}})));
  CHECK(std::stof(r.out.substr(r.out.find("max ") + 4)) ==
        doctest::Approx(static_cast<double>(worst)).epsilon(0.01));
}

TEST_CASE("the head moves as the pose says, in axes with y up and z towards the viewer") {
  FaceFolder f;
  const Quat q = normalised(Quat{0.9f, 0.1f, -0.35f, 0.2f});
  std::ostringstream row;
  row << "0,1,0,0,0,0,0,600,0\n1," << q.w << "," << q.x << "," << q.y << "," << q.z << ",30,-20,700,0.5\n";
  const std::string params = f.put("t.csv", "frame,qw,qx,qy,qz,tx,ty,tz,browInnerUpLeft\n" + row.str());
  const Animation a = animate({"animate", f.model, "--params", params, "--rate", "25"}, f / "a.glb");
  CHECK(a.times == std::vector<float>{0, 0.04f});
  const Projector projector(view_of({q, {30, -20, 700}}, Camera{500, 0, 0}), true);
  for (const Vec3 p : {Vec3{0, 0, 0}, Vec3{60, 10, -20}, Vec3{-30, -70, 15}}) {
    const Vec3 camera = projector.to_camera(p), scene = a.placed(1, p);
    CHECK(length(scene - 0.001f * Vec3{camera.x, -camera.y, -camera.z}) < 1e-5f);
  }
  const Json& node = a.glb.at("nodes", 0);
  CHECK(node.at("translation").at(2).get<double>() == doctest::Approx(-0.6));
  CHECK(node.at("scale").at(0).get<double>() == doctest::Approx(0.001));
}

TEST_CASE("columns of the pose that are missing are frontal, 1 m from the camera") {
  const Folder f;
  const std::string model = f.put("m.plm", model_bytes());
  const auto moving = [&](const std::string& table) {
    return animate({"animate", model, "--params", f.put("t.csv", table)}, f / "a.glb");
  };
  const Animation turned = moving("frame,qw,qx,qy,qz\n0,1,0,0,0\n1,0.8,0.6,0,0\n");
  REQUIRE(turned.rotations.size() == 8);
  CHECK(turned.rotations[4] == doctest::Approx(0.6));
  REQUIRE(turned.translations.size() == 6);
  CHECK(turned.translations[5] == doctest::Approx(-1));
  const Animation shifted = moving("frame,qw,qx,qy,qz,tx,tz\n0,1,0,0,0,0,600\n1,1,0,0,0,50,600\n");
  REQUIRE(shifted.translations.size() == 6);
  CHECK(shifted.translations[3] == doctest::Approx(0.05));
  CHECK(shifted.translations[4] == 0);
  CHECK(moving("frame,jawOpen\n0,0\n1,1\n").rotations.empty());
}

TEST_CASE("one name drives a pair, a pair drives one, and names without effect are listed") {
  const Folder f;
  const std::string model = f.put("m.plm", model_bytes());
  const std::string params = f.put(
      "t.csv",
      "frame,state,browUp,jawOpenLeft,jawOpenRight,tongueOut,x_nose,y_nose\n0,tracking,0.5,0.2,0.6,1,3,4\n");
  const std::vector<std::string> words{"animate", model, "--params", params};
  const Animation a = animate(words, f / "a.glb");
  CHECK(a.names == std::vector<std::string>{"browUpLeft", "browUpRight", "jawOpen"});
  CHECK(a.weights[0] == doctest::Approx(0.5));
  CHECK(a.weights[1] == doctest::Approx(0.5));
  CHECK(a.weights[2] == doctest::Approx(0.4));
  const Ran r = run_words({"animate", model, "--params", params, "-o", f / "a.glb"});
  CHECK(r.err == params + ": the model has no parameter tongueOut\n");
}

TEST_CASE(
    "a lost frame repeats the frame before it; lost frames at the beginning repeat the first tracked one") {
  const Folder f;
  const std::string model = f.put("m.plm", model_bytes());
  const std::string head = "frame,time_s,state,qw,qx,qy,qz,tx,ty,tz,jawOpen\n";
  const std::string params = f.put("t.csv", head +
                                                "0,0,lost,,,,,,,,\n1,0.1,tracking,1,0,0,0,0,0,500,0.5\n"
                                                "2,0.2,lost,,,,,,,,\n3,0.3,degraded,1,0,0,0,0,0,520,1\n");
  const Animation a = animate({"animate", model, "--params", params}, f / "a.glb");
  for (std::size_t k : {std::size_t{0}, std::size_t{1}, std::size_t{2}}) {
    CHECK(a.weight(k, "jawOpen") == doctest::Approx(0.5));
    CHECK(a.translations[3 * k + 2] == doctest::Approx(-0.5));
  }
  CHECK(a.weight(3, "jawOpen") == doctest::Approx(1));
  const Ran r = run_words({"animate", model, "--params", params, "-o", f / "a.glb"});
  CHECK(contains(r.err, "2 of 4 frames are lost"));
  CHECK(run_words({"animate", model, "--params", params, "-o", f / "A.GLB"}).code == 0);
  const std::string gaps = f.put("g.csv", "time_s,jawOpen,browUpLeft\n0,0.5,\n1,,1\n");
  const Animation b = animate({"animate", model, "--params", gaps}, f / "g.glb");
  for (std::size_t k : {std::size_t{0}, std::size_t{1}}) CHECK(b.weight(k, "jawOpen") == doctest::Approx(0.5));
  CHECK(b.weight(0, "browUpLeft") == 0);
  check_refused(
      {"animate", model, "--params", f.put("l.csv", head + "0,0,lost,,,,,,,,\n"), "-o", f / "l.glb"},
      {"l.csv", "no row with a pose or expression"});
  check_refused({"animate", model, "--params", f.put("n.csv", "frame,tongueOut\n0,1\n"), "-o", f / "n.glb"},
                {"n.csv", "it does not have tongueOut"});
}

TEST_CASE("times of a clock, far from 0, keep their milliseconds") {
  const Folder f;
  const std::string model = f.put("m.plm", model_bytes());
  const std::string params =
      f.put("t.csv", "frame,time_s,jawOpen\n0,1700000000,0\n1,1700000000.033,0.5\n2,1700000000.067,1\n");
  const Animation a = animate({"animate", model, "--params", params}, f / "a.glb");
  REQUIRE(a.times.size() == 3);
  CHECK(a.times[0] == 0);
  CHECK(a.times[1] == doctest::Approx(0.033).epsilon(1e-4));
  CHECK(a.times[2] == doctest::Approx(0.067).epsilon(1e-4));
}

TEST_CASE("a track plays on another person and another model at the same fraction of each range") {
  FaceFolder f;
  const std::string small = f.put("small.plm", model_bytes());
  const std::string params = f.put("t.csv", "frame,faceWidth,jawOpen,mouthSmileLeft\n0,2,0,0\n1,2,0.225,1\n");
  const std::string fit = f / "fit.json";
  REQUIRE(run_words({"fit", f.model, "--box", "100,60,120,140", "--box-of", "landmarks", "--size", "320x240",
                     "-o", fit})
              .code == 0);
  std::string text = read_file(fit);
  const std::size_t at = text.find("\"faceWidth\": 0.0");
  REQUIRE(at != std::string::npos);
  f.put("fit.json", text.replace(at, 16, "\"faceWidth\": -2.5"));

  const Animation own = animate({"animate", f.model, "--params", params}, f / "own.glb");
  CHECK(f.error(own, 1, f.q({{"faceWidth", 2.0f}, {"jawOpen", 0.225f}, {"mouthSmileLeft", 1.0f}})) < 0.15f);
  const Animation other =
      animate({"animate", f.model, "--params", params, "--identity", fit}, f / "other.glb");
  CHECK(f.error(other, 1, f.q({{"faceWidth", -2.5f}, {"jawOpen", 0.225f}, {"mouthSmileLeft", 1.0f}})) <
        0.15f);

  check_refused({"animate", small, "--params", params, "--identity", fit, "-o", f / "x.glb"},
                {"fit.json", "was fitted with another model than " + small});
  CHECK_FALSE(f.has("x.glb"));

  // jawOpen ends at 0.45 in the built-in face and at 1 in the small model.
  const Animation plain = animate({"animate", small, "--params", params}, f / "s.glb");
  CHECK(plain.weight(1, "jawOpen") == doctest::Approx(0.225));
  const Animation scaled = animate({"animate", small, "--params", params, "--from", f.model}, f / "s.glb");
  CHECK(scaled.weight(1, "jawOpen") == doctest::Approx(0.5));
  const Ran from_small =
      run_words({"animate", f.model, "--params", params, "--from", small, "-o", f / "x.glb"});
  CHECK(from_small.code == 0);
  CHECK(contains(from_small.err, "t.csv: " + small +
                                     " has no parameter of these names, their values are taken as they "
                                     "are: mouthSmileLeft\n"));
  const std::string wide = f.put("w.csv", "frame,jawOpen\n0,0\n1,0.9\n");
  const Ran r = run_words({"animate", f.model, "--params", wide, "-o", f / "w.glb"});
  CHECK(r.code == 0);
  CHECK(contains(r.err, "clamped: jawOpen"));
  CHECK(Animation(read_file(f / "w.glb")).weight(1, "jawOpen") == doctest::Approx(1));
}

TEST_CASE("with a folder as output each frame is an OBJ of the model's surface") {
  FaceFolder f;
  const std::string params = f.put("t.csv", "frame,jawOpen\n0,0\n1,0.1\n2,0.45\n");
  REQUIRE(run_words({"animate", f.model, "--params", params, "--vertices", "700", "-o", f / "objs/"}).code ==
          0);
  CHECK(std::distance(fs::directory_iterator(f.path / "objs"), fs::directory_iterator{}) == 3);
  const Parsed first = parse_obj(read_file(f / "objs/frame_00000.obj")),
               last = parse_obj(read_file(f / "objs/frame_00002.obj"));
  CHECK(first.faces == last.faces);
  CHECK(first.position.size() >= 700);
  for (std::size_t v = 0; v < last.position.size(); v += 7)
    CHECK(length(last.position[v] - f.face.at(last.uv[v], f.q({{"jawOpen", 0.45f}}))) < 2e-3f);
}

TEST_CASE("a folder with frames that would stay beside the new ones is refused; others are replaced") {
  const Folder f;
  const std::string model = f.put("m.plm", model_bytes());
  const std::string three = f.put("t.csv", "frame,jawOpen\n0,0\n1,0.1\n2,0.2\n"),
                    two = f.put("s.csv", "frame,jawOpen\n0,0.3\n1,0.1\n");
  const auto words = [&](const std::string& params) {
    return std::vector<std::string>{"animate", model, "--params", params, "-o", f / "objs/"};
  };
  REQUIRE(run_words(words(three)).code == 0);
  const std::string first = read_file(f / "objs/frame_00000.obj");
  check_refused(words(two), {"objs", "frame_00002.obj"});
  CHECK((read_file(f / "objs/frame_00000.obj") == first));
  fs::remove(f / "objs/frame_00002.obj");
  for (const char* other : {"objs/frame_notes.obj", "objs/frame_.obj", "objs/frame.txt", "objs/a.b"})
    f.put(other, "of someone else");
  REQUIRE(run_words(words(two)).code == 0);
  CHECK((read_file(f / "objs/frame_00000.obj") != first));
  CHECK(f.has("objs/frame_notes.obj"));
}

TEST_CASE("animate refuses bad words with 2 and bad input with 1 and a line that names it") {
  const Folder f;
  const std::string model = f.put("m.plm", model_bytes());
  const std::string params = f.put("t.csv", "frame,time_s,jawOpen\n0,0,0\n1,0,1\n");
  CHECK(run_words({"animate", model, "--params", params}).code == 2);
  CHECK(run_words({"animate", model, "-o", f / "a.glb"}).code == 2);
  CHECK(run_words({"animate", model, "--params", params, "-o", f / "a.fbx"}).code == 2);
  CHECK(run_words({"animate", model, "--params", params, "-o", f / "a.glb", "--tolerance", "-1"}).code == 2);
  CHECK(run_words({"animate", "--params", params, "-o", f / "a.glb"}).code == 2);
  const std::vector<std::string> words{"animate", model, "-o", f / "a.glb", "--params"};
  const auto with = [&](const std::string& file, const std::vector<std::string>& more = {}) {
    auto all = words;
    all.push_back(file);
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  check_refused(with(params), {"t.csv: line 3", "time_s"});
  check_refused(with(f / "none.csv"), {"none.csv", "No such file"});
  check_refused(with(f.put("nan.csv", "frame,jawOpen\n0,nan\n")), {"nan.csv: line 2", "jawOpen"});
  check_refused(with(f.put("e.csv", "frame,jawOpen\n")), {"e.csv", "no row"});
  const std::string good = f.put("g.csv", "frame,jawOpen\n0,1\n");
  check_refused(with(good, {"--identity", f.put("bad.json", "{}")}), {"bad.json"});
  check_refused(with(good, {"--from", good}), {"g.csv"});
  CHECK_FALSE(f.has("a.glb"));
  CHECK(run_words(with(good)).code == 0);
}

}  // namespace cli_animate_test
