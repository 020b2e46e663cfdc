// The initial state of a track: which file is read as what, and the call of the tracker that it becomes.
#include "host/commands/initial_state.hpp"

#include <doctest/doctest.h>

#include <sstream>

#include "cli_run.hpp"
#include "host/commands/frame_stream.hpp"
#include "host/commands/tracker_limits.hpp"
#include "host/io/failure.hpp"
#include "host/io/owned.hpp"

namespace initial_state_test {

using namespace pliant;
using namespace pliant::host;
using namespace cli_run;

namespace {

constexpr ImageSize kSize{200, 160};

struct Start : Sequence {
  ModelFile file{model};
  std::ostringstream err;
  Initial read(const std::string& start, const InitialOptions& options = {}) {
    return read_initial(start, file, kSize, "v.y4m", options, err);
  }
  /// The message of the failure that `read` ends in; empty if it does not.
  std::string failure(const std::string& start) {
    try {
      read(start);
    } catch (const Failure& failed) {
      return failed.what();
    }
    return "";
  }
};

/// Pose and first landmark after a start, as bytes.
std::string bits_after(Start& s, const Initial& initial, const InitialOptions& options,
                       const TrackerOptions& of_track = {}) {
  TrackerLimits limits;
  limits.width = kSize.width;
  limits.height = kSize.height;
  Owned<Tracker> tracker(s.file.model(), limits);
  FrameStream frames(s.video, false);
  FrameView frame;
  REQUIRE(frames.next(&frame));
  REQUIRE(start_tracker(*tracker, frame, initial, options, of_track, {}) == Status::ok);
  Vec2 x;
  REQUIRE(tracker->landmark(std::size_t{0}, &x) == Status::ok);
  const Pose pose = tracker->result().pose;
  return {std::string(reinterpret_cast<const char*>(&pose), sizeof pose) +
          std::string(reinterpret_cast<const char*>(&x), sizeof x)};
}

}  // namespace

TEST_CASE("points are landmarks for the tracker, points with u,v are fitted here, a fit.json is a state") {
  Start s;
  CHECK(std::holds_alternative<InitialLandmarks>(s.read(s.points)));
  std::istringstream in(read_file(s.points));
  std::string with_uv = "landmark,x,y,u,v\n", line;
  std::getline(in, line);
  while (std::getline(in, line)) with_uv += line + ",,\n";
  with_uv += "cheek,100,80,0.5,0.5\n";
  CHECK(std::holds_alternative<InitialState>(s.read(s.put("uv.csv", with_uv))));
  REQUIRE(run_words({"fit", s.model, "--points", s.points, "--size", "200x160", "-o", s / "fit.json"}).code ==
          0);
  CHECK(std::holds_alternative<InitialState>(s.read(s / "fit.json")));
  const std::string marked = "\xef\xbb\xbf" + read_file(s / "fit.json");
  CHECK(std::holds_alternative<InitialState>(s.read(s.put("marked.json", marked))));
  CHECK(s.err.str().empty());
}

TEST_CASE("a start from points.csv and one from the fit of the same points give the same bits") {
  Start s;
  std::string moved = "landmark,x,y\n";
  std::istringstream in(s.first_points());
  std::string name, x, y;
  std::getline(in, name);
  for (int k = 0; std::getline(in, name, ',') && std::getline(in, x, ',') && std::getline(in, y); ++k)
    moved += name + "," + x + "," + std::to_string(std::stof(y) + (k % 2 == 0 ? 4.0f : -4.0f)) + "\n";
  s.put("moved.csv", moved);
  REQUIRE(run_words({"fit", s.model, "--points", s / "moved.csv", "--size", "200x160", "-o", s / "fit.json"})
              .code == 0);
  const std::string fitted = bits_after(s, s.read(s / "fit.json"), {});
  CHECK(bits_after(s, s.read(s / "moved.csv"), {}) == fitted);
  TrackerOptions without;
  without.keeps_landmark_offsets = false;
  const std::string plain = bits_after(s, s.read(s / "moved.csv"), {}, without);
  CHECK(plain != fitted);
  CHECK(bits_after(s, s.read(s / "fit.json"), {}, without) == plain);
}

TEST_CASE("a known camera is that of the start, from points and from a fit") {
  Start s;
  REQUIRE(run_words({"fit", s.model, "--points", s.points, "--size", "200x160", "-o", s / "fit.json"}).code ==
          0);
  InitialOptions options;
  options.camera = Camera{350, 98, 81, 0.01f, 0, 1};
  const auto state = std::get<InitialState>(s.read(s / "fit.json", options));
  CHECK(state.camera.f == 350);
  CHECK(state.camera.k1 == 0.01f);
  bits_after(s, s.read(s.points, options), options);
}

TEST_CASE("bad points are refused before a frame is read, by file and line") {
  Start s;
  CHECK(contains(s.failure(s.put("p.csv", "landmark,x,y\nibug00,1,2\n")), "p.csv: too few points: 1"));
  CHECK(contains(s.failure(s.put("p.csv", "landmark,x,y\nibug00,1,2\nibug01,3,4\nibug02,5,6\neye,7,8\n")),
                 "p.csv: line 5: landmark 'eye' is not in"));
  std::string one_spot = "landmark,x,y\n";
  for (int k = 0; k < 6; ++k) one_spot += "ibug0" + std::to_string(k) + ",50,50\n";
  CHECK(contains(s.failure(s.put("p.csv", one_spot)), "p.csv: the points do not determine the pose"));
}

TEST_CASE("the profile is the given one, or follows from the width of the frames") {
  const std::vector<Option> options{{"--profile", "s|m|l", ""}};
  const auto limits = [&](const std::vector<std::string>& words, int width) {
    return tracker_limits(Args(words, options, 0), ImageSize{width, 240});
  };
  CHECK(limits({}, 320).patches == profile_m().patches);
  CHECK(limits({}, 479).patches == profile_m().patches);
  CHECK(limits({}, 480).patches == profile_l().patches);
  CHECK(limits({"--profile", "s"}, 640).patches == profile_s().patches);
  CHECK(limits({"--profile", "m"}, 640).patches == profile_m().patches);
  CHECK(limits({"--profile", "m"}, 640).width == 640);
  CHECK_THROWS_AS(limits({"--profile", "x"}, 640), Failure);
}

}  // namespace initial_state_test
