#include "host/bench/detection_films.hpp"

#include <algorithm>

#include "host/bench/detection_run.hpp"
#include "host/bench/still_film.hpp"
#include "host/render/scene.hpp"

namespace pliant::host {

namespace {

constexpr std::size_t kFilmFrames = 60;  // two seconds

/// A room of 480 x 360 pixels, with or without a face in it.
struct Room {
  Image empty;
  Room(const learn::OtherPictures& others, std::size_t k) {
    learn::SampleRandom random(7, k);
    empty = others.count() > 0 ? others.crop(480, 360, random)
                               : make_background(480, 360, static_cast<std::uint32_t>(k + 1));
  }
  Image with(const AnnotatedFace& face, float scale, Vec2 corner) const {
    Image out = empty;
    lay_over(out, resized(face.picture, scale), static_cast<int>(corner.x), static_cast<int>(corner.y), 12);
    return out;
  }
};

/// Where a face is in a room.
struct Place {
  float scale;
  Vec2 corner;  ///< of the portrait, whole pixels
  NamedLandmarks truth(const AnnotatedFace& face) const {
    return moved(face.landmarks, scale, corner + Vec2{0.5f * scale - 0.5f, 0.5f * scale - 0.5f});
  }
};

/// The face is at one place for a second, gone for a second, and back at another for a second.
void leaves_and_returns(const ModelFile& file, const std::vector<AnnotatedFace>& faces,
                        const learn::OtherPictures& others, const char* name, const Place& before,
                        const Place& after, DetectionReport& report) {
  constexpr std::size_t kGone = 30, kBack = 60, kEnd = 90;
  std::vector<double> lost_after;
  std::size_t never_lost = 0, started = 0;
  DetectionErrors back, back_in_15;
  for (std::size_t n = 0; n < faces.size(); ++n) {
    const Room room(others, n);
    DetectionRun run(file, 480, 360);
    int lost = -1, found = -1;
    double error = kUnknown;
    bool is_started = false;
    for (std::size_t k = 0; k < kEnd; ++k) {
      Image frame = k < kGone   ? room.with(faces[n], before.scale, before.corner)
                    : k < kBack ? room.empty
                                : room.with(faces[n], after.scale, after.corner);
      add_grey_noise(frame, 2, static_cast<std::uint32_t>(1 + n * kEnd + k));
      run.update(frame_of(frame, k));
      if (k == kGone - 1) is_started = run.has_track();
      if (k >= kGone && k < kBack && lost < 0 && !run.has_track()) lost = static_cast<int>(k - kGone);
      if (k >= kBack && run.has_track()) {
        error = landmark_error(run.landmarks(), after.truth(faces[n]));
        if (found < 0 && error < kRightError) found = static_cast<int>(k - kBack);
      }
    }
    report.add(name, faces[n].name, found, error, kUnknown, static_cast<double>(lost));
    if (!is_started) continue;
    ++started;
    if (lost < 0)
      ++never_lost;
    else
      lost_after.push_back(lost);
    back.add(found >= 0, error, static_cast<std::size_t>(std::max(found, 0)));
    back_in_15.add(found >= 0 && found < 15, error, static_cast<std::size_t>(std::max(found, 0)));
  }
  report.rows(name, "started", static_cast<double>(started));
  report.rows(name, "never_lost", static_cast<double>(never_lost));
  report.rows(name, "lost_frame_at_90", lost_after.empty() ? kUnknown : quantile(lost_after, 0.9));
  back_in_15.print(report.rows, std::string(name) + "_in_15_frames");
  back.print(report.rows, name);
}

}  // namespace

void measure_films(const ModelFile& file, const std::vector<AnnotatedFace>& faces, DetectionReport& report) {
  DetectionErrors first, last;
  std::uint32_t seed = 0;
  for (const AnnotatedFace& face : faces) {
    StillFilmOptions options;
    options.seed = ++seed;
    StillFilm film(face.picture, options);
    DetectionRun run(file, face.picture.width, face.picture.height);
    int start = -1;
    double error = kUnknown, estimate = kUnknown;
    for (std::size_t k = 0; k < kFilmFrames; ++k) {
      run.update(film.frame(k));
      if (!run.has_track()) continue;
      error = landmark_error(run.landmarks(), moved(face.landmarks, 1, film.shift(k)));
      estimate = static_cast<double>(run.result().landmark_error);
      if (start < 0) first.add(true, error, k);
      if (start < 0) start = static_cast<int>(k);
    }
    if (start < 0) first.add(false, 0, 0);
    report.add("film", face.name, start, error, estimate);
    last.add(run.has_track(), error, static_cast<std::size_t>(std::max(start, 0)));
  }
  first.print(report.rows, "portraits_film_start");
  last.print(report.rows, "portraits_film_after_2_s");
}

void measure_returns(const ModelFile& file, const std::vector<AnnotatedFace>& faces,
                     const learn::OtherPictures& others, DetectionReport& report) {
  leaves_and_returns(file, faces, others, "returns_at_half", {0.8f, {10, 20}}, {0.4f, {300, 180}}, report);
  leaves_and_returns(file, faces, others, "returns_at_twice", {0.4f, {330, 30}}, {0.8f, {20, 80}}, report);
}

void measure_rolled(const ModelFile& file, const std::vector<AnnotatedFace>& faces,
                    const learn::OtherPictures& others, DetectionReport& report) {
  constexpr float kTurn = 6.2831853f;
  DetectionErrors first;
  for (std::size_t n = 0; n < faces.size(); ++n) {
    const Place place{0.6f, {150, 80}};
    const float roll = kTurn * (static_cast<float>(n) + 0.5f) / static_cast<float>(faces.size());
    const Image picture = turned(Room(others, n).with(faces[n], place.scale, place.corner), roll);
    const NamedLandmarks truth = turned(place.truth(faces[n]), roll, {239.5f, 179.5f});
    DetectionRun run(file, 480, 360);
    int start = -1;
    double error = kUnknown;
    for (std::size_t k = 0; k < kFilmFrames && start < 0; ++k) {
      Image frame = picture;
      add_grey_noise(frame, 2, static_cast<std::uint32_t>(1 + n * kFilmFrames + k));
      run.update(frame_of(frame, k));
      if (!run.has_track()) continue;
      start = static_cast<int>(k);
      error = landmark_error(run.landmarks(), truth);
    }
    report.add("rolled", faces[n].name, start, error, static_cast<double>(run.result().landmark_error));
    first.add(start >= 0, error, static_cast<std::size_t>(std::max(start, 0)));
  }
  first.print(report.rows, "portraits_rolled");
}

void measure_pushed(const ModelFile& file, const std::vector<AnnotatedFace>& faces,
                    const learn::OtherPictures& others, DetectionReport& report) {
  std::vector<double> lost_after;
  std::size_t cases = 0, never_lost = 0;
  for (std::size_t n = 0; n < faces.size(); ++n) {
    const Room room(others, n);
    DetectionRun run(file, 480, 360);
    const Image with = room.with(faces[n], 0.6f, {20, 20});
    std::size_t now = 0;
    while (!run.has_track() && now < kFilmFrames) run.update(frame_of(with, now++));
    if (!run.has_track()) continue;
    Pose pose = run.tracker().result().pose;
    const Camera camera = run.tracker().camera();
    pose.t.x += 200 * pose.t.z / camera.f;
    const std::vector<float> q(run.tracker().parameters().begin(), run.tracker().parameters().end());
    if (run.tracker().start_from_pose(frame_of(with, now++), camera, pose, q.data()) != Status::ok) continue;
    ++cases;
    int lost = -1;
    for (std::size_t k = 0; k < kFilmFrames / 2 && lost < 0; ++k) {
      Image frame = with;
      add_grey_noise(frame, 2, static_cast<std::uint32_t>(1 + n * 60 + k));
      run.update(frame_of(frame, now++));
      const bool is_right =
          run.has_track() && landmark_error(run.landmarks(), Place{0.6f, {20, 20}}.truth(faces[n])) < 0.2;
      if (!run.has_track() || is_right) lost = static_cast<int>(k);
    }
    report.add("pushed", faces[n].name, lost, kUnknown, kUnknown);
    if (lost < 0)
      ++never_lost;
    else
      lost_after.push_back(lost);
  }
  report.rows("pushed", "cases", static_cast<double>(cases));
  report.rows("pushed", "never_lost", static_cast<double>(never_lost));
  if (!lost_after.empty()) report.rows("pushed", "lost_frame_at_90", quantile(lost_after, 0.9));
}

void measure_without_faces(const ModelFile& file, const learn::OtherPictures& others, std::size_t count,
                           DetectionReport& report) {
  std::size_t shown = 0, starts = 0, kept = 0, frames = 0;
  double milliseconds = 0;
  for (std::size_t n = 0; n < count; ++n) {
    const Image picture = shrunk_to(others.picture(n), 640, 480);
    if (picture.width < 64 || picture.height < 64) continue;
    ++shown;
    StillFilmOptions options;
    options.seed = static_cast<std::uint32_t>(n + 1);
    StillFilm film(picture, options);
    DetectionRun run(file, picture.width, picture.height);
    int start = -1;
    for (std::size_t k = 0; k < kFilmFrames; ++k) {
      const FrameView frame = film.frame(k);
      const double before = process_ms();
      run.update(frame);
      milliseconds += process_ms() - before;
      ++frames;
      if (run.has_track() && start < 0) start = static_cast<int>(k);
    }
    if (start < 0) continue;
    ++starts;
    kept += run.has_track() ? 1 : 0;
    report.add("without_face", std::to_string(n), start, kUnknown,
               static_cast<double>(run.result().landmark_error));
  }
  report.rows("without_faces", "pictures", static_cast<double>(shown));
  report.rows("without_faces", "false_starts", static_cast<double>(starts));
  report.rows("without_faces", "kept_to_the_end", static_cast<double>(kept));
  report.rows("without_faces", "mean_ms_a_frame",
              frames == 0 ? 0 : milliseconds / static_cast<double>(frames));
}

}  // namespace pliant::host
