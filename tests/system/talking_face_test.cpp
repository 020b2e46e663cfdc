// A real face: the built-in model fitted to 25 annotated points of frame 0 of the Talking Face sequence and tracked
// through its original frames, against the annotation of every frame. Needs the folder in PLIANT_DATA.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "baked_face.hpp"
#include "host/commands/image_fit.hpp"
#include "host/io/csv.hpp"
#include "host/io/files.hpp"
#include "host/io/image.hpp"
#include "host/io/owned.hpp"
#include "pliant/tracker.hpp"
#include "real_data.hpp"
#include "sanitized.hpp"

namespace talking_face_test {

using namespace pliant;

namespace {

constexpr int kWidth = 720, kHeight = 576;
constexpr std::size_t kFrames = kSanitized ? 30 : 500;

/// The annotation: 68 points a frame, and which of them have an iBUG name.
struct Annotation {
  std::vector<std::vector<Vec2>> points;
  std::map<std::string, std::size_t> ibug;

  explicit Annotation(const std::string& folder) {
    const host::CsvTable table("points", host::read_file(folder + "/points_original.csv"));
    for (std::size_t row = 0; row < kFrames; ++row) {
      points.emplace_back();
      for (std::size_t i = 0; i < 68; ++i)
        points.back().push_back({table.number(row, 1 + 2 * i), table.number(row, 2 + 2 * i)});
    }
    std::string names = host::read_file(folder + "/fgnet68_to_ict.csv");
    for (std::size_t at = 0; at < names.size(); at = names.find('\n', at) + 1) {
      int fgnet, index;
      if (std::sscanf(names.c_str() + at, "%d,%d", &fgnet, &index) == 2) {
        char name[8];
        std::snprintf(name, sizeof name, "ibug%02d", index);
        ibug[name] = static_cast<std::size_t>(fgnet);
      }
      if (names.find('\n', at) == std::string::npos) break;
    }
  }
};

float correlation(const std::vector<float>& a, const std::vector<float>& b) {
  double ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
  const auto n = static_cast<double>(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ma += double(a[i]) / n;
    mb += double(b[i]) / n;
  }
  for (std::size_t i = 0; i < a.size(); ++i) {
    aa += (double(a[i]) - ma) * (double(a[i]) - ma);
    bb += (double(b[i]) - mb) * (double(b[i]) - mb);
    ab += (double(a[i]) - ma) * (double(b[i]) - mb);
  }
  return static_cast<float>(ab / std::sqrt(aa * bb));
}

host::Image frame_picture(const std::string& folder, std::size_t k) {
  char name[64];
  std::snprintf(name, sizeof name, "/frames/franck_%05d.jpg", static_cast<int>(k));
  return host::to_grey(host::read_image(folder + name));
}

FrameView view_on(const host::Image& grey, std::size_t k) {
  return {grey.pixels.data(),           kWidth, kHeight, kWidth, 1, static_cast<std::int64_t>(k) * 40'000'000,
          static_cast<std::uint32_t>(k)};
}

struct Result {
  float landmark_nme = 0, marker_nme = 0,
        mouth_correlation = 0;  // percent of the outer eye corners' distance
  std::size_t tracking = 0;
};

Result track(const std::string& folder, const Annotation& truth, bool with_markers) {
  const host::ModelFile file(baked_face_path());

  std::vector<host::NamedPoint> points;
  for (const auto& [name, index] : truth.ibug) points.push_back({name, truth.points[0][index], name});
  host::FitSetup setup;
  setup.size = {kWidth, kHeight};
  const host::FitFile fit = host::fit_to_points(file, "points", points, setup);
  std::vector<float> q(file.model().parameters().count, 0.0f);
  host::apply(fit.parameters, "fit", file.model(), q.data());

  std::vector<std::size_t> markers;
  std::vector<Vec2> marker_x;
  for (std::size_t i = 15; with_markers && i < 68; ++i)
    if (i != 31 && i != 36) {
      markers.push_back(i);
      marker_x.push_back(truth.points[0][i]);
    }
  TrackerLimits limits;
  limits.width = kWidth;
  limits.height = kHeight;
  limits.markers = static_cast<std::uint16_t>(markers.size());
  host::Owned<Tracker> tracker(file.model(), limits);
  Result result;
  std::vector<float> mouth, mouth_truth;
  double eye_distance = 0, landmark_sum = 0, marker_sum = 0;
  for (std::size_t k = 0; k < kFrames; ++k) {
    const host::Image grey = frame_picture(folder, k);
    const FrameView frame = view_on(grey, k);
    FrameResult r = tracker->result();
    if (k == 0)
      REQUIRE(tracker->start_from_pose(frame, fit.camera, fit.pose, q.data(), {},
                                       {marker_x.data(), marker_x.size()}) == Status::ok);
    else
      REQUIRE(tracker->update(frame, &r) == Status::ok);
    result.tracking += tracker->result().state == TrackState::tracking;
    const auto at = [&](const std::string& landmark) {
      const Landmark& l = file.model().landmarks()[file.model().find_landmark(landmark.c_str())];
      Vec2 x;
      REQUIRE(tracker->estimator().project({l.u, l.v}, &x));
      return x;
    };
    const auto& t = truth.points[k];
    eye_distance += double(length(t[27] - t[32]));
    for (const auto& [landmark, index] : truth.ibug)
      landmark_sum += double(length(at(landmark) - t[index])) / double(truth.ibug.size());
    for (std::size_t m = 0; m < markers.size(); ++m) {
      Vec2 x;
      REQUIRE(tracker->marker(m, &x));
      marker_sum += double(length(x - t[markers[m]])) / double(markers.size());
    }
    mouth.push_back(length(at("ibug51") - at("ibug57")));
    mouth_truth.push_back(length(t[truth.ibug.at("ibug51")] - t[truth.ibug.at("ibug57")]));
  }
  result.landmark_nme = static_cast<float>(100 * landmark_sum / eye_distance);
  result.marker_nme = static_cast<float>(100 * marker_sum / eye_distance);
  result.mouth_correlation = correlation(mouth, mouth_truth);
  return result;
}

std::string data_folder() {
  const char* data = require_data();
  return data == nullptr ? "" : std::string(data) + "/franck";
}

}  // namespace

TEST_CASE("a talking man is tracked: landmarks and mouth") {
  const std::string folder = data_folder();
  if (folder.empty()) return;
  const Result r = track(folder, Annotation(folder), false);
  MESSAGE("landmarks " << r.landmark_nme << " %, mouth height correlates " << r.mouth_correlation);
  CHECK(r.tracking == kFrames);
  // Measured 3.01 % and 0.979. The track has the same bits everywhere; the margin is for the decoder of the pictures.
  CHECK(r.landmark_nme < 3.2f);
  if (!kSanitized) CHECK(r.mouth_correlation > 0.95f);  // thirty frames are too few for a correlation
}

TEST_CASE("51 points of his face are tracked without templates") {
  const std::string folder = data_folder();
  if (folder.empty()) return;
  const Result r = track(folder, Annotation(folder), true);
  MESSAGE("markers " << r.marker_nme << " %");
  CHECK(r.tracking == kFrames);
  CHECK(r.marker_nme < 2.85f);  // measured 2.66 %; the margin as above
}

}  // namespace talking_face_test
