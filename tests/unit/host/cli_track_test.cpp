// `pliant track`: the files that it writes, and its messages for bad videos and bad initial states.
#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <sstream>

#include "cli_run.hpp"
#include "host/commands/track_report.hpp"
#include "host/io/csv.hpp"
#include "host/io/image.hpp"
#include "random_model.hpp"

namespace cli_track_test {

using namespace pliant;
using namespace pliant::host;
using namespace cli_run;

TEST_CASE("track measures the rendered motion, and its table has the documented columns") {
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
  CHECK(table.columns()[16] == "tz");
  CHECK(table.columns()[17] == "width");
  CHECK(table.columns()[21] == "x_ibug00");
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

TEST_CASE("a report counts no time of frames without a track") {
  const OpenModel egg(egg_model(3));
  TrackReport report(egg.model);
  TrackRow row;
  row.q.resize(egg.model.parameters().count);
  row.state = TrackState::lost;
  for (int k = 0; k < 6; ++k) report.add(row, std::nullopt);
  row.state = TrackState::tracking;
  for (int k = 0; k < 4; ++k) report.add(row, 5.25);
  ContactSheet sheet(1);
  sheet.add([] { return Image(8, 8, 1, 0); });
  CHECK(contains(report.page({}, sheet), "5.25 ms"));
}

TEST_CASE("what is drawn does not change what is tracked") {
  const Sequence s;
  auto words = s.track_words();
  REQUIRE(run_words(words).code == 0);
  const std::string track = read_file(s / "t.csv");
  words.insert(words.end(), {"--sheet", s / "sheet.png", "--overlay", s / "o.y4m", "--report", s / "r.html"});
  REQUIRE(run_words(words).code == 0);
  CHECK(read_file(s / "t.csv") == track);
}

TEST_CASE("landmarks keep their offsets from the model, unless --model-landmarks is given") {
  const Sequence s;
  // Moved up and down alternately, which no person or expression of the model explains. The video is unchanged.
  std::istringstream in(s.first_points());
  std::string line, points = "landmark,x,y\n", owned = "landmark,x,y,u,v\n";
  std::getline(in, line);
  std::map<std::string, Vec2> given;
  for (int k = 0; std::getline(in, line); ++k) {
    std::istringstream cells(line);
    std::string name;
    char comma;
    Vec2 x;
    std::getline(cells, name, ',');
    cells >> x.x >> comma >> x.y;
    x.y += k % 2 == 0 ? 6.0f : -6.0f;
    given[name] = x;
    points += name + "," + std::to_string(x.x) + "," + std::to_string(x.y) + "\n";
    const Vec2 uv{0.14f + 0.18f * static_cast<float>(k % 5), 0.2f + 0.3f * static_cast<float>(k / 5)};
    owned += name + "," + std::to_string(x.x) + "," + std::to_string(x.y) + "," +
             std::to_string(uv.x + 0.001f) + "," + std::to_string(uv.y) + "\n";
  }
  REQUIRE(given.size() == 15);
  auto words = s.track_words();
  const auto track = [&](const std::string& init, const char* how, float* first, float* last) {
    words[5] = init;
    words.resize(10);
    words.push_back(how);
    const Ran r = run_words(words);
    CAPTURE(r.err);
    REQUIRE(r.code == 0);
    const CsvTable table(s / "t.csv", read_file(s / "t.csv"));
    *first = *last = 0;
    for (const auto& point : given) {
      const std::string& name = point.first;
      const auto place = [&](std::size_t row) {
        return Vec2{table.number(row, table.column(("x_" + name).c_str())),
                    table.number(row, table.column(("y_" + name).c_str()))};
      };
      *first += length(place(0) - point.second) / 15;
      *last += length(place(11) - place(0)) / 15;
    }
    return read_file(s / "t.csv");
  };
  float first, moved, model_first, model_moved;
  const std::string beside = track(s.put("b.csv", points), "--landmarks", &first, &moved);
  track(s / "b.csv", "--model-landmarks", &model_first, &model_moved);
  CHECK(first < 1.5f);
  CHECK(model_first > 4);
  CHECK(moved > 5);
  CHECK(std::abs(moved - model_moved) < 2);
  REQUIRE(run_words({"fit", s.model, "--points", s / "b.csv", "--size", "200x160", "--focal", "330", "-o",
                     s / "f.json"})
              .code == 0);
  words[8] = "--freeze";  // fit.json has the focal length
  words[9] = "identity";
  const std::string from_fit = track(s / "f.json", "--landmarks", &first, &moved);
  CHECK(first < 1.5f);
  CHECK(std::count(from_fit.begin(), from_fit.end(), ',') == std::count(beside.begin(), beside.end(), ','));
  track(s.put("o.csv", owned), "--landmarks", &first, &moved);
  CHECK(first > 4);  // points with u,v of their own are no landmarks
}

TEST_CASE("a marker beside the model keeps its offset from it") {
  const Sequence s;
  auto words = s.track_words();
  words.insert(words.end(), {"--markers", s.put("marks.csv", "landmark,x,y\nbeside,12,80\n"), "--landmarks"});
  REQUIRE(run_words(words).code == 0);
  const CsvTable table(s / "t.csv", read_file(s / "t.csv"));
  const auto x = [&](std::size_t row, const char* name) { return table.number(row, table.column(name)); };
  CHECK(x(0, "x_beside") == doctest::Approx(12).epsilon(0.001));
  CHECK(x(0, "y_beside") == doctest::Approx(80).epsilon(0.001));
  const float moved =
      x(11, "x_ibug03") - x(0, "x_ibug03");  // the nearest landmark, a third of the face further in
  CHECK(moved > 12);
  CHECK(std::abs(x(11, "x_beside") - 12 - moved) < 10);
}

TEST_CASE("two runs write the same bytes") {
  const Sequence s;
  auto words = s.track_words();
  REQUIRE(run_words(words).code == 0);
  const std::string first = read_file(s / "t.csv");
  REQUIRE(run_words(words).code == 0);
  CHECK(read_file(s / "t.csv") == first);
}

TEST_CASE("--mirror of a mirrored video gives the track of the video") {
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

TEST_CASE("frozen expressions stay at rest, and the identity stays as fitted until the head has turned") {
  const Sequence s;
  auto words = s.track_words();
  REQUIRE(run_words(words).code == 0);
  const CsvTable free(s / "t.csv", read_file(s / "t.csv"));
  CHECK(free.cell(4, free.column("width")) == free.cell(0, free.column("width")));
  CHECK(free.cell(11, free.column("browUpLeft")) != free.cell(0, free.column("browUpLeft")));
  words.insert(words.end(), {"--freeze", "expression"});
  REQUIRE(run_words(words).code == 0);
  const CsvTable frozen(s / "t.csv", read_file(s / "t.csv"));
  for (const char* name : {"browUpLeft", "browUpRight", "jawOpen", "width"})
    CHECK(frozen.cell(11, frozen.column(name)) == frozen.cell(0, frozen.column(name)));
  CHECK(frozen.cell(11, frozen.column("qy")) != frozen.cell(0, frozen.column("qy")));
}

TEST_CASE("an adaptive mesh has other vertices, and the pose stays within 0.002") {
  const Sequence s;
  auto words = s.track_words();
  REQUIRE(run_words(words).code == 0);
  const CsvTable still(s / "t.csv", read_file(s / "t.csv"));
  words.insert(words.end(), {"--mesh-operations", "6"});
  REQUIRE(run_words(words).code == 0);
  const CsvTable adaptive(s / "t.csv", read_file(s / "t.csv"));
  bool differs = false;
  for (std::size_t k = 0; k < 12; ++k) {
    differs =
        differs || adaptive.cell(k, adaptive.column("vertices")) != still.cell(k, still.column("vertices"));
    CHECK(std::abs(adaptive.number(k, adaptive.column("qy")) - still.number(k, still.column("qy"))) < 0.002f);
  }
  CHECK(differs);
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
  std::string wide = read_file(s / "fit.json");
  wide.replace(wide.find("\"width\":0."), 10, "\"width\":9");
  words[5] = s.put("wide.json", wide);
  check_refused(words, {"wide.json", "'width'", "limits"});
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
  CHECK(s.temporary_count() == 0);
}

TEST_CASE("where the overlay cannot be written the track is kept, with one line and exit 1") {
  const Sequence s;
  auto words = s.track_words();
  words.insert(words.end(), {"--overlay", "/dev/full"});
  check_refused(words, {"/dev/full", "No space left"});
  CHECK(CsvTable("t", read_file(s / "t.csv")).row_count() == 12);
}

TEST_CASE("a track that has found nothing is not rendered") {
  const Sequence s;
  const std::string lost = s.put("lost.csv", "frame,state,jawOpen\n0,lost,\n1,lost,\n");
  check_refused({"render", s.model, "--params", lost, "-o", s / "r.y4m"}, {"lost.csv", "found nothing"});
  CHECK_FALSE(s.has("r.y4m"));
}

TEST_CASE("frames that are lost at the start of a track are rendered as the first that is not") {
  const Sequence s;
  const std::string track = s.put("late.csv",
                                  "frame,state,qw,qx,qy,qz,tx,ty,tz,jawOpen\n0,lost,,,,,,,,\n1,lost,,,,,,,,\n"
                                  "2,tracking,0.8,0,0.6,0,12,-7,700,0.1\n3,lost,,,,,,,,\n");
  const Ran r = run_words({"render", s.model, "--params", track, "-o", s / "r.y4m", "--truth", s / "rt.csv"});
  CAPTURE(r.err);
  REQUIRE(r.code == 0);
  CHECK(contains(r.err, "3 of 4 frames are lost"));
  const CsvTable truth(s / "rt.csv", read_file(s / "rt.csv"));
  REQUIRE(truth.row_count() == 4);
  for (std::size_t row = 0; row < 4; ++row) {
    CAPTURE(row);
    CHECK(truth.number(row, truth.column("qy")) == 0.6f);
    CHECK(truth.number(row, truth.column("tx")) == 12);
    CHECK(truth.number(row, truth.column("tz")) == 700);
    CHECK(truth.number(row, truth.column("jawOpen")) == 0.1f);
  }
}

TEST_CASE("a Y4M stream with a wrong size or without a header is refused in one line") {
  const Sequence s;
  const std::string whole = read_file(s.video), body = whole.substr(whole.find('\n') + 1);
  auto words = s.track_words();
  words[3] = s / "lie.y4m";
  words.back() = "1000";  // a focal length for pictures of each of these sizes
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

TEST_CASE("points that are mirrored start no track, and the message asks whether they are") {
  const Sequence s;
  std::istringstream in(s.first_points());
  std::string line, mirrored;
  std::getline(in, mirrored);
  while (std::getline(in, line)) {
    const std::size_t x = line.find(',') + 1, y = line.find(',', x);
    mirrored += "\n" + line.substr(0, x) + std::to_string(199 - std::stof(line.substr(x, y - x))) + line.substr(y);
  }
  auto words = s.track_words();
  words[5] = s.put("mirrored.csv", mirrored + "\n");
  check_refused(words, {"frame 0", "shows its back", "sides swapped"});
}

TEST_CASE("frames, markers and truths that a track cannot use are refused by name") {
  const Sequence s;
  auto words = s.track_words();
  const std::string flat = "YUV4MPEG2 W200 H160 F30:1 Cmono\nFRAME\n" + std::string(200 * 160, 'g');
  words[3] = s.put("flat.y4m", flat);
  check_refused(words, {"flat.y4m", "frame 0", "has no texture there"});
  check_refused({"track", s.model, "--frames", s.video, "--out", s / "t.csv"},
                {"m.plm", "nor a print", "--box"});
  words = s.track_words();
  words.insert(words.end(), {"--markers", s.put("marks.csv", "landmark,x,y\na,1,2\nb,3,NaN\n")});
  check_refused(words, {"marks.csv: line 3", "'y'"});
  s.put("marks.csv", "landmark,x,y\n");
  check_refused(words, {"marks.csv", "no markers"});
  for (const char* place : {"-1,80", "100,-0.6", "200,80", "100,160", "1e5,0"}) {
    s.put("marks.csv", std::string("landmark,x,y\na,0,0\nb,199.4,159.4\nc,") + place + "\n");
    check_refused(words, {"marks.csv: line 4", "marker 'c' is outside the picture of 200x160 pixels"});
  }
  s.put("marks.csv", "landmark,x,y\nnose_tip,1,2\n");
  words.push_back("--landmarks");
  check_refused(words, {"marks.csv: line 2", "nose_tip"});
  words = s.track_words();
  words.insert(words.end(), {"--truth", s.put("no_truth.csv", "frame,qw,qx,qy,qz\n0,1,0,0,0\n")});
  check_refused(words, {"no_truth.csv", "landmarks"});
  for (const char* w : {"0", "1e20"}) {
    const std::string row = std::string("0,") + w + ",0,0,0,1,2\n";
    s.put("no_truth.csv", "frame,qw,qx,qy,qz,x_nose_tip,y_nose_tip\n" + row);
    check_refused(words, {"no_truth.csv: line 2", "quaternion"});
    check_refused({"render", s.model, "--params", s / "no_truth.csv", "-o", s / "no.y4m"},
                  {"no_truth.csv: line 2", "quaternion"});
  }
  CHECK_FALSE(s.has("t.csv"));
}

TEST_CASE(
    "a printed surface in a film of 640 x 480 is found in the first frame, since all of it is searched at "
    "once") {
  const Folder folder;
  const std::string model = folder / "sheet.plm", film = folder / "film.y4m", track = folder / "track.csv";
  REQUIRE(run_words({"bake", PLIANT_FIXTURES "/sheet", "-o", model}).code == 0);
  const std::string params = folder.put("q.csv", "frame,tz\n0,900\n");
  REQUIRE(run_words({"render", model, "--params", params, "--size", "640x480", "-o", film}).code == 0);
  REQUIRE(run_words({"track", model, "--frames", film, "--out", track}).code == 0);
  const CsvTable table(track, read_file(track));
  REQUIRE(table.row_count() == 1);
  CHECK(table.cell(0, table.column("state")) == "tracking");
}

TEST_CASE(
    "what cannot be found by itself is told as what it is: a surface without a print, a print where a face "
    "is wanted") {
  const Folder folder;
  const std::string plain = folder / "plain.plm", printed = folder / "printed.plm",
                    film = folder / "film.y4m";
  REQUIRE(
      run_words({"bake", PLIANT_FIXTURES "/sheet", "--texture", "none", "--size", "32", "-o", plain}).code ==
      0);
  REQUIRE(run_words({"bake", PLIANT_FIXTURES "/sheet", "--size", "64", "-o", printed}).code == 0);
  const std::string params = folder.put("q.csv", "frame\n0\n");
  REQUIRE(run_words({"render", plain, "--params", params, "-o", film}).code == 0);
  check_refused({"track", plain, "--frames", film, "--out", folder / "t.csv"},
                {"plain.plm", "neither learnt tables", "nor a print", "--init", "texture"});
  for (const bool is_square : {false, true}) {
    const std::string calibration =
        folder.put("c.yml", std::string("%YAML:1.0\n---\nimage_width: 320\nimage_height: 240\n"
                                        "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
                                        "   data: [ 500., 0., 160., 0., ") +
                                (is_square ? "500" : "900") +
                                "., 120., 0., 0., 1. ]\n"
                                "distortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: 4\n   dt: d\n"
                                "   data: [ 0., 0., 0., 0. ]\n");
    const Ran r = run_words({"track", plain, "--frames", film, "--out", folder / "t.csv", "--calibration",
                             calibration, "--profile", "s"});
    CAPTURE(r.err);
    CHECK(contains(r.err, "far from square") == !is_square);
    CHECK(contains(r.err, "neither learnt tables"));
  }
  const std::string picture = folder / "p.png";
  write_file(picture, encode_png(Image(320, 240, 1, 128)));
  check_refused({"fit", printed, "--image", picture, "-o", folder / "f.json"},
                {"printed.plm", "by its print", "pliant track", "--points"});
}

}  // namespace cli_track_test
