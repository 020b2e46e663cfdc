// `pliant detect`, and the commands that find a face themselves, as a user runs them.
#include <doctest/doctest.h>
#include <sys/stat.h>

#include <algorithm>

#include "cli_run.hpp"
#include "face_film.hpp"
#include "host/commands/tracker_limits.hpp"
#include "host/io/csv.hpp"
#include "host/io/fit_file.hpp"
#include "host/io/image.hpp"
#include "host/io/learnt_file.hpp"

namespace cli_detect_test {

using namespace pliant::host;
using namespace cli_run;

namespace {

std::string picture(const Folder& folder, const char* name, int width, int height) {
  return folder.put(name, encode_png(Image(width, height, 1, 90)));
}

constexpr int kWidth = 320, kHeight = 240;
const std::string kFace = PLIANT_DETECTING_FACE;
const std::string kAstronaut = PLIANT_FIXTURES "/astronaut/astronaut.png";

/// A model, and a film of which only the frames given show the face; the others an empty room.
struct Visit : Folder {
  std::string video;
  Visit(std::size_t frames, std::size_t from, std::size_t to) {
    std::string stream = "YUV4MPEG2 W320 H240 F30:1 Cmono\n";
    for (std::size_t k = 0; k < frames; ++k) {
      Picture room = make_backdrop(kWidth, kHeight, 5);
      add_noise(room, 2, static_cast<std::uint32_t>(k));
      const bool is_there = k >= from && k < to;
      const auto& pixels = is_there ? film().frames[k - from] : room.pixels;
      stream += "FRAME\n" + std::string(pixels.begin(), pixels.end());
    }
    video = put("v.y4m", stream);
  }
  static const FaceFilm& film() {
    static const FaceFilm* one = new FaceFilm(
        kWidth, kHeight, 16,
        [](float s, Pose& pose, auto& q) {
          pose.q = exp_rotation({0.05f, 0.15f * s, 0.05f});
          pose.t = pose.t + Vec3{7, -5, 10 * s};
          FaceFilm::set(q, "faceWidth", 0.8f);
          FaceFilm::set(q, "noseLength", 0.9f);
        },
        0.62f);
    return *one;
  }
  Ran track(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"track", kFace,           "--frames",   video,
                                   "--out", *this / "t.csv", "--landmarks"};
    words.insert(words.end(), more.begin(), more.end());
    return run_words(words);
  }
};

}  // namespace

TEST_CASE("frames without a face are rows in state lost; the track starts when a face appears") {
  const Visit visit(20, 4, 20);
  const Ran r = visit.track({"--sheet", visit / "sheet.png", "--report", visit / "report.html"});
  CAPTURE(r.err);
  REQUIRE(r.code == 0);
  CHECK(value_after(r.out, "frames") == 20);
  CHECK(value_after(r.out, "tracked") == 16);
  const CsvTable table("t", read_file(visit / "t.csv"));
  REQUIRE(table.row_count() == 20);
  for (std::size_t k = 0; k < 20; ++k) {
    CAPTURE(k);
    CHECK(table.cell(k, table.column("state")) == (k < 4 ? "lost" : "tracking"));
    CHECK(table.cell(k, table.column("landmark_error")).empty() == (k < 4));
    CHECK(table.cell(k, table.column("x_ibug36")).empty() == (k < 4));
  }
  float sum = 0;
  for (int l = 17; l < 68; ++l) {
    const std::string name = "ibug" + std::to_string(l);
    const Vec2 x{table.number(19, table.column("x_" + name)), table.number(19, table.column("y_" + name))};
    sum += length(x - Visit::film().truth(name, 15)) / 51;
  }
  CHECK(sum < 3);
}

TEST_CASE(
    "fit --image keeps the focal length that it is given, and says so where what it finds is doubtful") {
  const Folder folder;
  for (const char* focal : {"400", "1500"}) {
    const Ran r =
        run_words({"fit", kFace, "--image", kAstronaut, "--focal", focal, "-o", folder / "fit.json"});
    CAPTURE(r.err);
    REQUIRE(r.code == 0);
    CHECK(r.err == "");
    const FitFile fit = parse_fit("fit.json", read_file(folder / "fit.json"));
    CHECK(fit.camera.f == doctest::Approx(std::stod(focal)).epsilon(1e-5));
  }
  const Ran suit =
      run_words({"fit", kFace, "--image", kAstronaut, "--box", "10,300,50,50", "-o", folder / "fit.json"});
  CHECK(contains(suit.err, "doubtful"));
}

TEST_CASE("a large video that need not be tracked in real time is searched whole in each frame") {
  TrackerLimits limits;
  CHECK(whole_search(baked_face().model, limits) == limits.search_work);
  limits.width = 1280;
  limits.height = 960;
  CHECK(whole_search(baked_face().model, limits) == 16 * TrackerLimits{}.search_work);
  limits.width = limits.height = 64;
  CHECK(whole_search(baked_face().model, limits) == TrackerLimits{}.search_work);
}

TEST_CASE(
    "a face that fills large frames is found and tracked in reduced ones, and its landmarks are those of the "
    "frames") {
  const Visit visit(0, 0, 0);
  constexpr int kFactor = 11, kFrames = 3;
  std::string stream = "YUV4MPEG2 W3520 H2640 F30:1 Cmono\n";
  for (std::size_t k = 0; k < kFrames; ++k) {
    Image small(kWidth, kHeight, 1);
    std::copy_n(Visit::film().frames[k].data(), small.pixels.size(), small.pixels.data());
    const Image large = enlarged(small, kFactor);
    stream += "FRAME\n" + std::string(large.pixels.begin(), large.pixels.end());
  }
  visit.put("v.y4m", stream);
  const auto error = [&] {
    const CsvTable table("t", read_file(visit / "t.csv"));
    float sum = 0;
    for (int l = 17; l < 68; ++l) {
      const std::string name = "ibug" + std::to_string(l);
      const Vec2 x{table.number(kFrames - 1, table.column("x_" + name)),
                   table.number(kFrames - 1, table.column("y_" + name))};
      const Vec2 truth = Visit::film().truth(name, kFrames - 1);
      sum += length(x - Vec2{kFactor * (truth.x + 0.5f) - 0.5f, kFactor * (truth.y + 0.5f) - 0.5f}) / 51;
    }
    return sum;
  };
  const Ran found = visit.track();
  CAPTURE(found.err);
  REQUIRE(found.code == 0);
  CHECK(contains(found.err, "reduced to 1/"));
  CHECK(is_one_line(found.err));
  CHECK(value_after(found.out, "tracked") == kFrames);
  CHECK(error() < 3 * kFactor);
  std::string points = "landmark,x,y\n";
  for (int l = 17; l < 68; ++l) {
    const std::string name = "ibug" + std::to_string(l);
    const Vec2 x = Visit::film().truth(name, 0);
    points += name + "," + std::to_string(kFactor * (x.x + 0.5f) - 0.5f) + "," +
              std::to_string(kFactor * (x.y + 0.5f) - 0.5f) + "\n";
  }
  const Ran given =
      visit.track({"--init", visit.put("p.csv", points), "--markers",
                   visit.put("m.csv", "landmark,x,y\nspot,1700,1400\n"), "--sheet", visit / "s.png"});
  CAPTURE(given.err);
  REQUIRE(given.code == 0);
  CHECK(value_after(given.out, "tracked") == kFrames);
  CHECK(error() < kFactor);
  const CsvTable table("t", read_file(visit / "t.csv"));
  CHECK(table.number(0, table.column("x_spot")) == doctest::Approx(1700));
  CHECK(table.number(0, table.column("y_spot")) == doctest::Approx(1400));
}

TEST_CASE("a film without a face has rows in state lost, and is no error") {
  const Visit visit(8, 0, 0);
  const Ran r = visit.track();
  CHECK(r.code == 0);
  CHECK(value_after(r.out, "frames") == 8);
  CHECK(value_after(r.out, "tracked") == 0);
  CHECK(contains(r.err, "no face was found"));
  CHECK_FALSE(contains(Visit(8, 0, 6).track().err, "no face"));
}

TEST_CASE("a track starts from the box that detect writes") {
  const Visit visit(6, 0, 6);
  const std::string first = visit / "first.pgm";
  const auto& pixels = Visit::film().frames[0];
  visit.put("first.pgm", "P5 320 240 255\n" + std::string(pixels.begin(), pixels.end()));
  REQUIRE(run_words({"detect", kFace, "--image", first, "-o", visit / "f.csv"}).code == 0);
  const CsvTable found("f", read_file(visit / "f.csv"));
  REQUIRE(found.row_count() == 1);
  std::string box;
  for (const char* column : {"x", "y", "width", "height"})
    box += (box.empty() ? "" : ",") + found.cell(0, found.column(column));
  const Ran r = visit.track({"--box", box});
  CAPTURE(r.err);
  CHECK(r.code == 0);
  CHECK(value_after(r.out, "tracked") == 6);
  CHECK(visit.track({"--box", "1,2,3"}).code == 2);
  CHECK(visit.track({"--box", "1,2,3,0"}).code == 2);
  CHECK(visit.track({"--box", box, "--box-of", "nobody"}).code == 2);
  CHECK(visit.track({"--box", box, "--init", "f.json"}).code == 2);
}

TEST_CASE("points of frame 0 need a start that is given, and a model without tables too") {
  const Visit visit(1, 0, 1);
  CHECK(visit.track({"--markers", visit.put("m.csv", "landmark,x,y\na,1,2\n")}).code == 2);
  const std::string plain = visit.put("plain.plm", read_file(PLIANT_BAKED_FACE));
  check_refused({"track", plain, "--frames", visit.video, "--out", visit / "t.csv"}, {"plain.plm", "--init"});
}

TEST_CASE("detect writes a row a face, of a picture or of a folder, and draws them") {
  const Folder folder;
  const Ran one = run_words({"detect", kFace, "--image", kAstronaut, "--overlay", folder / "o.png"});
  REQUIRE(one.code == 0);
  const CsvTable table("one", one.out);
  REQUIRE(table.row_count() == 1);
  CHECK(table.columns() == std::vector<std::string>{"file", "face", "score", "x", "y", "width", "height"});
  CHECK(table.cell(0, 0) == "astronaut.png");
  CHECK(table.number(0, 2) > 0.5f);
  CHECK(table.number(0, 3) == doctest::Approx(174).epsilon(0.05));
  CHECK(table.number(0, 5) == table.number(0, 6));
  const Image drawn = read_image(folder / "o.png");
  CHECK(drawn.width == 512);
  fs::create_directories(folder / "in");
  fs::copy(kAstronaut, folder / "in/a, face.png");
  folder.put("in/b.png", encode_png(Image(70, 50, 1, 90)));
  folder.put("in/notes.txt", "no picture");
  folder.put("in/._b.png", "what some systems note of b.png");
  REQUIRE(mkfifo((folder / "in/pipe.png").c_str(), 0600) == 0);
  const Ran all =
      run_words({"detect", kFace, "--image", folder / "in", "-o", folder / "f.csv", "--landmarks"});
  REQUIRE(all.code == 0);
  CHECK(contains(all.out, "1 faces in 1 of 2 pictures"));
  const CsvTable faces("all", read_file(folder / "f.csv"));
  REQUIRE(faces.row_count() == 1);
  CHECK(faces.cell(0, 0) == "a, face.png");
  CHECK(faces.number(0, faces.column("x_ibug30")) == doctest::Approx(223).epsilon(0.05));
  CHECK(run_words({"detect", kFace, "--image", folder / "in", "--overlay", folder / "o.png"}).code == 2);
}

TEST_CASE("a table that cannot be written is told before a folder of pictures is searched") {
  const Folder folder;
  fs::create_directories(folder / "in");
  folder.put("in/a.png", "no picture");
  check_refused({"detect", kFace, "--image", folder / "in", "-o", folder / "missing/f.csv"},
                {"missing/f.csv", "cannot be written"});
}

TEST_CASE("a picture of a folder that cannot be read has a line on stderr, and the others are searched") {
  const Folder folder;
  fs::create_directories(folder / "in");
  folder.put("in/a.jpg", read_file(kAstronaut).substr(0, 20));
  folder.put("in/b.pgm", "P5 9000 64 255\n" + std::string(9000 * 64, 'b'));
  fs::copy(kAstronaut, folder / "in/c.png");
  const std::vector<std::string> words{"detect", kFace, "--image", folder / "in"};
  const Ran r = run_words(words);
  CAPTURE(r.err);
  CHECK(r.code == 1);
  CHECK(std::count(r.err.begin(), r.err.end(), '\n') == 2);
  CHECK(contains(r.err, "pliant detect: " + (folder / "in/a.jpg")));
  CHECK(contains(r.err, "b.pgm: is larger than 8192 pixels"));
  const CsvTable faces("faces", r.out);
  REQUIRE(faces.row_count() == 1);
  CHECK(faces.cell(0, 0) == "c.png");
  auto to_file = words;
  to_file.insert(to_file.end(), {"-o", folder / "f.csv"});
  const Ran written = run_words(to_file);
  CHECK(written.code == 1);
  CHECK(contains(written.out, "1 faces in 1 of 3 pictures, of which 2 could not be read"));
  CHECK(read_file(folder / "f.csv") == r.out);
  check_refused({"detect", kFace, "--image", folder / "in/a.jpg", "-o", folder / "x.csv"}, {"a.jpg"});
  CHECK_FALSE(folder.has("x.csv"));
}

TEST_CASE("fit needs no points: it finds the face, and says how far its landmarks may be off") {
  const Folder folder;
  const std::string json = folder / "fit.json";
  const Ran r = run_words({"fit", kFace, "--image", kAstronaut, "-o", json});
  CAPTURE(r.err);
  REQUIRE(r.code == 0);
  CHECK(contains(r.out, "expected landmark error"));
  const FitFile fit = parse_fit(json, read_file(json));
  CHECK(fit.landmark_error > 0);
  CHECK(fit.points.size() == 51);
  const Ran held = run_words({"fit", kFace, "--image", kAstronaut, "--parameters", "none", "-o", json});
  REQUIRE(held.code == 0);
  CHECK_FALSE(contains(held.out, "expected landmark error"));  // that is the alignment's, which moved all
  CHECK(parse_fit(json, read_file(json)).landmark_error == 0);
  const std::string grey = folder.put("grey.png", encode_png(Image(200, 200, 1, 90)));
  check_refused({"fit", kFace, "--image", grey, "-o", folder / "x.json"}, {"grey.png", "no face found"});
}

TEST_CASE("the published dynamics do not converge on a photograph, and fit says so") {
  const Folder folder;
  const std::vector<std::string> words{"fit",     kFace, "--image", kAstronaut, "-o", folder / "fit.json",
                                       "--method"};
  const auto with = [&](const char* method) {
    auto all = words;
    all.push_back(method);
    return all;
  };
  check_refused(with("euler"), {"astronaut.png", "the dynamics", "--method preconditioned"});
  for (const char* method : {"preconditioned", "barzilai-borwein"}) {
    const Ran r = run_words(with(method));
    CAPTURE(r.err);
    CHECK(r.code == 0);
  }
}

TEST_CASE("a picture of 16 bits a channel is refused where its reader would read past its end") {
  const Folder folder;
  const std::string deep = folder.put("deep.pgm", "P5 2 2 65535\n" + std::string(8, '\x42'));
  check_refused({"detect", kFace, "--image", deep}, {"deep.pgm", "8-bit"});
}

TEST_CASE("detect refuses a model without learnt tables, and damaged tables, by the model's name") {
  const Folder folder;
  const std::string model = folder.put("m.plm", model_bytes()), image = picture(folder, "p.png", 64, 64);
  check_refused({"detect", model, "--image", image}, {"m.plm", "no learnt tables"});
  const std::string learnt = folder.put("l.bin", format_learnt({{1, 2, 3, 4}, {5, 6, 7, 8}, {}}));
  const std::string face = folder / "f.plm";
  REQUIRE(run_words({"bake", PLIANT_FIXTURES "/face", "-o", face, "--size", "16", "--learnt", learnt}).code ==
          0);
  check_refused({"detect", face, "--image", image}, {"f.plm"});
  check_refused({"track", face, "--frames", folder / "", "--count", "1", "--out", folder / "t.csv"},
                {"f.plm: learnt tables"});
}

TEST_CASE("learn refuses a model that is no face, folders without pictures, and a part that there is not") {
  const Folder folder;
  const std::string model = kFace;
  check_refused({"learn", folder.put("m.plm", model_bytes()), "--faces", "none", "--others", folder / "",
                 "-o", folder / "l.bin"},
                {"m.plm", "no landmark 'ibug"});
  const std::string landmarks = folder.put("landmarks.csv", "name,landmark,x,y\n");
  check_refused({"learn", model, "--faces", folder / "none", "--others", folder / "", "-o", folder / "l.bin"},
                {"landmarks.csv"});
  CHECK(run_words({"learn", model, "--faces", folder / "", "--others", folder / "", "-o", folder / "l.bin",
                   "--only", "eyes"})
            .code == 2);
  check_refused({"learn", model, "--faces", folder / "", "--others", folder / "", "-o", folder / "l.bin",
                 "--only", "detector"},
                {"l.bin"});
  // Before anything is read, let alone learnt.
  check_refused(
      {"learn", model, "--faces", folder / "none", "--others", folder / "", "-o", folder / "none/l.bin"},
      {"none/l.bin: cannot be written"});
  CHECK_FALSE(folder.has("l.bin"));
  CHECK(folder.temporary_count() == 0);
}

}  // namespace cli_detect_test
