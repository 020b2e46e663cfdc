// The pliant command: what info, fit, render and bake write, and what they say about bad input.
#include <doctest/doctest.h>
#include <unistd.h>

#include <sstream>

#include "cli_run.hpp"
#include "host/io/csv.hpp"
#include "host/io/fit_file.hpp"
#include "host/io/image.hpp"

namespace cli_test {

using namespace pliant;
using namespace pliant::host;
using namespace cli_run;

TEST_CASE("bad usage exits with 2 and names the wrong argument") {
  const struct {
    std::vector<std::string> words;
    const char* part;
  } cases[] = {
      {{}, "usage"},
      {{"dance"}, "no such command: dance"},
      {{"plan", "--mhz", "-1"}, "--mhz: not a number from 0.001 to 1000000: -1"},
      {{"plan", "m.plm", "b"}, "argument was not expected: b"},
      {{"info"}, "an operand is missing"},
      {{"info", "a", "b"}, "argument was not expected: b"},
      {{"fit", "m.plm", "--points", "p.csv"}, "-o is missing"},
      {{"fit", "m.plm", "-o", "f.json"}, "one of --points, --box, --pose and --image"},
      {{"fit", "m.plm", "-o", "f.json", "--box", "1,2,3"}, "--box needs 4 numbers"},
      {{"fit", "m.plm", "-o", "f.json", "--box", "1,2,3,x"}, "--box: not numbers"},
      {{"fit", "m.plm", "-o", "f.json", "--size", "big", "--box", "1,2,3,4"}, ""},
      {{"track", "m.plm", "--frames"}, "--frames lacks its value SOURCE\n"},
      {{"track", "m.plm", "--frames", "a", "--frames", "b"}, "--frames is given more than once"},
      {{"track", "m.plm", "--report"}, "--report lacks its value HTML\n"},
      {{"track", "m.plm", "--wings", "2"}, "argument was not expected: --wings\n"},
      {{"track", "m.plm", "--show=yes"}, "--show"},
      {{"render", "m.plm", "--landmarks"}, "argument was not expected: --landmarks"},
      {{"render", "m.plm", "-o", "a", "--noise", "loud"}, "--noise: not a number from 0 to 128: loud"},
      {{"render", "m.plm", "-o", "a", "--size", "320"},
       "--size: not a size like 320x240, 16 to 16384 pixels a side: 320"},
      {{"bake", "x", "-o", "y", "--pca", "0"}, "--pca: not a number from 1 to 192: 0"},
      {{"bake", "x", "-o", "y", "--bits", "12"}, "--bits must be 8 or 16"},
      {{"mesh", "m.plm", "-o", ""}, "-o has an empty name"},
      {{"detect", "m.plm", "--image", ""}, "--image has an empty name"},
      {{"detect", "m.plm", "--image", "a", "-o=", "--landmarks"}, "-o has an empty name"},
      {{"track", "m.plm", "--frames=", "--out", "t"}, "--frames has an empty name"},
      {{"track", "m.plm", "--frames", "--out=t"}, "--frames lacks its value: --out=t is another"},
  };
  for (const auto& c : cases) {
    const Ran r = run_words(c.words);
    CAPTURE(r.err);
    CAPTURE(c.part);
    if (*c.part != '\0') CHECK(r.code == 2);
    CHECK(r.out.empty());
    CHECK(r.code != 0);
    CHECK(contains(r.err, c.part));
  }
  const Folder folder;
  const std::string model = folder.put("m.plm", model_bytes());
  const std::string video =
      folder.put("v.y4m", "YUV4MPEG2 W32 H32 F25:1 Cmono\nFRAME\n" + std::string(1024, 'x'));
  CHECK(
      run_words({"track", model, "--frames", video, "--init", "f", "--out", folder / "t", "--freeze", "hair"})
          .code == 2);
  CHECK(folder.file_count() == 2);
}

TEST_CASE("an option that has nothing to act on is refused, and named") {
  const Folder folder;
  const std::string sheet = PLIANT_FIXTURES "/sheet", model = folder.put("m.plm", model_bytes());
  const std::string timed = folder.put("t.csv", "frame,time_s,jawOpen\n0,0,0\n1,1,0.1\n");
  const std::vector<std::vector<std::string>> cases{
      {"--stiffness", "bake", sheet, "-o", folder / "x.plm", "--stiffness", "2"},
      {"--flash", "bake", sheet, "-o", folder / "x.plm", "--flash", "100"},
      {"-o", "bake", sheet, "-o", folder / "x.plm", "--sizes", "16"},
      {"--bits", "bake", sheet, "--bits", "8", "--sizes", "16"},
      {"--delta", "fit", model, "--points", "p.csv", "--size", "20x20", "-o", folder / "x.json", "--delta",
       "1"},
      {"--delta", "fit", model, "--points", "p.csv", "--size", "20x20", "-o", folder / "x.json", "--delta",
       "1", "--method", "preconditioned"},
      {"--steps", "fit", model, "--points", "p.csv", "--size", "20x20", "-o", folder / "x.json", "--steps",
       "9"},
      {"--stiffness", "fit", model, "--box", "1,1,9,9", "--size", "20x20", "-o", folder / "x.json",
       "--stiffness", "1"},
      {"--silhouette", "fit", model, "--box", "1,1,9,9", "--size", "20x20", "-o", folder / "x.json",
       "--silhouette", "fixed"},
      {"--box-of", "fit", model, "--points", "p.csv", "--size", "20x20", "-o", folder / "x.json", "--box-of",
       "opencv"},
      {"--tolerance", "animate", model, "--params", timed, "-o", folder / "objs/", "--tolerance", "1"},
      {"--image", "animate", model, "--params", timed, "-o", folder / "x.glb", "--image", "p.png"},
      {"--texture", "fit", model, "--points", "p.csv", "--size", "20x20", "-o", folder / "x.json",
       "--texture", folder / "x.glb"},
      {"--people", "render", model, "--params", timed, "-o", folder / "x.y4m", "--people", timed},
      {"--rate", "animate", model, "--params", timed, "-o", folder / "x.glb", "--rate", "25"},
      {"--drawn", "learn", model, "--faces", "none", "--others", sheet, "--drawn", sheet, "--only", "parts", "-o",
       folder / "x.bin"},
      {"--pairs", "bench", "mcd", "--pairs", sheet},
      {"--count", "bench", "klt", "--pairs", sheet, "--count", "9"},
      {"--count", "bench", "detection", "--model", model, "--film", timed, "--truth", timed, "--count", "9"},
      {"--model", "bench", "fit", "--model", model}};
  const std::size_t files = folder.file_count();
  for (const std::vector<std::string>& c : cases) {
    const Ran r = run_words({c.begin() + 1, c.end()});
    CAPTURE(r.err);
    CHECK(r.code == 2);
    CHECK(contains(r.err, ": " + c[0] + " "));
  }
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"--pca", "3"}, {"--unit", "10"}, {"--relax-chart"}}) {
    std::vector<std::string> all{"bake", PLIANT_FIXTURES "/face", "-o", folder / "x.plm"};
    all.insert(all.end(), words.begin(), words.end());
    check_refused(all, {words[0], "needs an OBJ file"});
  }
  CHECK(folder.file_count() == files);
}

TEST_CASE("help lists every command, and help of a command every option") {
  const Ran all = run_words({"--help"});
  CHECK(all.code == 0);
  for (const char* name : {"bake", "info", "mesh", "points", "fit", "track", "animate", "render", "bench"})
    CHECK(contains(all.out, std::string("pliant ") + name));
  const Ran one = run_words({"track", "--help"});
  CHECK(one.code == 0);
  for (const char* name : {"--markers", "--marker-exclusion-px", "--sheet", "--mirror"})
    CHECK(contains(one.out, name));
}

TEST_CASE("a model truncated or damaged anywhere gives one line of error") {
  const Folder folder;
  const std::string whole = model_bytes();
  check_refused({"info", folder / "none.plm"}, {"none.plm", "No such file"});
  check_refused({"info", folder.path.string()}, {"is a directory"});
  for (std::size_t k = 0; k < 40; ++k) {
    const std::size_t length = k < 24 ? k : whole.size() * (k - 23) / 17;
    check_refused({"info", folder.put("cut.plm", whole.substr(0, length))}, {"cut.plm: "});
  }
  for (std::size_t at = 0; at < whole.size(); at += at < 260 ? 1 : 977) {
    std::string flipped = whole;
    flipped[at] = static_cast<char>(flipped[at] ^ (1 << at % 8));
    const Ran r = run_words({"info", folder.put("flip.plm", flipped)});
    CAPTURE(at);
    CHECK(r.code == 1);
    CHECK(is_one_line(r.err));
    CHECK(contains(r.err, "flip.plm: "));
  }
  CHECK(run_words({"info", folder.put("whole.plm", whole)}).code == 0);
}

TEST_CASE("output that cannot be written is a failure, as on a full disk") {
  struct Full : std::streambuf {
    int overflow(int) override { return traits_type::eof(); }
  } full;
  const Folder folder;
  const std::string model = folder.put("m.plm", model_bytes());
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"info", model}, {"plan"}, {"--help"}, {"help"}, {"--version"}, {"info", "--help"}}) {
    std::ostream out(&full);
    std::ostringstream err;
    Console console{out, err};
    CHECK(run(words, console) == 1);
    CHECK(err.str() == "pliant: standard output: writing failed\n");
  }
}

TEST_CASE("info tells sizes, parameters, fields, landmarks and memory") {
  const Folder folder;
  const Ran r = run_words({"info", folder.put("m.plm", model_bytes())});
  CHECK(r.code == 0);
  for (const char* part :
       {"identity parameters: 1", "expression parameters: 3", "jawOpen", "fields: 5", "cascade: 5 records",
        "base mesh: 49 vertices, 72 faces", "landmarks: 15", "nose_tip", "tracker, 320 x 240"}) {
    CAPTURE(part);
    CHECK(contains(r.out, part));
  }
}

TEST_CASE("a points file with a fault gives one line that names the line, column or landmark") {
  const Folder folder;
  const std::string model = folder.put("m.plm", model_bytes());
  const std::string head = "landmark,x,y\n", good = "ibug00,10,10\nibug01,60,10\nibug02,10,60\n";
  const struct {
    std::string text;
    std::vector<std::string> parts;
  } cases[] = {
      {"", {"p.csv", "empty"}},
      {"x,y\n1,2\n", {"p.csv", "'landmark'"}},
      {head, {"p.csv", "too few points: 0"}},
      {head + good, {"p.csv", "too few points: 3"}},
      {head + good + "ibug77,1,2\n", {"p.csv: line 5", "ibug77", "m.plm"}},
      {head + good + "ibug03,nan,2\n", {"p.csv: line 5", "'x'", "nan"}},
      {head + good + "ibug03,1,inf\n", {"p.csv: line 5", "'y'", "inf"}},
      {head + good + "ibug03,1,1e39\n", {"p.csv: line 5", "'y'"}},
      {head + good + "ibug03,1,-2e6\n", {"p.csv: line 5", "million"}},
      {head + good + "ibug03,1,2px\n", {"p.csv: line 5", "'y'", "2px"}},
      {head + good + "ibug03,,2\n", {"p.csv: line 5", "'x'"}},
      {head + good + "ibug03,1\n", {"p.csv: line 5", "2 cells"}},
      {head + good + "ibug01,1,2\n", {"p.csv: line 5", "ibug01", "twice"}},
      {head + good + ",1,2\n", {"p.csv: line 5", "has no name"}},
      {"landmark,x,x\na,1,2\n", {"p.csv", "two columns"}},
      {head + "ibug00,5,5\nibug01,5,5\nibug02,5,5\nibug03,5,5\n", {"p.csv", "determine"}},
      {"landmark,x,y,u,v\na,1,2,0.5,\n", {"p.csv: line 2", "only one of u and v"}},
      {"landmark,x,y,u,v\na,1,2,0.5,1.5\n", {"p.csv: line 2", "between 0 and 1"}},
      {"landmark,x,y,u,v\na,1,2,0.5,nan\n", {"p.csv: line 2", "'v'"}},
      {std::string(300, '\0'), {"p.csv"}},
  };
  for (const auto& c : cases) {
    CAPTURE(c.text);
    folder.put("p.csv", c.text);
    check_refused({"fit", model, "--points", folder / "p.csv", "--size", "100x100", "-o", folder / "f.json"},
                  c.parts);
    CHECK_FALSE(folder.has("f.json"));
    CHECK(folder.file_count() == 2);
  }
}

namespace {

FitFile fit_of(const Sequence& s, const std::vector<std::string>& more) {
  std::vector<std::string> words{"fit", s.model, "-o", s / "fit.json"};
  words.insert(words.end(), more.begin(), more.end());
  const Ran r = run_words(words);
  CAPTURE(r.err);
  REQUIRE(r.code == 0);
  return parse_fit("fit.json", read_file(s / "fit.json"));
}

FitFile fit_to_all(const Sequence& s) {
  return fit_of(s, {"--points", s.points, "--size", "200x160", "--focal", "330", "--overlay", s / "o.png"});
}

}  // namespace

TEST_CASE("fit finds the pose and shape that were drawn, from all points and from five") {
  const Sequence s;
  const FitFile all = fit_to_all(s);
  CHECK(length(log_rotation(all.pose.q)) < 0.02f);
  CHECK(all.pose.t.z == doctest::Approx(420).epsilon(0.02));
  CHECK(all.camera.f == doctest::Approx(330));
  CHECK(all.inliers == 15);
  CHECK(all.rms_px < 0.2f);
  CHECK(all.parameters[0].first == "width");
  CHECK(all.parameters[0].second == doctest::Approx(0.8).epsilon(0.15));
  CHECK(read_image(s / "o.png").width == 400);

  std::string five = "landmark,x,y\n";
  std::istringstream in(s.first_points());
  std::string line;
  while (std::getline(in, line))
    for (const char* name : {"eye_", "nose_", "mouth_"})
      if (line.rfind(name, 0) == 0) five += line + "\n";
  const FitFile few = fit_of(s, {"--points", s.put("five.csv", five), "--size", "200x160", "--focal", "330",
                                 "--parameters", "none"});
  CHECK(few.points.size() == 5);
  CHECK(few.parameters[0].second == 0);
}

TEST_CASE("fit finds the same from points by (u,v) and under other names, but for one") {
  const Sequence s;
  const FitFile all = fit_to_all(s);
  const ModelFile model(s.model);
  std::string by_uv = "landmark,x,y,u,v\n", line;
  std::istringstream rows(s.first_points());
  std::getline(rows, line);
  for (int n = 0; std::getline(rows, line); ++n) {
    const std::string name = line.substr(0, line.find(','));
    const Landmark& l = model.model().landmarks()[model.model().find_landmark(name.c_str())];
    by_uv += n == 0 ? line + ",,\n"
                    : "p" + std::to_string(n) + line.substr(line.find(',')) + "," + std::to_string(l.u) +
                          "," + std::to_string(l.v) + "\n";
  }
  const FitFile same = fit_of(s, {"--points", s.put("uv.csv", by_uv), "--size", "200x160", "--focal", "330"});
  CHECK(same.points[1].landmark == "p1");
  CHECK(same.pose.t.z == doctest::Approx(static_cast<double>(all.pose.t.z)).epsilon(1e-4));
  CHECK(same.rms_px == doctest::Approx(static_cast<double>(all.rms_px)).epsilon(0.01));
}

TEST_CASE("fit starts from a box and from the pose of another fit") {
  const Sequence s;
  const FitFile boxed = fit_of(s, {"--box", "50,40,100,80", "--box-of", "landmarks", "--size", "200x160"});
  CHECK(boxed.points.empty());
  CHECK(boxed.unseen.size() == 4);
  CHECK(boxed.camera.f == doctest::Approx(1.4 * 200));

  s.put("start.json", read_file(s / "fit.json"));
  const FitFile again = fit_of(s, {"--pose", s / "start.json"});
  CHECK(again.pose.t.z == doctest::Approx(static_cast<double>(boxed.pose.t.z)));
  const FitFile from_pose = fit_of(s, {"--pose", s / "start.json", "--points", s.points, "--focal", "330"});
  CHECK(length(log_rotation(from_pose.pose.q)) < 0.02f);
  CHECK(from_pose.rms_px < 0.2f);
}

TEST_CASE("fit refuses a size that is not that of the pose or the picture, and what is no picture") {
  const Sequence s;
  (void)fit_to_all(s);
  check_refused({"fit", s.model, "--pose", s / "fit.json", "--size", "320x240", "-o", s / "x.json"},
                {"fit.json", "200x160"});
  check_refused(
      {"fit", s.model, "--points", s.points, "--image", s / "o.png", "--size", "320x240", "-o", s / "x.json"},
      {"o.png", "400x320"});
  check_refused({"fit", s.model, "--points", s.points, "--image", s.points, "-o", s / "x.json"},
                {"p.csv", "not a picture"});
  CHECK_FALSE(s.has("x.json"));
}

TEST_CASE("fit without a size, with a box outside of it or with unknown parameters is bad usage") {
  const Sequence s;
  CHECK(run_words({"fit", s.model, "--points", s.points, "-o", s / "x.json"}).code == 2);
  for (const char* box : {"1e30,0,50,50", "0,161,50,50", "-90,0,50,50"})
    CHECK(run_words({"fit", s.model, "--box", box, "--size", "200x160", "-o", s / "x.json"}).code == 2);
  for (const char* parameters : {"1.5", "nose"})
    CHECK(run_words({"fit", s.model, "--points", s.points, "--size", "200x160", "--parameters", parameters,
                     "-o", s / "x.json"})
              .code == 2);
  CHECK_FALSE(s.has("x.json"));
}

TEST_CASE("fit --pose refuses a fit of another model, by name") {
  const Sequence s;
  REQUIRE(run_words({"fit", s.model, "--points", s.points, "--size", "200x160", "-o", s / "a.json"}).code ==
          0);
  std::string text = read_file(s / "a.json");
  const std::size_t crc = text.find("\"model_crc\": ") + 13;
  text.replace(crc, text.find(',', crc) - crc, "7");
  check_refused({"fit", s.model, "--pose", s.put("b.json", text), "-o", s / "x.json"},
                {"b.json", "another model than", "m.plm"});
  check_refused({"fit", s.model, "--pose", s / "b.json", "--points", s.points, "-o", s / "x.json"},
                {"b.json"});
  CHECK_FALSE(s.has("x.json"));
}

TEST_CASE("fit --pose keeps the lens of the earlier fit, as it is and where it fits to points") {
  const Sequence s;
  const std::string camera = s.put("c.yml",
                                   "image_width: 200\nimage_height: 160\ncamera_matrix:\n  rows: 3\n  cols: 3\n"
                                   "  data: [330, 0, 99.5, 0, 320, 79.5, 0, 0, 1]\n"
                                   "distortion_coefficients:\n  rows: 1\n  cols: 4\n  data: [-0.2, 0.04, 0, 0]\n");
  REQUIRE(run_words({"fit", s.model, "--points", s.points, "--size", "200x160", "--calibration", camera, "-o", s / "a.json"})
              .code == 0);
  const auto camera_of = [&](const std::string& name) { return parse_fit(name, read_file(s / name)).camera; };
  const Camera before = camera_of("a.json");
  CHECK(before.k1 == -0.2f);
  for (const bool has_points : {false, true}) {
    std::vector<std::string> words{"fit", s.model, "--pose", s / "a.json", "-o", s / "b.json"};
    if (has_points) words.insert(words.end(), {"--points", s.points});
    REQUIRE(run_words(words).code == 0);
    const Camera after = camera_of("b.json");
    CHECK(after.f == before.f);
    CHECK(after.aspect == before.aspect);
    CHECK(after.k1 == before.k1);
    CHECK(after.k2 == before.k2);
  }
  REQUIRE(run_words({"fit", s.model, "--pose", s / "a.json", "--focal", "400", "-o", s / "b.json"}).code == 0);
  CHECK(camera_of("b.json").f == 400);
  CHECK(camera_of("b.json").k1 == before.k1);
}

TEST_CASE("a count of parameters frees the first ones of the table, a group name those of the group") {
  const Sequence s;
  const auto sd_of = [&](const std::string& choice) {
    REQUIRE(run_words({"fit", s.model, "--points", s.points, "--size", "200x160", "--parameters", choice,
                       "-o", s / "f.json"})
                .code == 0);
    std::string frozen;
    for (const auto& [name, sd] : parse_fit("f", read_file(s / "f.json")).sd) frozen += sd == 0 ? '0' : '1';
    return frozen;
  };
  CHECK(sd_of("all") == "1111");
  const std::string all = read_file(s / "f.json");
  for (const char* count : {"4", "5"}) {
    CHECK(sd_of(count) == "1111");
    CHECK(read_file(s / "f.json") == all);  // in stages, as the fit of all is
  }
  CHECK(sd_of("none") == "0000");
  CHECK(sd_of("2") == "1100");
  CHECK(sd_of("identity") == "1000");
  CHECK(sd_of("expression") == "0111");
}

TEST_CASE("fit tells of points whose v counts upwards, and of dynamics that have not converged") {
  const Folder folder;
  const std::string table = folder / "m.plm";
  REQUIRE(
      run_words({"bake", PLIANT_FIXTURES "/sheet", "-o", table, "--size", "32", "--texture", "none"}).code ==
      0);
  const auto fit = [&](bool is_upside_down, const std::vector<std::string>& more) {
    std::string points = "landmark,x,y,u,v\n";
    for (int k = 0; k < 9; ++k) {
      const int i = k % 3, j = k / 3;
      points += "p" + std::to_string(k) + "," + std::to_string(90 + 60 * i) + "," +
                std::to_string(60 + 55 * j) + "," + std::to_string(0.1 + 0.4 * i) + "," +
                std::to_string(is_upside_down ? 0.9 - 0.4 * j : 0.1 + 0.4 * j) + "\n";
    }
    std::vector<std::string> words{"fit",      table,
                                   "--size",   "320x240",
                                   "--points", folder.put("p.csv", points),
                                   "-o",       folder / "fit.json"};
    words.insert(words.end(), more.begin(), more.end());
    const Ran r = run_words(words);
    return r;
  };
  CHECK(fit(false, {}).code == 0);
  CHECK(fit(false, {}).err == "");
  CHECK(contains(fit(true, {}).err, "shows its back"));
  fs::remove(folder / "fit.json");
  const Ran early = fit(false, {"--method", "euler", "--steps", "1", "--delta", "1e-9"});
  CHECK(early.code == 1);
  CHECK(is_one_line(early.err));
  CHECK(contains(early.err, "p.csv: the dynamics have not converged"));
  int pipe[2];  // which can be read once
  REQUIRE(::pipe(pipe) == 0);
  const std::string points = read_file(folder / "p.csv"), name = "/dev/fd/" + std::to_string(pipe[0]);
  REQUIRE(::write(pipe[1], points.data(), points.size()) == static_cast<ssize_t>(points.size()));
  ::close(pipe[1]);
  const Ran piped = run_words({"fit", table, "--size", "320x240", "--points", name, "--method", "euler",
                               "--steps", "1", "--delta", "1e-9", "-o", folder / "fit.json"});
  ::close(pipe[0]);
  CHECK(contains(piped.err, name + ": the dynamics have not converged"));
  const Ran small = run_words(
      {"fit", table, "--size", "80x50", "--points", folder / "p.csv", "-o", folder / "fit.json"});
  CHECK(small.code == 0);
  CHECK(contains(small.err, "9 of 9 points lie outside of 80x50 pixels"));
  CHECK(folder.has("fit.json"));
}

TEST_CASE("render writes the truth as a track, and a track can be rendered again") {
  const Sequence s;
  const CsvTable truth(s.truth, read_file(s.truth));
  CHECK(truth.row_count() == 12);
  CHECK(truth.columns()[2] == "state");
  CHECK(truth.find_column("x_nose_tip").has_value());
  CHECK(truth.number(11, truth.column("time_s")) == doctest::Approx(11.0 / 30));
  const CsvTable points(s / "tp.csv", read_file(s / "tp.csv"));
  CHECK(points.row_count() == 12 * 15);
  CHECK(points.columns() == std::vector<std::string>{"frame", "landmark", "x", "y"});

  const auto render = [&](const std::string& params, const std::string& out) {
    return run_words({"render", s.model, "--params", params, "-o", s / out, "--size", "200x160", "--focal",
                      "330", "--truth", s / "again.csv"});
  };
  CHECK(render(s.truth, "v2.y4m").err == "");
  CHECK((read_file(s / "v2.y4m") == read_file(s.video)));
  CHECK((read_file(s / "again.csv") == read_file(s.truth)));

  // One name for a pair drives both; a name that fits nothing is listed.
  const Ran pair = render(s.put("pair.csv", "browUp,tailWag\n0.5,1\n"), "v3.y4m");
  CHECK(pair.code == 0);
  CHECK(contains(pair.err, "tailWag"));
  const CsvTable again(s / "again.csv", read_file(s / "again.csv"));
  CHECK(again.number(0, again.column("browUpLeft")) == 0.5f);
  CHECK(again.number(0, again.column("browUpRight")) == 0.5f);

  // Values outside the limits are clamped, as a track's are when it is animated, and named.
  const Ran wide = render(s.put("wide.csv", "jawOpen,browUpLeft\n-7,0.5\n0.1,0.5\n"), "v4.y4m");
  CHECK(wide.code == 0);
  CHECK(contains(wide.err, "clamped: jawOpen\n"));
  const CsvTable clamped(s / "again.csv", read_file(s / "again.csv"));
  CHECK(clamped.number(0, clamped.column("jawOpen")) == 0);
  CHECK(clamped.number(1, clamped.column("jawOpen")) == 0.1f);

  check_refused({"render", s.model, "--params", s.put("bad.csv", "jawOpen\n0.1\nwide\n"), "-o", s / "no.y4m"},
                {"bad.csv: line 3", "jawOpen", "wide"});
  check_refused({"render", s.model, "--params", s.put("bad.csv", "qw\n0\n"), "-o", s / "no.y4m"},
                {"bad.csv: line 2", "quaternion"});
  check_refused({"render", s.model, "--params", s.put("bad.csv", "tz\n-5\n"), "-o", s / "no.y4m"},
                {"bad.csv: line 2", "tz"});
  check_refused({"render", s.model, "--params", s.put("bad.csv", "tz\n"), "-o", s / "no.y4m"},
                {"bad.csv", "no rows"});
  check_refused(
      {"render", s.model, "--params", s.put("bad.csv", "browUp,browUpLeft\n1,0\n"), "-o", s / "no.y4m"},
      {"bad.csv: 'browUp' and 'browUpLeft' give the same parameter"});
  check_refused({"render", s.model, "--params", s.truth, "-o", s / "nowhere/no.y4m"},
                {"nowhere/no.y4m", "cannot be written"});
  CHECK_FALSE(s.has("no.y4m"));
  CHECK(s.temporary_count() == 0);
}

TEST_CASE("a model that cannot fill the picture from where a camera can be is rendered smaller or larger") {
  const Folder folder;
  const std::string model = folder.put("m.plm", model_bytes()), params = folder.put("q.csv", "jawOpen\n0.1\n");
  for (const char* focal : {"1", "1e6"}) {
    const Ran r = run_words({"render", model, "--params", params, "--focal", focal, "-o", folder / "v.y4m"});
    CAPTURE(r.err);
    CHECK(r.code == 0);
  }
}

TEST_CASE("bake refuses a folder without a source in one line and writes nothing") {
  const Folder folder;
  check_refused({"bake", folder.path.string(), "-o", folder / "m.plm"}, {folder.path.string()});
  check_refused({"bake", folder / "none", "-o", folder / "m.plm"}, {"none: no such file or folder"});
  CHECK(folder.file_count() == 0);
  check_refused({"bake", folder.put("mesh.ply", "ply\n"), "-o", folder / "m.plm"},
                {"pliant bake: " + (folder / "mesh.ply") + ": is neither an OBJ file nor a folder"});
  fs::create_symlink("loop.obj", folder.path / "loop.obj");
  check_refused({"bake", folder.path.string(), "-o", folder / "m.plm"}, {"pliant bake: " + folder.path.string()});
}

}  // namespace cli_test
