// The files of the command: CSV, JSON, fit.json, tracks and their truth.
#include <doctest/doctest.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>

#include "cli_run.hpp"
#include "host/bench/annotated_faces.hpp"
#include "host/io/csv.hpp"
#include "host/io/failure.hpp"
#include "host/io/fit_file.hpp"
#include "host/io/json.hpp"
#include "host/io/statistics.hpp"
#include "host/io/track_table.hpp"
#include "host/io/truth.hpp"
#include "random.hpp"

namespace cli_files_test {

using namespace pliant;
using namespace pliant::host;
using namespace cli_run;

TEST_CASE("fit.json keeps every bit, and errors in it are named") {
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
  CHECK(contains(complaint("\"f\":333", "\"f\":-333"), "'f'"));
  for (const char* centre : {"cx", "cy"})
    CHECK(contains(complaint('"' + std::string(centre) + "\":", '"' + std::string(centre) + "\":1e8,\"no\":"),
                   "'camera': '" + std::string(centre) + "': is out of range"));
  CHECK(contains(complaint("612.34", "-612.34"), "'t'"));
  CHECK(contains(complaint("612.34", "0.001"), "between 50 mm and 100 m"));
  CHECK(contains(complaint("612.34", "1e9"), "between 50 mm and 100 m"));
  CHECK(contains(complaint("\"a\":0.1", "\"a\":null"), "'a'"));
  CHECK(contains(complaint("\"pose\"", "\"prose\""), "'pose'"));
  CHECK(contains(complaint("\"q\":[", "\"q\":[1, "), "'q'"));
  CHECK(contains(complaint("\"dx\"", "\"dz\""), "'dx'"));
}

TEST_CASE("fit.json has the focal length that is given, to the last bit") {
  const Sequence s;
  for (const std::vector<std::string>& how :
       {std::vector<std::string>{"--points", s.points}, std::vector<std::string>{"--box", "60,40,80,80"}})
    for (const std::string focal : {"300", "330", "333.3", "417.25"}) {
      CAPTURE(focal);
      std::vector<std::string> words{"fit", s.model, "--size", "200x160", "--focal", focal, "-o", s / "f.json"};
      words.insert(words.end(), how.begin(), how.end());
      CHECK(contains(run_words(words).out, ", f " + focal + " px\n"));
      CHECK(parse_fit("f", read_file(s / "f.json")).camera.f == std::stof(focal));
    }
}

TEST_CASE("text that is not JSON is refused with line and column, at any depth of nesting") {
  const struct {
    const char* text;
    const char* where;
  } cases[] = {{"", "line 1, column 0: syntax error"},
               {"{", "column 1: syntax error while parsing object key - unexpected end of input"},
               {"{\"a\":1,}", "column 8: syntax error while parsing object key - unexpected '}'"},
               {"[1 2]", "column 5: syntax error while parsing array - unexpected number literal"},
               {"{\"a\" 1}", "while parsing object separator"},
               {"{\"a\":1,\"a\":2}", "column 10: 'a' appears twice"},
               {"{\"a\\nb\":1,\"a\\nb\":2}", "column 16: 'a\\nb' appears twice"},
               {"nul", "invalid literal"},
               {"[01]", "unexpected number literal"},
               {"[1.]", "expected digit after '.'"},
               {"[NaN]", "invalid literal"},
               {"[+1]", "invalid literal"},
               {"[1e]", "exponent"},
               {"[1e999]", "column 7: number overflow parsing '1e999'"},
               {"\"a", "missing closing quote"},
               {"\"\\q\"", "forbidden character after backslash"},
               {"\"\\u12g4\"", "4 hex digits"},
               {"\"\\ud800x\"", "surrogate"},
               {"\"a\nb\"", "control character U+000A"},
               {"\"\xff\"", "ill-formed UTF-8"},
               {"{}\n\n }", "line 3, column 2"},
               {"// x\n1", "invalid literal"}};
  for (const auto& c : cases) {
    CAPTURE(c.text);
    std::string message = "accepted";
    try {
      parse_json("g.json", c.text);
    } catch (const Failure& failure) {
      message = failure.what();
    }
    CAPTURE(message);
    CHECK(contains(message, "g.json: line "));
    CHECK(contains(message, c.where));
  }
  CHECK_THROWS_AS(parse_json("g", std::string(100000, '[')), Failure);
  std::string deep;
  for (int k = 0; k < 50000; ++k) deep += "{\"a\":";
  CHECK_THROWS_AS(parse_json("g", deep), Failure);
  const std::string depth = std::string(kMaxJsonDepth, '[') + std::string(kMaxJsonDepth, ']');
  CHECK(parse_json("g", depth).is_array());
  CHECK_THROWS_AS(parse_json("g", "[" + depth + "]"), Failure);
  CHECK(parse_json("g", R"("\u00e9\ud83d\ude00\n")").get<std::string>() == "\xc3\xa9\xf0\x9f\x98\x80\n");
}

TEST_CASE("JSON that would take long is refused before it does") {
  const auto members = [](std::size_t count) {
    std::string text = "{";
    for (std::size_t k = 0; k < count; ++k) text += (k == 0 ? "\"m" : ",\"m") + std::to_string(k) + "\":0";
    return text + "}";
  };
  CHECK(parse_json("g", members(kMaxJsonMembers)).size() == kMaxJsonMembers);
  CHECK_THROWS_WITH_AS(parse_json("g", members(kMaxJsonMembers + 1)), doctest::Contains("too many members"),
                       Failure);
  CHECK_THROWS_WITH_AS(parse_json("g", members(300000)), doctest::Contains("too many members"), Failure);
  const std::string largest(kMaxJsonBytes - 1, ' ');
  CHECK(parse_json("g", largest + "0") == 0);
  CHECK_THROWS_WITH_AS(parse_json("g", largest + " 0"), doctest::Contains("is larger than"), Failure);
  // The slowest that is accepted: many full objects.
  std::string slow = "[" + members(kMaxJsonMembers);
  while (slow.size() + 10 * kMaxJsonMembers < kMaxJsonBytes) slow += "," + members(kMaxJsonMembers);
  const auto begin = std::chrono::steady_clock::now();
  CHECK(parse_json("g", slow + "]").size() > 300);
  CHECK(std::chrono::steady_clock::now() - begin < std::chrono::seconds(20));
}

TEST_CASE("a fit.json with random changes or cuts is read or refused") {
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

TEST_CASE("CSV may have quotes, spaces, any line ends and a byte order mark") {
  const CsvTable table("t.csv",
                       "\xef\xbb\xbf\"landmark\", x ,y\r\n\n\"a \"\"b\"\", c\",1.5,-2e1\r\n z , +3,0");
  CHECK(table.columns() == std::vector<std::string>{"landmark", "x", "y"});
  REQUIRE(table.row_count() == 2);
  CHECK(table.cell(0, 0) == "a \"b\", c");
  CHECK(table.number(0, 2) == -20);
  CHECK(table.cell(1, 0) == "z");
  CHECK(table.number(1, 1) == 3);
  CHECK(table.where(1) == "t.csv: line 4");
  CHECK_THROWS_AS((void)CsvTable("t.csv", "x\n+-3\n").number(0, 0), Failure);
  const CsvTable returns("t.csv", "landmark,x,y\r\ra,1,2\r");
  REQUIRE(returns.row_count() == 1);
  CHECK(returns.number(0, 2) == 2);
  CHECK(returns.where(0) == "t.csv: line 3");
  const CsvTable mixed("t.csv", "landmark,x,y\r\ra,1,2\r\nb,3,4\n");
  REQUIRE(mixed.row_count() == 2);
  CHECK(mixed.number(0, 2) == 2);
  CHECK(mixed.where(1) == "t.csv: line 4");
}

TEST_CASE("tables that are no CSV in UTF-8 with commas are refused by what they are") {
  const auto error = [](const std::string& text) {
    try {
      const CsvTable table("t.csv", text);
      return std::string();
    } catch (const Failure& failure) {
      return std::string(failure.what());
    }
  };
  CHECK(error("landmark,x,y\na,1,2\n") == "");
  CHECK(error("alone\n1\n") == "");
  CHECK(error("landmark,x,y\na, \"1\" ,\"2\"\r\n") == "");
  CHECK(contains(error("landmark,x,y\na,\"1\"0,2\n"), "t.csv: line 2: the quotes of a cell"));
  CHECK(contains(error("landmark,x,y\na,1,\"2\n"), "t.csv: line 2: the quotes of a cell"));
  CHECK(contains(error("landmark;x;y\na;1,5;2\n"), "t.csv: has no commas between its columns"));
  CHECK(contains(error("landmark\tx\ty\na\t1\t2\n"), "t.csv: has no commas between its columns"));
  CHECK(contains(error(std::string("\xff\xfel\0,\0", 6)), "t.csv: is text in UTF-16"));
}

TEST_CASE("the number of a frame is a whole number, in a track and in annotated frames") {
  const Folder folder;
  for (const char* bad : {"-1", "1.5", "1e30", "x"}) {
    CAPTURE(bad);
    const std::string path = folder.put("t.csv", std::string("frame,landmark,x,y\n2,a,1,2\n") + bad + ",a,1,2\n");
    const CsvTable table(path, read_file(path));
    CHECK(table.whole_number(0, 0) == 2);
    CHECK_THROWS_WITH_AS((void)table.whole_number(1, 0), doctest::Contains("t.csv: line 3: column 'frame'"), Failure);
    CHECK_THROWS_AS((void)read_annotated_frames(path), Failure);
  }
}

TEST_CASE("a track row keeps every float, and unknown values are empty") {
  const Folder folder;
  const ModelFile file(folder.put("m.plm", model_bytes()));
  TrackRow row;
  row.frame = 3;
  row.time_s = 0.1;
  row.pose = {exp_rotation({0.1f, 0.2f, 0.3f}), {1.0f / 3, -7.7f, 512.125f}};
  row.q = {0.1f, 1.0f / 7, 0, -0.3f};
  row.points = {Vec2{12.34f, 5}, std::nullopt};
  const std::string header = track_header(file.model(), {"ibug00", "m1"});
  CHECK(header ==
        "frame,time_s,state,tracked,inliers,rms_px,vertices,landmark_error,gaze_left,gaze_up,qw,qx,qy,qz,tx,"
        "ty,tz,"
        "width,browUpLeft,browUpRight,"
        "jawOpen,x_ibug00,y_ibug00,x_m1,y_m1\n");
  std::vector<std::string> unmatched;
  const auto read = read_posed_parameters(CsvTable("t", header + track_line(row)), file.model(),
                                          {{}, {0, 0, 0, 0}}, &unmatched);
  REQUIRE(read.size() == 1);
  CHECK(unmatched.empty());
  CHECK(read[0].q == row.q);
  CHECK(read[0].pose.t.x == row.pose.t.x);
  CHECK(read[0].pose.q.y == doctest::Approx(static_cast<double>(row.pose.q.y)).epsilon(1e-6));
  CHECK(contains(track_line(row), "12.3400,5.0000,,\n"));
  CHECK(contains(track_line(row), ",0,,,,"));  // neither error nor gaze known
  row.gaze = {0.6f, 0, 0.8f};
  CHECK(contains(track_line(row), ",0,,0.6435,0.0000,"));
  row.state = TrackState::lost;
  row.rms_px = std::numeric_limits<float>::quiet_NaN();
  CHECK(track_line(row) == "3,0.1,lost,0,0,0,0" + std::string(1 + 2 + 7 + 4 + 4, ',') + "\n");
}

TEST_CASE("names of parameters and points may have commas and quotes: the header is read as it was written") {
  const CsvTable table("t", track_header({"q,\"r\""}, {"a,b", "the \"mole\""}) + std::string(21, ',') + "\n");
  CHECK(table.find_column("q,\"r\"").has_value());
  CHECK(table.find_column("x_a,b").has_value());
  CHECK(table.find_column("y_the \"mole\"").has_value());
  CHECK(table.columns().size() == 22);
}

TEST_CASE("a comparison with the truth gives the known errors") {
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
    same.add(k, rows[k].pose, landmarks, {200, 160});
    off.add(k, {normalised(exp_rotation({0, 0.1f, 0}) * rows[k].pose.q), {}}, moved, {100, 80});
  }
  CHECK_FALSE(same.is_mostly_outside());
  CHECK(off.is_mostly_outside());
  CHECK(same.mean_landmark_px() == 0);
  CHECK(same.median_rotation_deg() < 0.01);
  CHECK(off.mean_landmark_px() == doctest::Approx(5));
  CHECK(off.median_rotation_deg() == doctest::Approx(5.7296).epsilon(0.001));
  CHECK(median({3, 1, 2}) == 2);
  CHECK(median({4, 1, 2, 3}) == 2.5);
  CHECK(median({}) == 0);
  CHECK(quantile({4, 1, 2, 3, 5}, 0.75) == 4);
  CHECK(std::isnan(quantile({}, 0.5)));
}

}  // namespace cli_files_test
