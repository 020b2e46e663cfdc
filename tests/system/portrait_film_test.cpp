// Films made of a portrait, with the learnt tables of the built-in face: a start that a cup covers, and light that changes.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "host/bench/annotated_faces.hpp"
#include "host/bench/still_film.hpp"
#include "host/commands/face_finder.hpp"
#include "host/io/files.hpp"
#include "host/io/points_file.hpp"
#include "model_builder.hpp"
#include "pliant/tracker.hpp"

namespace portrait_film_test {

using namespace pliant;
using namespace pliant::host;

namespace {

const std::string kAstronaut = PLIANT_FIXTURES "/astronaut";
constexpr float kScale = 0.5f;
constexpr std::size_t kCovered = 20, kFrames = 110;

/// The photograph with a cup before mouth and chin. \param eyes  distance of the outer eye corners, px.
Image with_cup(const Image& picture, const NamedLandmarks& at) {
  Image covered = picture;
  const float eyes = eye_distance(at);
  const Vec2 mouth = 0.5f * (at.at("ibug48") + at.at("ibug54"));
  for (int j = static_cast<int>(mouth.y - 0.2f * eyes); j < static_cast<int>(mouth.y + 0.9f * eyes); ++j)
    for (int i = static_cast<int>(mouth.x - 0.4f * eyes); i < static_cast<int>(mouth.x + 0.3f * eyes); ++i)
      if (covered.contains(i, j)) *covered.at(i, j) = static_cast<std::uint8_t>(120 + (i + j) % 7);
  return covered;
}

const ModelFile& face() {
  static const ModelFile* file = new ModelFile(PLIANT_DETECTING_FACE);
  return *file;
}

TrackerLimits limits_for(const Image& picture, TrackerLimits limits) {
  limits.width = static_cast<std::uint16_t>(picture.width);
  limits.height = static_cast<std::uint16_t>(picture.height);
  return limits;
}

NamedLandmarks landmarks_of(Tracker& tracker) {
  NamedLandmarks found;
  for (std::size_t l = 0; l < face().model().landmarks().count; ++l)
    REQUIRE(tracker.landmark(l, &found[face().model().landmarks()[l].name]) == Status::ok);
  return found;
}

/// Of a tracker, against the truth of frame 0; \param shift  of the frame. Fraction of the eyes' distance.
double error_of(Tracker& tracker, const NamedLandmarks& truth, Vec2 shift) {
  return landmark_error(landmarks_of(tracker), moved(truth, 1, shift));
}

/// Landmark error of the last frame, of a tracker that starts by itself.
double error_at_the_end(const TrackerLimits& limits, const Image& picture, const Image& covered,
                        const NamedLandmarks& truth) {
  InArena<Tracker> tracker(face().model(), limits_for(picture, limits));
  StillFilm before(covered), after(picture);
  for (std::size_t k = 0; k < kFrames; ++k) {
    FrameResult result;
    REQUIRE(tracker->update((k < kCovered ? before : after).frame(k), &result) == Status::ok);
    CHECK(result.state != TrackState::lost);
  }
  return error_of(tracker.object, truth, after.shift(kFrames - 1));
}

struct Portrait {
  Image picture;
  NamedLandmarks truth;
};

Portrait astronaut() {
  Portrait p{resized(to_grey(read_image(kAstronaut + "/astronaut.png")), kScale), {}};
  for (const host::NamedPoint& point : read_points(kAstronaut + "/points.csv")) p.truth[point.name] = point.x;
  p.truth = moved(p.truth, kScale, {0, 0});
  return p;
}

/// 320 x 240 pixels of the photograph, with the face in their middle: a turned face must be larger than an upright one.
Portrait close_up() {
  constexpr int kLeft = 65, kTop = 10;
  const Image all = to_grey(read_image(kAstronaut + "/astronaut.png"));
  Portrait p{Image(320, 240, 1), {}};
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 320; ++x) *p.picture.at(x, y) = *all.at(kLeft + x, kTop + y);
  for (const host::NamedPoint& point : read_points(kAstronaut + "/points.csv"))
    p.truth[point.name] = point.x - Vec2{kLeft, kTop};
  return p;
}

/// As a camera shows it whose pixels are lower than wide by `aspect`.
Image stretched_down(const Image& grey, float aspect) {
  Image out(grey.width, static_cast<int>(aspect * static_cast<float>(grey.height)), 1);
  for (int y = 0; y < out.height; ++y) {
    const float at =
        clamp((static_cast<float>(y) + 0.5f) / aspect - 0.5f, 0, static_cast<float>(grey.height - 1));
    const int j = static_cast<int>(at), next = std::min(j + 1, grey.height - 1);
    const float b = at - static_cast<float>(j);
    for (int x = 0; x < out.width; ++x)
      *out.at(x, y) = static_cast<std::uint8_t>((1 - b) * *grey.at(x, j) + b * *grey.at(x, next) + 0.5f);
  }
  return out;
}

/// With eyes that look another way: inside an eye the picture moves by up to 0.06 of the eyes' distance.
Image looking_aside(const Image& grey, const NamedLandmarks& at) {
  Image out = grey;
  const float most = 0.06f * static_cast<float>(eye_distance(at)), radius = 2 * most;
  const Vec2 eyes[] = {0.5f * (at.at("ibug36") + at.at("ibug39")),
                       0.5f * (at.at("ibug42") + at.at("ibug45"))};
  for (const Vec2 middle : eyes)
    for (int y = static_cast<int>(middle.y - radius); y <= static_cast<int>(middle.y + radius); ++y)
      for (int x = static_cast<int>(middle.x - 2 * radius); x <= static_cast<int>(middle.x + 2 * radius);
           ++x) {
        const float u = (static_cast<float>(x) - middle.x) / (2 * radius),
                    v = (static_cast<float>(y) - middle.y) / radius;
        const float from = static_cast<float>(x) - most * std::max(0.0f, 1 - u * u - v * v);
        const int j = static_cast<int>(from);
        const float b = from - static_cast<float>(j);
        *out.at(x, y) = static_cast<std::uint8_t>((1 - b) * *grey.at(j, y) + b * *grey.at(j + 1, y) + 0.5f);
      }
  return out;
}

/// What is tracked while the exposure hunts by 1.8 stops each way in 35 frames.
struct Exposed {
  int tracked = 0, matched = 0;  // matched: with at least a quarter of the templates
  double error = 0;  // the largest of tracked frames, as landmark_error
};

Exposed track_exposed(const TrackerLimits& limits) {
  const auto [picture, truth] = astronaut();
  InArena<Tracker> tracker(face().model(), limits_for(picture, limits));
  StillFilm film(picture);
  const int templates = limits.patches;
  Exposed out;
  for (std::size_t k = 0; k < kFrames; ++k) {
    FrameView frame = film.frame(k);
    std::vector<std::uint8_t> pixels(frame.stride_bytes * static_cast<std::size_t>(frame.height));
    const double gain = std::exp2(1.8 * std::sin(2 * 3.14159 * static_cast<double>(k) / 35));
    for (std::size_t i = 0; i < pixels.size(); ++i)
      pixels[i] = static_cast<std::uint8_t>(std::min(255.0, gain * frame.data[i]));
    frame.data = pixels.data();
    FrameResult result;
    REQUIRE(tracker->update(frame, &result) == Status::ok);
    if (result.state != TrackState::tracking) continue;
    ++out.tracked;
    out.matched += 4 * result.inliers >= templates;
    out.error = std::max(out.error, error_of(tracker.object, truth, film.shift(k)));
  }
  return out;
}

/// The picture as a camera sees it that has moved: its border goes on.
Image shaken(const Image& grey, int x, int y) {
  Image out = grey;
  for (int j = 0; j < out.height; ++j)
    for (int i = 0; i < out.width; ++i)
      *out.at(i, j) = *grey.at(std::clamp(i - x, 0, grey.width - 1), std::clamp(j - y, 0, grey.height - 1));
  return out;
}

}  // namespace

TEST_CASE("a face that a cup covered at the start is aligned anew once the cup is gone") {
  const auto [picture, truth] = astronaut();
  const Image covered = with_cup(picture, truth);
  const double free = error_at_the_end({}, picture, picture, truth),
               looking = error_at_the_end({}, picture, covered, truth),
               as_started = error_at_the_end(without_second_look({}), picture, covered, truth);
  MESSAGE("free " << free << ", covered at first " << looking << ", without a second look " << as_started);
  CHECK(looking < 1.1 * free + 0.002);
  CHECK(as_started > 1.3 * free);
}

TEST_CASE("while the exposure hunts, a face is tracked in many frames that its templates do not survive") {
  for (const TrackerLimits& limits : {TrackerLimits{}, without_second_look({}), profile_s()}) {
    const Exposed seen = track_exposed(limits);
    MESSAGE("tracked " << seen.tracked << ", to " << seen.error << "; with templates " << seen.matched);
    CHECK(seen.tracked > seen.matched + 20);
    CHECK(seen.error < 0.07);
  }
}

TEST_CASE("a face in a fifth of the light, with noise of 9 grey levels, is tracked with each profile") {
  auto [picture, truth] = close_up();
  for (std::uint8_t& p : picture.pixels) p = static_cast<std::uint8_t>(8 + p / 5);
  StillFilmOptions noisy;
  noisy.noise_grey = 9;
  for (const TrackerLimits& limits : {TrackerLimits{}, profile_s()}) {
    InArena<Tracker> tracker(face().model(), limits_for(picture, limits));
    StillFilm film(picture, noisy);
    constexpr std::size_t kLast = 60;
    std::size_t tracked = 0;
    double worst = 0;
    for (std::size_t k = 0; k < kLast; ++k) {
      FrameResult result;
      REQUIRE(tracker->update(film.frame(k), &result) == Status::ok);
      if (result.state != TrackState::tracking) continue;
      ++tracked;
      worst = std::max(worst, error_of(tracker.object, truth, film.shift(k)));
    }
    MESSAGE("tracked " << tracked << ", to " << worst);
    CHECK(tracked >= 45);
    CHECK(worst < 0.1);
  }
}

TEST_CASE(
    "with profile S a face is found whose search and alignment are spread over frames of a camera that "
    "shakes") {
  const auto [picture, truth] = close_up();
  InArena<Tracker> tracker(face().model(),
                           limits_for(picture, with_detection(profile_s(), kUprightFaceDetection)));
  constexpr int kAside[] = {0, 8, -1, 7, 0, -8, 1, -7}, kDown[] = {0, 5, 9, 2, -4, 3, -5, 4};  // px
  std::size_t k = 0;
  constexpr std::size_t kAlone = 12;  // frames in which the same camera at rest has found it
  for (FrameResult result; k < kAlone && !tracker->is_started(); ++k) {
    const Image seen = shaken(picture, kAside[k % 8], kDown[k % 8]);
    REQUIRE(tracker->update(frame_of(seen, k), &result) == Status::ok);
  }
  REQUIRE(tracker->is_started());
  const std::size_t last = (k - 1) % 8;
  const Vec2 shift{static_cast<float>(kAside[last]), static_cast<float>(kDown[last])};
  CHECK(error_of(tracker.object, truth, shift) < 0.06);  // as a portrait counts as right
}

TEST_CASE("a face is found at any roll, and again at that roll after it was hidden") {
  const auto [picture, truth] = close_up();
  const Vec2 middle =
      0.5f * Vec2{static_cast<float>(picture.width - 1), static_cast<float>(picture.height - 1)};
  const Image black(picture.width, picture.height, 1);
  for (int degrees = 0; degrees < 360; degrees += 20) {
    CAPTURE(degrees);
    const float roll = 0.01745329f * static_cast<float>(degrees);
    const Image rolled = turned(picture, roll);
    const NamedLandmarks at = turned(truth, roll, middle);
    InArena<Tracker> tracker(face().model(), limits_for(picture, {}));
    FrameResult result;
    std::size_t k = 0;
    const auto show = [&](const Image& image) {
      REQUIRE(tracker->update(frame_of(image, k++), &result) == Status::ok);
      return result.state != TrackState::lost && tracker->is_started();
    };
    constexpr std::size_t kRound = 21, kHidden = 30;  // searches until each turn had one; frames
    while (k < kRound && !show(rolled)) {
    }
    CHECK(tracker->is_started());
    CHECK(error_of(tracker.object, at, {0, 0}) < 0.06);
    for (std::size_t n = 0; n < kHidden; ++n) (void)show(black);
    CHECK_FALSE(tracker->is_started());
    const std::size_t hidden = k;
    while (k < hidden + kRound && !show(rolled)) {
    }
    CHECK(k - hidden <= 3);
    CHECK(error_of(tracker.object, at, {0, 0}) < 0.06);
  }
}

TEST_CASE("pixels that are not square are told by the camera, and change neither landmarks nor readings") {
  const auto [picture, truth] = close_up();
  struct Found {
    double error;
    float blink;
    Vec3 gaze;
  };
  const auto found_at = [&, &photograph = picture, &annotated = truth](float aspect) {
    const Image stretched = stretched_down(photograph, aspect);
    Camera camera = centred_camera(stretched.width, stretched.height, 700);
    camera.aspect = aspect;
    StartOptions start;
    start.camera = &camera;
    InArena<Tracker> tracker(face().model(), limits_for(stretched, {}));
    REQUIRE(tracker->start_by_detection(start) == Status::ok);
    FrameResult result;
    for (std::size_t k = 0; k < 3; ++k)
      REQUIRE(tracker->update(frame_of(stretched, k), &result) == Status::ok);
    CHECK(FaceFinder(face()).find(stretched, "picture", kLeastFaceScore, camera).size() == 1);
    NamedLandmarks seen = landmarks_of(tracker.object);
    for (auto& [name, x] : seen) x.y = (x.y + 0.5f) / aspect - 0.5f;
    Found found{landmark_error(seen, annotated), 0, result.gaze};
    REQUIRE(tracker->parameter("eyeBlinkLeft", &found.blink) == Status::ok);
    return found;
  };
  const Found plain = found_at(1);
  for (const float aspect : {0.5f, 0.75f, 1.25f, 2.0f}) {
    CAPTURE(aspect);
    const Found found = found_at(aspect);
    MESSAGE("landmark error " << found.error << ", with square pixels " << plain.error);
    CHECK(found.error < 1.2 * plain.error + 0.003);
    CHECK(std::abs(found.blink - plain.blink) < 0.15f);
    CHECK(length(found.gaze - plain.gaze) < 0.1f);
  }
}

TEST_CASE("eyes that look another way are followed in about the same time at any frame rate") {
  const auto [picture, truth] = close_up();
  const Image aside = looking_aside(picture, truth);
  // How far the gaze goes in the first 40 ms.
  const auto followed = [&, &ahead = picture](int frames_a_second, std::int64_t most_ns) {
    InArena<Tracker> tracker(face().model(), limits_for(ahead, {}));
    const int turn = frames_a_second, last = turn + frames_a_second / 25;
    FrameResult result;
    Vec3 before;
    for (int k = 0; k < last; ++k) {
      FrameView frame = frame_of(k < turn ? ahead : aside, static_cast<std::size_t>(k));
      frame.time_ns = std::min(k * std::int64_t{1'000'000'000} / frames_a_second, most_ns);
      if (k == turn) before = result.gaze;
      REQUIRE(tracker->update(frame, &result) == Status::ok);
    }
    return length(result.gaze - before);
  };
  constexpr std::int64_t kForEver = 1'000'000'000'000;
  const float usual = followed(25, kForEver);
  CHECK(usual > 0.2f);
  for (const int rate : {50, 100}) {
    CAPTURE(rate);
    CHECK(std::abs(followed(rate, kForEver) - usual) < 0.25f * usual);
  }
  CHECK(std::abs(followed(25, 0) - usual) < 0.05f * usual);  // a clock that stands still
}

}  // namespace portrait_film_test
