// `pliant bench detection`.
#include "host/bench/detection.hpp"

#include <algorithm>

#include "host/bench/detection_films.hpp"
#include "host/bench/detection_run.hpp"
#include "host/bench/recorded_detection.hpp"
#include "host/bench/still_film.hpp"
#include "host/commands/face_finder.hpp"
#include "host/io/failure.hpp"

namespace pliant::host {

namespace {

NamedLandmarks named(const Model& model, const std::vector<Vec2>& x) {
  NamedLandmarks out;
  for (std::size_t k = 0; k < x.size(); ++k) out[model.landmarks()[k].name] = x[k];
  return out;
}

void still_pictures(const ModelFile& file, const std::vector<AnnotatedFace>& faces, DetectionReport& report) {
  FaceFinder finder(file);
  DetectionErrors errors;
  std::size_t false_faces = 0;
  for (const AnnotatedFace& face : faces) {
    const auto found = finder.find(face.picture, face.name, 0.5f);
    const double error =
        found.empty() ? kUnknown : landmark_error(named(file.model(), found[0].landmarks), face.landmarks);
    report.add("still", face.name, found.empty() ? -1 : 0, error,
               found.empty() ? kUnknown : static_cast<double>(found[0].aligned.landmark_error));
    errors.add(!found.empty(), error, 0);
    false_faces += found.size() > 1 ? found.size() - 1 : 0;
  }
  errors.print(report.rows, "portraits_still");
  report.rows("portraits_still", "second_faces", static_cast<double>(false_faces));
}

/// The five landmarks of common detectors, from the annotation. Empty: one of them is not annotated.
std::vector<pliant::NamedPoint> five_points(const NamedLandmarks& truth) {
  constexpr struct {
    const char *name, *a, *b;
  } kFive[] = {{"eye_right", "ibug36", "ibug39"},
               {"eye_left", "ibug42", "ibug45"},
               {"nose_tip", "ibug30", "ibug30"},
               {"mouth_right", "ibug48", "ibug48"},
               {"mouth_left", "ibug54", "ibug54"}};
  std::vector<pliant::NamedPoint> points;
  for (const auto& five : kFive) {
    const auto a = truth.find(five.a), b = truth.find(five.b);
    if (a == truth.end() || b == truth.end()) return {};
    points.push_back({five.name, 0.5f * (a->second + b->second)});
  }
  return points;
}

void starts_from_five_points(const ModelFile& file, const std::vector<AnnotatedFace>& faces,
                             DetectionReport& report) {
  DetectionErrors errors;
  for (const AnnotatedFace& face : faces) {
    const auto points = five_points(face.landmarks);
    if (points.empty()) continue;
    DetectionRun run(file, face.picture.width, face.picture.height);
    const Status status =
        run.tracker().start_from_landmarks(frame_of(face.picture, 0), {points.data(), points.size()});
    const double error = status == Status::ok ? landmark_error(run.landmarks(), face.landmarks) : kUnknown;
    report.add("five", face.name, status == Status::ok ? 0 : -1, error,
               static_cast<double>(run.tracker().result().landmark_error));
    errors.add(status == Status::ok, error, 0);
  }
  errors.print(report.rows, "portraits_five_points");
}

/// Processor time of a call, mean of many: other programs on the machine do not count.
template <class Call>
double mean_process_ms(Call&& call) {
  constexpr int kCalls = 40;
  call();
  const double before = process_ms();
  for (int k = 0; k < kCalls; ++k) call();
  return (process_ms() - before) / kCalls;
}

/// Search of a whole frame of 320 x 240, and alignment.
void times(const ModelFile& file, const Image& picture, DetectionReport& report) {
  const Image frame = shrunk_to(picture, 320, 240);
  FaceDetectorLimits limits;
  Owned<FaceDetector> detector(file.model().detector(), limits);
  Image full(320, 240, 1, 96);
  lay_over(full, frame, (320 - frame.width) / 2, 0, 4);
  DetectedFace room[16];
  std::size_t count = 0;
  const auto search = [&] { require(detector->find(frame_of(full, 0), {room, 16}, &count), "search"); };
  report.rows("time_320x240", "search_ms", mean_process_ms(search));
  if (count == 0) return;
  FaceFinder finder(file);
  report.rows("time_320x240", "align_ms", mean_process_ms([&] { finder.align(full, room[0].box); }));
}

}  // namespace

void bench_detection(std::ostream& out, const ModelFile& file, const DetectionInputs& inputs) {
  DetectionReport report(out, inputs.details);
  learn::OtherPictures others;
  if (inputs.others) others = learn::read_other_pictures(*inputs.others);
  if (inputs.portraits) {
    auto faces = read_held_out_faces(*inputs.portraits);
    if (faces.empty()) fail_input(*inputs.portraits, "has no photograph that is held out of training");
    faces.resize(std::min(faces.size(), static_cast<std::size_t>(inputs.count)));
    still_pictures(file, faces, report);
    times(file, faces[0].picture, report);
    starts_from_five_points(file, faces, report);
    measure_films(file, faces, report);
    measure_returns(file, faces, others, report);
    measure_rolled(file, faces, others, report);
    measure_pushed(file, faces, others, report);
  }
  if (inputs.film && inputs.truth) measure_recorded_film(file, *inputs.film, *inputs.truth, report);
  if (inputs.others)
    measure_without_faces(file, others, std::min(others.count(), static_cast<std::size_t>(inputs.count)),
                          report);
  report.commit();
}

}  // namespace pliant::host
