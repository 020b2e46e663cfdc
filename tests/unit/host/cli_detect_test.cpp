// `pliant track --init detect`: detects the face to track, says so, and rejects a detection that is not confirmed.
#include "cli_run.hpp"
#include "face_film.hpp"
#include "host/io/csv.hpp"

using namespace pliant;
using namespace pliant::host;
using namespace cli_run;

namespace {

constexpr int kWidth = 320, kHeight = 240;

const FaceFilm& film() {
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

/// A model, and a film of which only the frames given show the face; the others an empty room.
struct Visit : Folder {
  std::string model, video;
  Visit(std::size_t frames, std::size_t from, std::size_t to) {
    const auto& words = baked_face().words;
    model = put("face.plm", {reinterpret_cast<const char*>(words.data()), words.size() * 4});
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
  std::vector<std::string> words(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> out{"track", model,           "--frames", video, "--init",     "detect",
                                 "--out", *this / "t.csv", "--focal",  "400", "--landmarks"};
    out.insert(out.end(), more.begin(), more.end());
    return out;
  }
};

}  // namespace

TEST_CASE("frames without a face are rows in state lost; the track starts when a face appears") {
  const Visit visit(20, 4, 20);
  const Ran r = run_words(visit.words({"--sheet", visit / "sheet.png"}));
  CAPTURE(r.err);
  REQUIRE(r.code == 0);
  CHECK(contains(r.err, "frame 0: no face found yet"));
  CHECK(contains(r.err, "frame 4: face found"));
  CHECK_FALSE(contains(r.err, "is not confirmed"));
  CHECK(value_after(r.out, "frames") == 20);
  CHECK(value_after(r.out, "tracked") == 16);
  const CsvTable table("t", read_file(visit / "t.csv"));
  REQUIRE(table.row_count() == 20);
  for (std::size_t k = 0; k < 20; ++k) {
    CAPTURE(k);
    CHECK(table.cell(k, 2) == (k < 4 ? "lost" : "tracking"));
    CHECK(table.cell(k, table.column("x_ibug36")).empty() == (k < 4));
  }
  float sum = 0;
  for (int l = 17; l < 68; ++l) {
    const std::string name = "ibug" + std::to_string(l);
    const Vec2 x{table.number(19, table.column("x_" + name)), table.number(19, table.column("y_" + name))};
    sum += length(x - film().truth(name, 15)) / 51;
  }
  CHECK(sum < 6);
}

TEST_CASE("a detection of a face that is gone before ten frames is rejected, and the search goes on") {
  const Visit visit(30, 2, 5);
  const Ran r = run_words(visit.words());
  CAPTURE(r.err);
  CHECK(contains(r.err, "frame 2: face found"));
  CHECK(contains(r.err, "the detection in frame 2 is not confirmed"));
  CHECK(contains(r.err, "no detection was confirmed"));
  CHECK(r.code == 1);
  CHECK_FALSE(visit.has("t.csv"));
}

TEST_CASE("without a face track stops after the allowed frames, names their number, and exits with 1") {
  const Visit visit(8, 0, 0);
  Ran r = run_words(visit.words());
  CHECK(r.code == 1);
  CHECK(contains(r.err, "v.y4m: no face found in 8 frames"));
  r = run_words(visit.words({"--search-frames", "3"}));
  CHECK(r.code == 1);
  CHECK(contains(r.err, "v.y4m: no face found in 3 frames: best similarity"));
  CHECK_FALSE(visit.has("t.csv"));
}

TEST_CASE("options and models that exclude detection are refused") {
  const Visit visit(1, 0, 1);
  CHECK(run_words(visit.words({"--markers", visit.put("m.csv", "landmark,x,y\na,1,2\n")})).code == 2);
  auto words = visit.words({"--search-frames", "3"});
  words[5] = "points.csv";
  CHECK(run_words(words).code == 2);
  const Sequence s;
  words = s.track_words();
  words[5] = "detect";
  const Ran r = run_words(words);
  CAPTURE(r.err);
  CHECK(r.code == 1);
}
