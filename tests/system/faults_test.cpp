// A film in which something goes wrong (host/bench/film_faults.hpp): a tracker that finds its face by itself does not say that
// it tracks where it is wrong, and is right again soon. The same on recorded films: `pliant bench faults`.
#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "face_film.hpp"
#include "host/bench/fault_run.hpp"
#include "host/bench/film_faults.hpp"
#include "sanitized.hpp"

namespace faults_test {

using namespace pliant;

namespace {

constexpr int kWidth = 192, kHeight = 144;

std::vector<host::Image> frames() {
  const FaceFilm film(kWidth, kHeight, host::kClipFrames, [](float s, Pose& pose, auto& q) {
    const float wave = std::sin(12 * s);
    pose.q = exp_rotation({0.03f * wave, 0.25f * wave, 0.04f * std::cos(9 * s)});
    pose.t = pose.t + Vec3{12 * wave, 5 * s, 0};
    FaceFilm::set(q, "jawOpen", 0.1f * (1 - std::cos(25 * s)) / 2);
  });
  std::vector<host::Image> out;
  for (std::size_t k = 0; k < host::kClipFrames; ++k) out.push_back(host::image_of(film.view(k)));
  return out;
}

const host::ModelFile& face() {
  static const host::ModelFile* file = new host::ModelFile(PLIANT_DETECTING_FACE);
  return *file;
}

/// The film with its truth.
const host::JudgedClip& judged() {
  static const host::JudgedClip* one = [] {
    auto* const clip = new host::JudgedClip;
    REQUIRE(host::judge(face(), {}, frames(), clip));
    return clip;
  }();
  return *one;
}

/// Frames of the fault that this film is tracked through, at least, percent. What shows the face less well may be degraded.
double least_tracking(const std::string& fault) {
  for (const char* hard :
       {"light at 3", "gamma 0.5", "noise of 25", "blocks without", "half of the face", "jump by 40"})
    if (fault.find(hard) == 0) return 0;
  return 95;
}

/// Frames after the fault in which the face must be right. At 2.5 times its size it is larger than these pictures.
double most_frames(const std::string& fault) {
  return fault.find("2.5 times") != std::string::npos ? 30 : 10;
}

}  // namespace

TEST_CASE(
    "whatever goes wrong, frames in state tracking are right, and the face is right within ten frames "
    "after") {
  const host::JudgedClip& clip = judged();
  std::size_t n = 0;
  for (const host::FilmFault& fault : host::film_faults()) {
    if (kSanitized && n++ % 6 != 0) continue;
    const std::string name = fault.name;
    CAPTURE(name);
    host::FaultCounts counts;
    host::play(face(), clip, fault, &counts);
    CHECK(counts.wrong == 0);
    CHECK(counts.never == 0);
    CHECK(counts.most_work > 0.1);
    CHECK(counts.most_work <= 1);
    REQUIRE(counts.back.size() == 1);
    CHECK(counts.back[0] <= most_frames(name));
    if (counts.with_face > 0) CHECK(100 * counts.tracking >= least_tracking(name) * counts.with_face);
  }
}

TEST_CASE(
    "a fault that shows nothing else leaves the film as it is, and a film without a face gives no truth") {
  const host::JudgedClip& clip = judged();
  const host::FilmFault& none = host::film_faults()[0];
  CHECK(none.make(clip.clip, host::kFaultBegins, none.value).picture.pixels ==
        clip.clip.frames[host::kFaultBegins].pixels);
  const std::vector<host::Image> empty(20, host::Image(kWidth, kHeight, 1, 100));
  host::JudgedClip none_judged;
  CHECK(!host::judge(face(), {}, empty, &none_judged));
}

}  // namespace faults_test
