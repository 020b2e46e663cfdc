// The pliant command, run in-process as a user would run it: what it writes, and what it says about bad
// input.
#include <doctest/doctest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "cli/command.hpp"
#include "cli/csv.hpp"
#include "cli/failure.hpp"
#include "cli/files.hpp"
#include "cli/fit_file.hpp"
#include "cli/image.hpp"
#include "cli/json.hpp"
#include "cli/points_file.hpp"
#include "cli/track_table.hpp"
#include "cli/truth.hpp"
#include "random.hpp"
#include "textured_model.hpp"

using namespace pliant;
using namespace pliant::cli;

namespace {

namespace fs = std::filesystem;

/// A folder of its own for each test case, removed with it.
struct Folder {
  fs::path path;
  Folder() {
    static int count = 0;
    path = fs::temp_directory_path() /
           ("pliant_cli_test_" + std::to_string(reinterpret_cast<std::uintptr_t>(&count) >> 12) + "_" +
            std::to_string(++count));
    fs::remove_all(path);
    fs::create_directories(path);
  }
  ~Folder() { fs::remove_all(path); }
  std::string operator/(const std::string& name) const { return (path / name).string(); }
  std::string put(const std::string& name, const std::string& bytes) const {
    std::ofstream(*this / name, std::ios::binary) << bytes;
    return *this / name;
  }
  bool has(const std::string& name) const { return fs::exists(path / name); }
  std::size_t file_count() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(path), fs::directory_iterator{}));
  }
};

struct Ran {
  int code;
  std::string out, err;
};

Ran run_words(const std::vector<std::string>& words) {
  std::ostringstream out, err;
  Console console{out, err};
  const int code = run(words, console);
  return {code, out.str(), err.str()};
}

bool is_one_line(const std::string& text) {
  return !text.empty() && text.back() == '\n' && std::count(text.begin(), text.end(), '\n') == 1;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Bad input: exit 1 and one line that has all these parts.
void check_refused(const std::vector<std::string>& words, const std::vector<std::string>& parts) {
  const Ran r = run_words(words);
  CAPTURE(r.err);
  CHECK(r.code == 1);
  CHECK(is_one_line(r.err));
  for (const std::string& part : parts) {
    CAPTURE(part);
    CHECK(contains(r.err, part));
  }
}

std::string model_bytes() {
  const auto bytes = TexturedModel{}.bytes();
  return {bytes.begin(), bytes.end()};
}

/// A model, twelve rendered frames of it with their truth, and the landmarks of frame 0.
struct Sequence : Folder {
  std::string model, video, truth, points;
  Sequence() {
    model = put("m.plm", model_bytes());
    std::string params = "frame,qw,qx,qy,qz,tx,ty,tz,width,browUpLeft,jawOpen\n";
    for (int k = 0; k < 12; ++k) {
      const auto t = static_cast<float>(k) / 11;
      const Quat q = exp_rotation({0.05f * t, 0.25f * t, -0.1f * t});
      std::ostringstream row;
      row << k << "," << q.w << "," << q.x << "," << q.y << "," << q.z << "," << 20 * t << "," << -5 * t
          << ",420,0.8," << 0.5f * t << "," << 0.1f * static_cast<float>(k % 6) << "\n";
      params += row.str();
    }
    put("q.csv", params);
    video = *this / "v.y4m";
    truth = *this / "truth.csv";
    const Ran r = run_words({"render", model, "--params", *this / "q.csv", "-o", video, "--truth", truth,
                             "--truth-points", *this / "tp.csv", "--size", "200x160", "--focal", "330"});
    REQUIRE(r.err == "");
    REQUIRE(r.code == 0);
    points = put("p.csv", first_points());
  }
  std::string first_points() const {
    std::istringstream in(read_file(*this / "tp.csv"));
    std::string line, out = "landmark,x,y\n";
    while (std::getline(in, line))
      if (line.rfind("0,", 0) == 0) out += line.substr(2) + "\n";
    return out;
  }
  std::vector<std::string> track_words() const {
    return {"track", model, "--frames", video, "--init", points, "--out", *this / "t.csv", "--focal", "330"};
  }
};

float value_after(const std::string& text, const std::string& key) {
  const std::size_t at = text.find(key + "=");
  REQUIRE(at != std::string::npos);
  return std::stof(text.substr(at + key.size() + 1));
}

}  // namespace

TEST_CASE("bad usage exits with 2 and says which word is wrong") {
  const struct {
    std::vector<std::string> words;
    const char* part;
  } cases[] = {
      {{}, "usage"},
      {{"dance"}, "no such command: dance"},
      {{"mesh", "m.plm"}, "not available in this build: mesh"},
      {{"info"}, "a file name is missing"},
      {{"info", "a", "b"}, "one word too many: b"},
      {{"fit", "m.plm", "--points", "p.csv"}, "-o is missing"},
      {{"fit", "m.plm", "-o", "f.json"}, "one of --points, --box and --pose"},
      {{"fit", "m.plm", "-o", "f.json", "--box", "1,2,3"}, "--box needs 4 numbers"},
      {{"fit", "m.plm", "-o", "f.json", "--box", "1,2,3,x"}, "--box: not numbers"},
      {{"fit", "m.plm", "-o", "f.json", "--size", "big", "--box", "1,2,3,4"}, ""},
      {{"track", "m.plm", "--frames"}, "--frames needs a value"},
      {{"track", "m.plm", "--frames", "a", "--frames", "b"}, "--frames is given twice"},
      {{"track", "m.plm", "--report", "r.html"}, "--report is not available in this build"},
      {{"track", "m.plm", "--wings"}, "unknown option --wings"},
      {{"render", "m.plm", "--landmarks"}, "unknown option --landmarks"},
      {{"render", "m.plm", "-o", "a", "--noise", "loud"}, "--noise: not a number in range: loud"},
      {{"render", "m.plm", "-o", "a", "--size", "320"}, "--size: not a size like 320x240: 320"},
      {{"bake", "x", "-o", "y", "--pca", "3"}, "--pca is not available in this build"},
      {{"bake", "x", "-o", "y", "--bits", "12"}, "--bits must be 8 or 16"},
  };
  for (const auto& c : cases) {
    const Ran r = run_words(c.words);
    CAPTURE(r.err);
    CAPTURE(c.part);
    if (*c.part != '\0') CHECK(r.code == 2);
    CHECK(r.code != 0);
    CHECK(contains(r.err, c.part));
  }
  const Folder folder;
  const std::string model = folder.put("m.plm", model_bytes());
  const std::string video =
      folder.put("v.y4m", "YUV4MPEG2 W32 H32 F25:1 Cmono\nFRAME\n" + std::string(1024, 'x'));
  CHECK(run_words({"track", model, "--frames", "camera:", "--init", "f", "--out", folder / "t"}).code == 2);
  CHECK(run_words({"track", model, "--frames", video, "--init", "outline", "--out", folder / "t"}).code == 2);
  CHECK(
      run_words({"track", model, "--frames", video, "--init", "f", "--out", folder / "t", "--freeze", "hair"})
          .code == 2);
  CHECK(folder.file_count() == 2);
}

TEST_CASE("help names every command, and every option of one") {
  const Ran all = run_words({"--help"});
  CHECK(all.code == 0);
  for (const char* name : {"bake", "info", "fit", "track", "render"})
    CHECK(contains(all.out, std::string("pliant ") + name));
  const Ran one = run_words({"track", "--help"});
  CHECK(one.code == 0);
  for (const char* name : {"--markers", "--marker-exclusion-px", "--sheet", "--mirror"})
    CHECK(contains(one.out, name));
}

TEST_CASE("a truncated or damaged model is one line, wherever it is cut or flipped") {
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

TEST_CASE("a points file with a fault is one line that says which line, column or landmark") {
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
      {head + good + "ibug03,1,2px\n", {"p.csv: line 5", "'y'", "2px"}},
      {head + good + "ibug03,,2\n", {"p.csv: line 5", "'x'"}},
      {head + good + "ibug03,1\n", {"p.csv: line 5", "2 cells"}},
      {head + good + "ibug01,1,2\n", {"p.csv: line 5", "ibug01", "twice"}},
      {head + good + ",1,2\n", {"p.csv: line 5", "without a name"}},
      {"landmark,x,x\na,1,2\n", {"p.csv", "two columns"}},
      {head + "ibug00,5,5\nibug01,5,5\nibug02,5,5\nibug03,5,5\n", {"p.csv", "determine"}},
      {std::string(300, '\0'), {"p.csv"}},
  };
  for (const auto& c : cases) {
    CAPTURE(c.text);
    folder.put("p.csv", c.text);
    check_refused({"fit", model, "--points", folder / "p.csv", "--size", "100x100", "-o", folder / "f.json"},
                  c.parts);
    CHECK_FALSE(folder.has("f.json"));
    CHECK_FALSE(folder.has("f.json.part"));
  }
}

TEST_CASE(
    "fit finds the pose and shape that were drawn, from all points, from five, from a box and from a pose") {
  const Sequence s;
  const auto fit_of = [&](std::vector<std::string> more) {
    std::vector<std::string> words{"fit", s.model, "-o", s / "fit.json"};
    words.insert(words.end(), more.begin(), more.end());
    const Ran r = run_words(words);
    CAPTURE(r.err);
    REQUIRE(r.code == 0);
    return parse_fit("fit.json", read_file(s / "fit.json"));
  };
  const FitFile all =
      fit_of({"--points", s.points, "--size", "200x160", "--focal", "330", "--overlay", s / "o.png"});
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
  const FitFile few = fit_of(
      {"--points", s.put("five.csv", five), "--size", "200x160", "--focal", "330", "--parameters", "none"});
  CHECK(few.points.size() == 5);
  CHECK(few.parameters[0].second == 0);

  const FitFile boxed = fit_of({"--box", "50,40,100,80", "--size", "200x160"});
  CHECK(boxed.points.empty());
  CHECK(boxed.unseen.size() == 4);
  CHECK(boxed.camera.f == doctest::Approx(1.4 * 200));

  s.put("start.json", read_file(s / "fit.json"));
  const FitFile again = fit_of({"--pose", s / "start.json"});
  CHECK(again.pose.t.z == doctest::Approx(boxed.pose.t.z));
  const FitFile from_pose = fit_of({"--pose", s / "start.json", "--points", s.points, "--focal", "330"});
  CHECK(length(log_rotation(from_pose.pose.q)) < 0.02f);
  CHECK(from_pose.rms_px < 0.2f);

  check_refused({"fit", s.model, "--pose", s / "start.json", "--size", "320x240", "-o", s / "x.json"},
                {"start.json", "200x160"});
  check_refused(
      {"fit", s.model, "--points", s.points, "--image", s / "o.png", "--size", "320x240", "-o", s / "x.json"},
      {"o.png", "400x320"});
  check_refused({"fit", s.model, "--points", s.points, "--image", s.points, "-o", s / "x.json"},
                {"p.csv", "not a picture"});
  CHECK(run_words({"fit", s.model, "--points", s.points, "-o", s / "x.json"}).code == 2);
  CHECK(run_words({"fit", s.model, "--points", s.points, "--size", "200x160", "--parameters", "nose", "-o",
                   s / "x.json"})
            .code == 2);
  CHECK_FALSE(s.has("x.json"));
}

TEST_CASE("a count of parameters frees the first ones of the table, a group its own") {
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
  CHECK(sd_of("none") == "0000");
  CHECK(sd_of("2") == "1100");
  CHECK(sd_of("identity") == "1000");
  CHECK(sd_of("expression") == "0111");
}

TEST_CASE("fit.json keeps every bit, and names what is wrong with it") {
  FitFile fit;
  fit.model_crc = 4294967291u;
  fit.width = 321;
  fit.height = 243;
  fit.camera = {333.333344f, 160.1f, 119.7f};
  fit.pose = {exp_rotation({0.3f, -0.2f, 0.1f}), {1.00000012f, -2.5e-7f, 612.34f}};
  fit.parameters = {{"a", 0.1f}, {"quote\"d\\name", -1.0f / 3}};
  fit.sd = {{"a", 1e-20f}};
  fit.unseen = {"a"};
  fit.rms_px = 0.7f;
  fit.inliers = 1;
  fit.points = {{"p", {1.5f, 2.25f}, {0.1f, -0.2f}, true}};
  const std::string text = fit_text(fit);
  const FitFile back = parse_fit("f.json", text);
  CHECK(back.model_crc == fit.model_crc);
  CHECK(std::memcmp(&back.pose, &fit.pose, sizeof fit.pose) == 0);
  CHECK(std::memcmp(&back.camera, &fit.camera, sizeof fit.camera) == 0);
  CHECK(back.parameters == fit.parameters);
  CHECK(back.sd == fit.sd);
  CHECK(back.unseen == fit.unseen);
  CHECK(back.points[0].used);
  CHECK(back.points[0].residual.y == fit.points[0].residual.y);
  CHECK(fit_text(back) == text);

  const auto complaint = [&](const std::string& from, const std::string& to) -> std::string {
    std::string changed = text;
    changed.replace(changed.find(from), from.size(), to);
    try {
      parse_fit("f.json", changed);
    } catch (const Failure& failure) {
      CHECK(failure.exit_code() == 1);
      return failure.what();
    }
    return "accepted";
  };
  CHECK(contains(complaint("\"version\": 1", "\"version\": 2"), "'version'"));
  CHECK(contains(complaint("4294967291", "4294967296"), "'model_crc'"));
  CHECK(contains(complaint("\"width\": 321", "\"width\": \"321\""), "'width'"));
  CHECK(contains(complaint("\"width\": 321", "\"width\": 0"), "'width'"));
  CHECK(contains(complaint("\"f\": 333", "\"f\": -333"), "'f'"));
  CHECK(contains(complaint("612.34", "-612.34"), "'t'"));
  CHECK(contains(complaint("\"a\": 0.100000001", "\"a\": null"), "'a'"));
  CHECK(contains(complaint("\"pose\"", "\"prose\""), "'pose'"));
  CHECK(contains(complaint("\"q\": [", "\"q\": [1, "), "'q'"));
  CHECK(contains(complaint("\"dx\"", "\"dz\""), "'dx'"));
}

TEST_CASE("garbage is never JSON: each fault has its line and column, and no nesting is too deep to refuse") {
  const struct {
    const char* text;
    const char* where;
  } cases[] = {{"", "line 1, column 1"},
               {"{", "column 2"},
               {"{\"a\":1,}", "name is expected"},
               {"[1 2]", "',' or ']'"},
               {"{\"a\" 1}", "':'"},
               {"{\"a\":1,\"a\":2}", "twice"},
               {"nul", "a value"},
               {"[01]", "a value"},
               {"[1.]", "a value"},
               {"[NaN]", "a value"},
               {"[+1]", "a value"},
               {"[1e]", "a value"},
               {"[1e999]", "a value"},
               {"\"a", "without end"},
               {"\"\\q\"", "escape"},
               {"\"\\u12g4\"", "hexadecimal"},
               {"\"\\ud800x\"", "surrogate"},
               {"\"a\nb\"", "control"},
               {"{}\n\n }", "line 3"},
               {"// x\n1", "a value"}};
  for (const auto& c : cases) {
    CAPTURE(c.text);
    std::string message = "accepted";
    try {
      Json::parse("g.json", c.text);
    } catch (const Failure& failure) {
      message = failure.what();
    }
    CHECK(contains(message, "g.json: line "));
    CHECK(contains(message, c.where));
  }
  CHECK_THROWS_AS(Json::parse("g", std::string(100000, '[')), Failure);
  std::string deep;
  for (int k = 0; k < 50000; ++k) deep += "{\"a\":";
  CHECK_THROWS_AS(Json::parse("g", deep), Failure);
  CHECK(*Json::parse("g", R"("\u00e9\ud83d\ude00\n")").string() == "\xc3\xa9\xf0\x9f\x98\x80\n");
}

TEST_CASE("a fit.json with bytes changed or cut at random is read or refused, never worse") {
  FitFile fit;
  fit.width = fit.height = 100;
  fit.camera = {100, 50, 50};
  fit.pose.t.z = 500;
  fit.parameters = {{"width", 1}, {"jawOpen", 0.5f}};
  fit.points = {{"p", {1, 2}, {}, true}};
  const std::string text = fit_text(fit);
  Random random(11);
  int refused = 0;
  for (int round = 0; round < 4000; ++round) {
    std::string changed = text;
    for (int k = random.below(3); k >= 0; --k)
      changed[static_cast<std::size_t>(random.below(static_cast<int>(changed.size())))] =
          static_cast<char>(random.below(256));
    if (round % 4 == 0)
      changed.resize(static_cast<std::size_t>(random.below(static_cast<int>(changed.size()))));
    try {
      const FitFile read = parse_fit("f", changed);
      CHECK(is_finite(read.pose));
      CHECK(read.camera.f > 0);
    } catch (const Failure&) {
      ++refused;
    }
  }
  CHECK(refused > 2000);
}

TEST_CASE("CSV: quotes, spaces, line ends and a byte order mark are taken as they are meant") {
  const CsvTable table("t.csv",
                       "\xef\xbb\xbf\"landmark\", x ,y\r\n\n\"a \"\"b\"\", c\",1.5,-2e1\r\n z , +3,0");
  CHECK(table.columns() == std::vector<std::string>{"landmark", "x", "y"});
  REQUIRE(table.row_count() == 2);
  CHECK(table.cell(0, 0) == "a \"b\", c");
  CHECK(table.number(0, 2) == -20);
  CHECK(table.cell(1, 0) == "z");
  CHECK(table.number(1, 1) == 3);
  CHECK(table.where(1) == "t.csv: line 4");
}

TEST_CASE("a track row keeps every float, and an unknown one is empty and never NaN") {
  const Folder folder;
  const ModelFile file(folder.put("m.plm", model_bytes()));
  TrackRow row;
  row.frame = 3;
  row.time_s = 0.1;
  row.pose = {exp_rotation({0.1f, 0.2f, 0.3f}), {1.0f / 3, -7.7f, 512.125f}};
  row.q = {0.1f, 1.0f / 7, 0, -0.3f};
  row.points = {Vec2{12.34f, 5}, std::nullopt};
  const std::string header = track_header(file.model(), {"ibug00", "m1"});
  CHECK(
      header ==
      "frame,time_s,state,tracked,inliers,rms_px,vertices,qw,qx,qy,qz,tx,ty,tz,width,browUpLeft,browUpRight,"
      "jawOpen,x_ibug00,y_ibug00,x_m1,y_m1\n");
  std::vector<std::string> unmatched;
  const auto read = read_posed_parameters(CsvTable("t", header + track_line(row)), file.model(),
                                          {{}, {0, 0, 0, 0}}, &unmatched);
  REQUIRE(read.size() == 1);
  CHECK(unmatched.empty());
  CHECK(read[0].q == row.q);
  CHECK(read[0].pose.t.x == row.pose.t.x);
  CHECK(read[0].pose.q.y == doctest::Approx(row.pose.q.y).epsilon(1e-6));
  CHECK(contains(track_line(row), "12.3400,5.0000,,\n"));
  row.state = TrackState::lost;
  row.rms_px = std::numeric_limits<float>::quiet_NaN();
  CHECK(track_line(row) == "3,0.1,lost,0,0,0,0" + std::string(7 + 4 + 4, ',') + "\n");
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

  check_refused({"render", s.model, "--params", s.put("bad.csv", "jawOpen\n0.1\nwide\n"), "-o", s / "no.y4m"},
                {"bad.csv: line 3", "jawOpen", "wide"});
  check_refused({"render", s.model, "--params", s.put("bad.csv", "qw\n0\n"), "-o", s / "no.y4m"},
                {"bad.csv: line 2", "quaternion"});
  check_refused({"render", s.model, "--params", s.put("bad.csv", "tz\n-5\n"), "-o", s / "no.y4m"},
                {"bad.csv: line 2", "behind"});
  check_refused({"render", s.model, "--params", s.put("bad.csv", "tz\n"), "-o", s / "no.y4m"},
                {"bad.csv", "no rows"});
  check_refused({"render", s.model, "--params", s.truth, "-o", s / "nowhere/no.y4m"},
                {"nowhere/no.y4m", "cannot be written"});
  CHECK_FALSE(s.has("no.y4m"));
  CHECK_FALSE(s.has("no.y4m.part"));
}

TEST_CASE("track follows what was drawn, and its table says so in the columns that were promised") {
  const Sequence s;
  s.put("marks.csv", "landmark,x,y\ncheek,70,90\nchin,100,115\n");
  auto words = s.track_words();
  for (const char* more : {"--landmarks", "--overlay", "o.y4m", "--sheet", "sheet.png", "--truth",
                           "truth.csv", "--markers", "marks.csv"})
    words.push_back(contains(more, ".") ? s / more : more);
  const Ran r = run_words(words);
  CAPTURE(r.err);
  REQUIRE(r.code == 0);
  CHECK(r.err == "");
  CHECK(is_one_line(r.out));
  CHECK(value_after(r.out, "frames") == 12);
  CHECK(value_after(r.out, "tracked") == 12);
  CHECK(value_after(r.out, "compared") == 12);
  CHECK(value_after(r.out, "landmark_px") < 0.8f);
  CHECK(value_after(r.out, "rotation_deg") < 2);
  CHECK(value_after(r.out, "arena_bytes") > 10000);

  const CsvTable table(s / "t.csv", read_file(s / "t.csv"));
  REQUIRE(table.row_count() == 12);
  CHECK(table.columns()[13] == "tz");
  CHECK(table.columns()[14] == "width");
  CHECK(table.columns()[18] == "x_eye_right");
  CHECK(table.columns().back() == "y_chin");
  CHECK(table.cell(0, 2) == "tracking");
  CHECK(table.number(0, table.column("x_cheek")) == doctest::Approx(70).epsilon(0.01));
  CHECK(table.number(0, table.column("y_chin")) == doctest::Approx(115).epsilon(0.01));
  CHECK(table.number(11, 0) == 11);

  const Image sheet = read_image(s / "sheet.png");
  CHECK(sheet.width == 3 * 400 + 4 * 4);
  const std::string overlay = read_file(s / "o.y4m");
  CHECK(overlay.rfind("YUV4MPEG2 W400 H320 F30:1", 0) == 0);
}

TEST_CASE("two runs write the same bytes") {
  const Sequence s;
  auto words = s.track_words();
  REQUIRE(run_words(words).code == 0);
  const std::string first = read_file(s / "t.csv");
  REQUIRE(run_words(words).code == 0);
  CHECK(read_file(s / "t.csv") == first);
}

TEST_CASE("a mirrored video gives the mirror image of the track's frames to the tracker") {
  const Sequence s;
  std::string flipped = read_file(s.video);
  const std::size_t head = flipped.find('\n') + 1;
  for (std::size_t frame = head; frame < flipped.size(); frame += 6 + 200 * 160)
    for (std::size_t y = 0; y < 160; ++y) {
      char* row = flipped.data() + frame + 6 + y * 200;
      std::reverse(row, row + 200);
    }
  auto words = s.track_words();
  REQUIRE(run_words(words).code == 0);
  const std::string straight = read_file(s / "t.csv");
  words[3] = s.put("flipped.y4m", flipped);
  words.push_back("--mirror");
  REQUIRE(run_words(words).code == 0);
  CHECK(read_file(s / "t.csv") == straight);
}

TEST_CASE("frozen expressions stay at rest, and the identity stays as fitted unless it is to be refined") {
  const Sequence s;
  auto words = s.track_words();
  REQUIRE(run_words(words).code == 0);
  const CsvTable free(s / "t.csv", read_file(s / "t.csv"));
  CHECK(free.cell(11, free.column("width")) == free.cell(0, free.column("width")));
  CHECK(free.cell(11, free.column("browUpLeft")) != free.cell(0, free.column("browUpLeft")));
  words.insert(words.end(), {"--freeze", "expression"});
  REQUIRE(run_words(words).code == 0);
  const CsvTable frozen(s / "t.csv", read_file(s / "t.csv"));
  for (const char* name : {"browUpLeft", "browUpRight", "jawOpen", "width"})
    CHECK(frozen.cell(11, frozen.column(name)) == frozen.cell(0, frozen.column(name)));
  CHECK(frozen.cell(11, frozen.column("qy")) != frozen.cell(0, frozen.column("qy")));
}

TEST_CASE("track refuses the fit of another model or of another size, by name") {
  const Sequence s;
  REQUIRE(run_words({"fit", s.model, "--points", s.points, "--size", "200x160", "-o", s / "fit.json"}).code ==
          0);
  auto words = s.track_words();
  words[5] = s / "fit.json";
  CHECK(run_words(words).code == 0);
  fs::remove(s / "t.csv");

  TexturedModel other;
  other.with_expressions = false;
  const auto bytes = other.bytes();
  auto with_other = words;
  with_other[1] = s.put("other.plm", {bytes.begin(), bytes.end()});
  check_refused(with_other, {"fit.json", "another model", "other.plm"});

  REQUIRE(
      run_words({"fit", s.model, "--points", s.points, "--size", "320x240", "-o", s / "large.json"}).code ==
      0);
  words[5] = s / "large.json";
  check_refused(words, {"large.json", "320x240", "200x160", "v.y4m"});

  words[5] = s.put("garbage.json", "{\"version\": 1, \"model_crc\": }");
  check_refused(words, {"garbage.json", "line 1"});
  words[5] = s.put("garbage.json", "{ \"version\": 1 }");
  check_refused(words, {"garbage.json", "model_crc"});
  words[5] = s / "missing.json";
  check_refused(words, {"missing.json", "No such file"});
  CHECK_FALSE(s.has("t.csv"));
}

TEST_CASE("a video that ends in mid-frame gives a row for every whole frame, one line, and exit 1") {
  const Sequence s;
  const std::string whole = read_file(s.video);
  const std::size_t head = whole.find('\n') + 1, frame = 6 + 200 * 160;
  auto words = s.track_words();
  words[3] = s / "cut.y4m";
  words.insert(words.end(), {"--overlay", s / "o.y4m", "--sheet", s / "sheet.png"});
  for (const std::size_t frames : {std::size_t{1}, std::size_t{2}, std::size_t{7}}) {
    s.put("cut.y4m", whole.substr(0, head + frames * frame + frame / 3));
    check_refused(words, {"cut.y4m", "frame " + std::to_string(frames), "cut off"});
    const CsvTable table("t", read_file(s / "t.csv"));
    CHECK(table.row_count() == frames);
    CHECK(read_file(s / "o.y4m").size() > frames * (6 + 400 * 320));
    CHECK(s.has("sheet.png"));
  }
  fs::remove(s / "t.csv");
  s.put("cut.y4m", whole.substr(0, head + frame / 3));
  check_refused(words, {"cut.y4m", "frame 0", "cut off"});
  s.put("cut.y4m", whole.substr(0, head));
  check_refused(words, {"cut.y4m", "no frames"});
  CHECK_FALSE(s.has("t.csv"));
  CHECK_FALSE(s.has("t.csv.part"));
}

TEST_CASE("a Y4M header that lies about its size, or is none, is one line") {
  const Sequence s;
  const std::string whole = read_file(s.video), body = whole.substr(whole.find('\n') + 1);
  auto words = s.track_words();
  words[3] = s / "lie.y4m";
  for (const char* header : {"YUV4MPEG2 W100 H160 F30:1 Cmono\n", "YUV4MPEG2 W4000 H3000 F30:1 Cmono\n",
                             "YUV4MPEG2 W200 H161 F30:1 Cmono\n", "YUV4MPEG2 W-200 H160 F30:1 Cmono\n",
                             "YUV4MPEG2 W200000 H160000 F30:1 Cmono\n", "YUV4MPEG2 H160 F30:1 Cmono\n",
                             "YUV4MPEG2 W200 H160 F30:1 Cxyz\n", "RIFF", ""}) {
    CAPTURE(std::string(header));
    s.put("lie.y4m", header + body);
    const Ran r = run_words(words);
    CAPTURE(r.err);
    CHECK(r.code == 1);
    CHECK(is_one_line(r.err));
    CHECK(contains(r.err, "lie.y4m"));
  }
}

TEST_CASE("a picture of another size in a folder stops the track there, in one line") {
  const Sequence s;
  const std::string whole = read_file(s.video);
  const std::size_t head = whole.find('\n') + 1, frame = 6 + 200 * 160;
  fs::create_directories(s.path / "frames");
  for (std::size_t k = 0; k < 5; ++k)
    s.put("frames/f" + std::to_string(k) + ".pgm",
          "P5\n200 160\n255\n" + whole.substr(head + k * frame + 6, frame - 6));
  auto words = s.track_words();
  words[3] = s / "frames";
  CHECK(run_words(words).code == 0);
  s.put("frames/f3.pgm", "P5\n100 160\n255\n" + std::string(100 * 160, 'a'));
  check_refused(words, {"f3.pgm", "100x160"});
  CHECK(CsvTable("t", read_file(s / "t.csv")).row_count() == 3);
}

TEST_CASE("what a tracker cannot start on is told, not tracked") {
  const Sequence s;
  auto words = s.track_words();
  const std::string flat = "YUV4MPEG2 W200 H160 F30:1 Cmono\nFRAME\n" + std::string(200 * 160, 'g');
  words[3] = s.put("flat.y4m", flat);
  check_refused(words, {"flat.y4m", "frame 0"});
  words = s.track_words();
  words.insert(words.end(), {"--markers", s.put("marks.csv", "landmark,x,y\na,1,2\nb,3,NaN\n")});
  check_refused(words, {"marks.csv: line 3", "'y'"});
  words.back() = s.put("marks.csv", "landmark,x,y\nnose_tip,1,2\n");
  words.push_back("--landmarks");
  check_refused(words, {"marks.csv: line 2", "nose_tip"});
  words = s.track_words();
  words.insert(words.end(), {"--truth", s.put("no_truth.csv", "frame,qw,qx,qy,qz\n0,1,0,0,0\n")});
  check_refused(words, {"no_truth.csv", "landmarks"});
  CHECK_FALSE(s.has("t.csv"));
}

TEST_CASE("a comparison with the truth measures what it says") {
  const Sequence s;
  const ModelFile file(s.model);
  TruthComparison same(s.truth, file.model()), off(s.truth, file.model());
  const CsvTable truth(s.truth, read_file(s.truth));
  std::vector<std::string> unmatched;
  const auto rows = read_posed_parameters(truth, file.model(), {{}, {0, 0, 0, 0}}, &unmatched);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    std::vector<std::optional<Vec2>> landmarks, moved;
    for (const Landmark& l : file.model().landmarks()) {
      const Vec2 x{truth.number(k, truth.column(std::string("x_") + l.name)),
                   truth.number(k, truth.column(std::string("y_") + l.name))};
      landmarks.push_back(x);
      moved.push_back(x + Vec2{3, 4});
    }
    same.add(k, rows[k].pose, landmarks);
    off.add(k, {normalised(exp_rotation({0, 0.1f, 0}) * rows[k].pose.q), {}}, moved);
  }
  CHECK(same.mean_landmark_px() == 0);
  CHECK(same.median_rotation_deg() < 0.01);
  CHECK(off.mean_landmark_px() == doctest::Approx(5));
  CHECK(off.median_rotation_deg() == doctest::Approx(5.7296).epsilon(0.001));
  CHECK(median({3, 1, 2}) == 2);
  CHECK(median({4, 1, 2, 3}) == 2.5);
}

TEST_CASE("bake refuses a folder that is no source in one line, and leaves nothing behind") {
  const Folder folder;
  check_refused({"bake", folder.path.string(), "-o", folder / "m.plm"}, {folder.path.string()});
  check_refused({"bake", folder / "none", "-o", folder / "m.plm"}, {"none"});
  CHECK(folder.file_count() == 0);
}
