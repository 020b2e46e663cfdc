// `pliant bench print`: starts of a printed surface, rendered at known poses before photographs, and pictures without it.
#include <cmath>
#include <optional>

#include "host/bench/bench.hpp"
#include "host/bench/random.hpp"
#include "host/bench/rows.hpp"
#include "host/bench/still_film.hpp"
#include "host/commands/tracker_limits.hpp"
#include "host/io/bounding_box.hpp"
#include "host/io/failure.hpp"
#include "host/io/owned.hpp"
#include "host/learn/other_pictures.hpp"
#include "host/learn/sample_random.hpp"
#include "host/render/scene.hpp"
#include "pliant/tracker.hpp"

namespace pliant::host {

namespace {

constexpr int kFrames = 5;  // in which a surface is to be found
constexpr float kRight =
    0.03f;  // mean error of the surface in the image, fraction of its extent, that counts as right
constexpr float kFilled = 0.55f;  // height of the surface at distance 1, fraction of the frame's

/// How the surface is shown.
struct PrintCase {
  const char* name;
  ImageSize size;
  float distance, tilt_degrees, bend;  // bend: standard deviation of the expression parameters
};

constexpr PrintCase kCases[] = {
    {"320x240_x1", {320, 240}, 1, 20, 0},      {"320x240_x1.6", {320, 240}, 1.6f, 20, 0},
    {"320x240_x0.4", {320, 240}, 0.4f, 20, 0}, {"320x240_x2", {320, 240}, 2, 20, 0},
    {"320x240_x2.5", {320, 240}, 2.5f, 20, 0},
    {"640x480_x0.4", {640, 480}, 0.4f, 20, 0}, {"640x480_x0.7", {640, 480}, 0.7f, 20, 0},
    {"640x480_x1", {640, 480}, 1, 20, 0},      {"640x480_x1.6", {640, 480}, 1.6f, 20, 0},
    {"640x480_x2.5", {640, 480}, 2.5f, 20, 0}, {"640x480_frontal", {640, 480}, 1, 0, 0},
    {"640x480_tilt_35", {640, 480}, 1, 35, 0}, {"640x480_tilt_45", {640, 480}, 1, 45, 0},
    {"640x480_tilt_55", {640, 480}, 1, 55, 0}, {"640x480_bent_0.5", {640, 480}, 1, 20, 0.5f},
    {"640x480_bent_1", {640, 480}, 1, 20, 1},  {"640x480_bent_1_tilt_45", {640, 480}, 1, 45, 1},
};

struct ShownSurface {
  Pose pose;
  std::vector<float> q;
};

ShownSurface random_surface(const Model& model, const PrintCase& c, const Camera& camera,
                            BenchRandom& random) {
  ShownSurface s;
  s.q.assign(model.parameters().count + 1, 0.0f);
  for (std::size_t k = 0; k < model.parameters().count; ++k) {
    const Parameter& p = model.parameters()[k];
    if (p.group == Group::expression)
      s.q[k] = clamp(c.bend * p.sd * 1.7f * (2 * random.unit() - 1), p.minimum, p.maximum);
  }
  const float around = 6.2831853f * random.unit(), roll = 6.2831853f * random.unit();
  const Quat tilt = exp_rotation(c.tilt_degrees / 57.29578f * Vec3{std::cos(around), std::sin(around), 0}),
             turn = exp_rotation(Vec3{0, 0, roll});
  s.pose = frontal_pose(model, s.q.data(), camera, c.size.height, kFilled);
  s.pose.q = tilt * turn;
  s.pose.t.z *= c.distance;
  const float room = 0.1f * s.pose.t.z * static_cast<float>(c.size.width) / camera.f;
  s.pose.t.x = room * (2 * random.unit() - 1);
  s.pose.t.y = 0.5f * room * (2 * random.unit() - 1);
  return s;
}

/// Image positions of a grid of surface points; without those that are behind the camera.
std::vector<std::optional<Vec2>> project_grid(const Model& model, Cascade& cascade, const Pose& pose,
                                              const Camera& camera, const float* q) {
  std::vector<std::optional<Vec2>> x;
  const Projector projector(view_of(pose, camera), true);
  for (int k = 0; k < 81; ++k) {
    const Vec2 uv{0.1f + 0.1f * static_cast<float>(k % 9), 0.1f + 0.1f * static_cast<float>(k / 9)};
    Vec2 at;
    const bool is_seen = model.is_on_surface(uv) && projector.project(cascade.surface_point(uv, q), &at);
    x.push_back(is_seen ? std::optional<Vec2>(at) : std::nullopt);
  }
  return x;
}

/// Mean distance, as a fraction of the diagonal of the true points' box.
double surface_error(const std::vector<std::optional<Vec2>>& a,
                     const std::vector<std::optional<Vec2>>& truth) {
  BoundingBox<Vec2> box;
  double sum = 0;
  int count = 0;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    if (!truth[k]) continue;
    box.add(*truth[k]);
    sum += a[k] ? static_cast<double>(length(*a[k] - *truth[k])) : 1e3;
    ++count;
  }
  return count == 0 ? 0 : sum / count / static_cast<double>(length(box.size()));
}

double rotation_degrees(Quat a, Quat b) {
  const Vec3 w = log_rotation(a * conjugate(b));
  return static_cast<double>(length(w)) * 57.29578;
}

/// As the command tracks a file: the work of a search is not divided into frames.
TrackerLimits limits_for(const Model& model, ImageSize size) {
  TrackerLimits limits = size.width > 320 ? profile_l() : profile_m();
  limits.width = static_cast<std::uint16_t>(size.width);
  limits.height = static_cast<std::uint16_t>(size.height);
  limits.search_work = whole_search(model, limits);
  return limits;
}

void measure_case(const Model& model, const PrintCase& c, const learn::OtherPictures& others, int count,
                  const BenchRows& rows) {
  const Camera camera = centred_camera(c.size.width, c.size.height, 1.4f * static_cast<float>(c.size.width));
  Scene scene(model, c.size.width, c.size.height);
  Owned<Cascade> cascade(model);
  Owned<Tracker> tracker(model, limits_for(model, c.size));
  BenchRandom random;
  learn::SampleRandom crops(1, 0);
  int found = 0, right = 0, tilted_right = 0;
  std::vector<double> errors, rotations, frames;
  for (int k = 0; k < count; ++k) {
    const ShownSurface s = random_surface(model, c, camera, random);
    const Image background = others.count() > 0 ? others.crop(c.size.width, c.size.height, crops)
                                                : make_background(c.size.width, c.size.height, random.bits());
    const Image clean = scene.draw(s.q.data(), s.pose, camera, background);
    require(tracker->start_by_detection(), "start");
    FrameResult result;
    int frame = 0;
    for (; frame < kFrames && !tracker->is_started(); ++frame) {
      Image noisy = clean;
      add_noise(noisy, 3, random.bits());
      require(tracker->update(frame_of(noisy, static_cast<std::size_t>(kFrames * k + frame + 1)), &result),
              "update");
    }
    if (!tracker->is_started()) continue;
    ++found;
    const double error = surface_error(
        project_grid(model, *cascade, result.pose, tracker->camera(), tracker->parameters().data),
        project_grid(model, *cascade, s.pose, camera, s.q.data()));
    const double rotation = rotation_degrees(result.pose.q, s.pose.q);
    right += error <= static_cast<double>(kRight);
    tilted_right += rotation <= 10;
    errors.push_back(100 * error);
    rotations.push_back(rotation);
    frames.push_back(frame);
  }
  const double all = 0.01 * count;
  rows(c.name, "found_percent", found / all);
  rows(c.name, "right_percent", right / all);
  rows(c.name, "rotation_within_10_percent", tilted_right / all);
  if (errors.empty()) return;
  rows(c.name, "surface_error_percent", quantile(errors, 0.5));
  rows(c.name, "rotation_deg", quantile(rotations, 0.5));
  rows(c.name, "frames", quantile(frames, 0.95));
}

/// Films of pictures that do not show the surface.
void measure_without(const Model& model, const learn::OtherPictures& others, const BenchRows& rows) {
  const ImageSize size{640, 480};
  Owned<Tracker> tracker(model, limits_for(model, size));
  learn::SampleRandom crops(2, 0);
  int starts = 0;
  std::vector<double> times;
  constexpr int kCrops = 2;
  for (std::size_t k = 0; k < kCrops * others.count(); ++k) {
    const Image picture = others.crop(size.width, size.height, crops);
    StillFilm film(picture, {3, 2, static_cast<std::uint32_t>(k + 1)});
    require(tracker->start_by_detection(), "start");
    for (std::size_t f = 0; f < 10; ++f) {
      FrameResult result;
      FrameView frame = film.frame(f);
      frame.time_ns = static_cast<std::int64_t>(100 * k + f + 1) * 33333333;
      frame.sequence = static_cast<std::uint32_t>(100 * k + f + 1);
      const double before = process_ms();
      require(tracker->update(frame, &result), "update");
      times.push_back(process_ms() - before);
      if (tracker->is_started()) {
        ++starts;
        break;
      }
    }
  }
  rows("without_640x480", "films", static_cast<double>(kCrops * others.count()));
  rows("without_640x480", "false_starts", starts);
  if (times.empty()) return;
  rows("without_640x480", "search_ms", quantile(times, 0.5));
  rows("without_640x480", "search_ms_at_95", quantile(times, 0.95));
}

}  // namespace

void bench_print(std::ostream& out, const ModelFile& file, const std::optional<std::string>& folder,
                 int count) {
  const BenchRows rows(out, "print");
  if (file.model().print().empty()) fail_input(file.path(), "has no print");
  learn::OtherPictures others;
  if (folder) others = learn::read_other_pictures(*folder);
  for (const PrintCase& c : kCases) measure_case(file.model(), c, others, count, rows);
  if (others.count() > 0) measure_without(file.model(), others, rows);
}

}  // namespace pliant::host
