// `pliant bench track`: time and error of Tracker::update on rendered frames, from the same runs.
#include <algorithm>
#include <cmath>
#include <ctime>

#include "host/bench/bench.hpp"
#include "host/bench/rows.hpp"
#include "host/commands/image_fit.hpp"
#include "host/io/failure.hpp"
#include "host/io/owned.hpp"
#include "host/render/scene.hpp"
#include "pliant/tracker.hpp"

namespace pliant::host {

namespace {

constexpr std::size_t kUnique = 40, kTracked = 160;

/// Appearance of the rendered head: arguments of Scene::flatten_half and Scene::speckle, and the head's height as a fraction
/// of the picture's.
struct Appearance {
  float flat_step_grey = 0, speckle = 0, height = 0.6f;
};

/// Frames of a head that turns, nods, approaches the camera and talks. They are shown forwards and backwards in turn.
struct Film {
  ImageSize size;
  Camera camera;
  std::vector<Image> frames;
  std::vector<Pose> poses;
  std::vector<std::vector<float>> q;

  Film(const Model& model, ImageSize picture, const Appearance& appearance = {})
      : size(picture), camera(centred_camera(size.width, size.height, default_focal(size))) {
    Scene scene(model, size.width, size.height);
    scene.flatten_half(appearance.flat_step_grey);
    scene.speckle(appearance.speckle);
    const Image background = make_background(size.width, size.height, 5);
    const std::vector<float> rest(model.parameters().count, 0.0f);
    const Pose frontal = frontal_pose(model, rest.data(), camera, size.height, appearance.height);
    const std::uint16_t jaw = model.find_parameter("jawOpen"), brow = model.find_parameter("browInnerUpLeft"),
                        smile = model.find_parameter("mouthSmileLeft");
    for (std::size_t k = 0; k < kUnique; ++k) {
      const float s = static_cast<float>(k) / (kUnique - 1), wave = std::sin(3.14159f * (s - 0.5f));
      Pose pose = frontal;
      pose.q = exp_rotation({0.1f * s, 0.4f * wave, 0.05f * wave});
      pose.t = pose.t + Vec3{20 * wave, 5 * s, -30 * s};
      auto now = rest;
      if (jaw != kNone) now[jaw] = 0.1f * (1 - std::cos(12.566f * s));
      if (brow != kNone) now[brow] = 0.8f * s * s;
      if (smile != kNone) now[smile] = 0.3f * (1 + wave);
      frames.push_back(scene.draw(now.data(), pose, camera, background));
      add_noise(frames.back(), 2, static_cast<std::uint32_t>(k));
      poses.push_back(pose);
      q.push_back(now);
    }
  }
  static std::size_t shown(std::size_t n) {
    const std::size_t m = n % (2 * kUnique - 2);
    return m < kUnique ? m : 2 * kUnique - 2 - m;
  }
  FrameView view(std::size_t n) const { return frame_of(frames[shown(n)], n); }
};

struct Measured {
  double milliseconds = 0, worst_milliseconds = 0, rotation_deg = 0, landmark_px = 0;
  double tracked = 0, patches = 0, vertices = 0, bytes = 0;
};

double landmark_error(const Model& model, const Film& film, std::size_t n, Tracker& tracker,
                      Cascade& cascade) {
  const std::size_t k = Film::shown(n);
  const Projector projector(view_of(film.poses[k], film.camera), true);
  double sum = 0;
  for (const Landmark& l : model.landmarks()) {
    Vec2 truth, x;
    if (projector.project(cascade.surface_point(l.uv(), film.q[k].data()), &truth) &&
        tracker.estimator().project(l.uv(), &x))
      sum += static_cast<double>(length(x - truth));
  }
  return sum / static_cast<double>(std::max<std::size_t>(model.landmarks().count, 1));
}

/// Times are processor times, so that other programs do not add to them.
Measured measure(const Model& model, const Film& film, TrackerLimits limits, const TrackerOptions& options) {
  limits.width = static_cast<std::uint16_t>(film.size.width);
  limits.height = static_cast<std::uint16_t>(film.size.height);
  Owned<Tracker> tracker(model, limits);
  Owned<Cascade> cascade(model);
  require(tracker->start_from_pose(film.view(0), film.camera, film.poses[0], film.q[0].data(), options),
          "start");
  Measured out;
  std::vector<double> times, turns;
  for (std::size_t n = 1; n <= kTracked; ++n) {
    FrameResult result;
    const std::clock_t before = std::clock();
    require(tracker->update(film.view(n), &result), "frame");
    times.push_back(1e3 * static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC);
    const Quat truth = film.poses[Film::shown(n)].q;
    turns.push_back(57.29578 * static_cast<double>(length(log_rotation(result.pose.q * conjugate(truth)))));
    out.landmark_px += landmark_error(model, film, n, *tracker, *cascade) / kTracked;
    out.tracked += static_cast<double>(result.state == TrackState::tracking) / kTracked;
    out.patches += static_cast<double>(result.tracked) / kTracked;
    out.vertices = result.vertices;
  }
  out.milliseconds = median(times);
  out.worst_milliseconds = *std::max_element(times.begin(), times.end());
  out.rotation_deg = median(turns);
  out.bytes = static_cast<double>(tracker.used_bytes());
  return out;
}

void print(std::ostream& out, const std::string& variant, const Measured& m, const char* topic = "track") {
  const BenchRows rows(out, topic);
  const auto row = [&](const char* metric, double value) { rows(variant, metric, value); };
  row("median_ms", m.milliseconds);
  row("worst_ms", m.worst_milliseconds);
  row("rotation_deg", m.rotation_deg);
  row("landmark_px", m.landmark_px);
  row("tracked_fraction", m.tracked);
  row("patches_found", m.patches);
  row("vertices", m.vertices);
  row("arena_bytes", m.bytes);
}

std::string text_of(ImageSize size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

TrackerLimits sized(std::uint16_t points, std::uint16_t vertices) {
  TrackerLimits limits;
  limits.key_patches = static_cast<std::uint16_t>(points / 5);
  limits.patches = static_cast<std::uint16_t>(points - limits.key_patches);
  limits.vertices = vertices;
  return limits;
}

}  // namespace

void bench_track(std::ostream& out, const ModelFile& file) {
  const Model& model = file.model();
  TrackerOptions options;
  options.estimator.mesh_error_mm = 0.02f;  // small, so that the mesh uses its whole budget
  // The texture of a face does not have 500 corners at these image sizes. A speckled face that fills the picture has.
  // patches_found is the mean number of points a frame; some are occluded while the head is turned.
  TrackerLimits many = sized(600, 1900);
  many.patches = 600;
  many.key_patches = 0;
  for (const ImageSize size : {ImageSize{360, 288}, ImageSize{640, 480}})
    print(out, "500 points found 1900 vertices " + text_of(size),
          measure(model, Film(model, size, {0, 0.5f, 0.9f}), many, options));
  const Film small(model, {360, 288}), large(model, {640, 480}), s(model, {320, 240});
  print(out, "defaults 360x288", measure(model, small, {}, {}));
  print(out, "profile_s 320x240", measure(model, s, profile_s(), options));
  print(out, "profile_l 640x480", measure(model, large, profile_l(), options));
  for (const Film* film : {&small, &large})
    print(out, "limit of 500 points 1900 vertices " + text_of(film->size),
          measure(model, *film, sized(500, 1900), options));
  for (const std::uint16_t points : {std::uint16_t{100}, std::uint16_t{200}, std::uint16_t{300}})
    print(out, "limit of " + std::to_string(points) + " points 1900 vertices 360x288",
          measure(model, small, sized(points, 1900), options));
  for (const std::uint16_t vertices : {std::uint16_t{500}, std::uint16_t{1000}})
    print(out, "limit of 500 points " + std::to_string(vertices) + " vertices 360x288",
          measure(model, small, sized(500, vertices), options));
  std::vector<std::uint8_t> is_free(model.parameters().count, 0);
  options.is_free = is_free.data();
  print(out, "limit of 500 points 1900 vertices 360x288 pose only",
        measure(model, small, sized(500, 1900), options));
  std::fill(is_free.begin(), is_free.end(), std::uint8_t{1});
  print(out, "limit of 500 points 1900 vertices 360x288 all parameters",
        measure(model, small, sized(500, 1900), options));
}

/// One limit at a time is changed from 200 points, 512 vertices, the expression parameters and 320 x 240 pixels.
void bench_cost(std::ostream& out, const ModelFile& file) {
  const Model& model = file.model();
  const Film film(model, {320, 240});
  TrackerOptions options;
  options.estimator.mesh_error_mm = 0.02f;
  const auto row = [&](const std::string& variant, const Film& shown, const TrackerLimits& limits) {
    print(out, variant, measure(model, shown, limits, options), "cost");
  };
  for (const int points : {50, 100, 200, 400, 800})
    row("points " + std::to_string(points), film, sized(static_cast<std::uint16_t>(points), 512));
  for (const int vertices : {512, 1000, 2000, 4000})
    row("vertices " + std::to_string(vertices), film, sized(200, static_cast<std::uint16_t>(vertices)));
  for (const ImageSize size : {ImageSize{160, 120}, ImageSize{640, 480}, ImageSize{1280, 960}})
    row("pixels " + text_of(size), Film(model, size), sized(200, 512));
  // Expression parameters first, then identity parameters.
  std::vector<std::uint8_t> is_free(model.parameters().count, 0);
  options.is_free = is_free.data();
  std::size_t count = 0, next = 0;
  for (const Group group : {Group::expression, Group::identity})
    for (std::size_t k = 0; k < is_free.size(); ++k) {
      if (model.parameters()[k].group != group) continue;
      if (count == next) row("parameters " + std::to_string(count), film, sized(200, 512));
      if (count == next) next = next == 0 ? 10 : 2 * next;
      is_free[k] = 1;
      ++count;
    }
  row("parameters " + std::to_string(count), film, sized(200, 512));
  options.is_free = nullptr;
  TrackerLimits limits = sized(200, 512);
  limits.surface_texture = &kSurfaceTexture;
  options.estimator.mesh_operations = 16;
  row("mesh 16 operations a frame", film, limits);
}

void bench_cues(std::ostream& out, const ModelFile& file) {
  const Film flat(file.model(), {320, 240}, {64}), whole(file.model(), {320, 240});
  TrackerLimits limits;
  limits.curve_points = 96;
  limits.silhouette_points = 24;
  const auto bit = [](Cue cue) { return static_cast<std::uint8_t>(1u << static_cast<unsigned>(cue)); };
  const std::uint8_t corners = bit(Cue::patch), edges = bit(Cue::edge), flow = bit(Cue::flow);
  struct Variant {
    const char* name;
    unsigned cues;
  };
  for (const Variant v : {Variant{"corners", corners}, Variant{"corners edges", corners | unsigned{edges}},
                          Variant{"corners flow", corners | unsigned{flow}},
                          Variant{"corners edges flow", corners | unsigned{edges} | flow}}) {
    TrackerOptions options;
    options.estimator.cues = static_cast<std::uint8_t>(v.cues);
    print(out, std::string("half flat ") + v.name, measure(file.model(), flat, limits, options));
    print(out, std::string("whole texture ") + v.name, measure(file.model(), whole, limits, options));
  }
}

void bench_drift(std::ostream& out, const ModelFile& file) {
  constexpr std::size_t kFrameCount = 5000, kCycle = 2 * kUnique - 2;
  const Model& model = file.model();
  const Film film(model, {320, 240});
  TrackerLimits limits;
  Owned<Tracker> tracker(model, limits);
  Owned<Cascade> cascade(model);
  require(tracker->start_from_pose(film.view(0), film.camera, film.poses[0], film.q[0].data()), "start");
  double sum = 0;
  for (std::size_t n = 1; n <= kFrameCount; ++n) {
    FrameResult result;
    require(tracker->update(film.view(n), &result), "frame");
    sum += landmark_error(model, film, n, *tracker, *cascade);
    if (n % kCycle != 0) continue;  // a whole swing of the head
    const std::size_t swing = n / kCycle;
    if (swing == 1 || swing % 8 == 0)
      BenchRows(out, "drift")("swing to frame " + std::to_string(n), "landmark_px", sum / kCycle);
    sum = 0;
  }
}

}  // namespace pliant::host
