#include <cmath>
#include <random>

#include "host/io/owned.hpp"
#include "host/render/scene.hpp"
#include "host/commands/image_fit.hpp"
#include "experiment.hpp"

namespace pliant::figure9 {

namespace {

constexpr int kWidth = 320, kHeight = 240, kExposures = 3;
constexpr double kPi = 3.14159265358979323846, kCameraRate = 60;

double wave(double t, double period, double phase = 0) {
  return std::sin(2 * kPi * (t / period + phase));
}

/// 1 within [from, to] of every `period` seconds, with soft ends of `soft` seconds.
double spell(double t, double period, double from, double to, double soft) {
  const double x = std::fmod(t, period);
  const auto ramp = [](double s) { return s <= 0 ? 0 : s >= 1 ? 1 : s * s * (3 - 2 * s); };
  return ramp((x - from) / soft) * ramp((to - x) / soft);
}

struct State {
  Pose pose;
  std::vector<float> q;
};

/// The person at a time in seconds.
class Person {
 public:
  explicit Person(const Model& model) : model_(model) {}

  State at(double t) const {
    State s;
    constexpr double kRadian = kPi / 180;
    s.pose.q =
        quaternion_of(25 * kRadian * wave(t, 6.7), 7 * kRadian * wave(t, 4.4), 6 * kRadian * wave(t, 9.3));
    s.pose.t = {static_cast<float>(35 * wave(t, 8)), static_cast<float>(-28 + 12 * wave(t, 5.3)),
                static_cast<float>(620 + 60 * wave(t, 11.3))};
    s.q.assign(model_.parameters().count, 0.0f);
    set(s.q, "faceWidth", 0.8);
    set(s.q, "lowerFaceHeight", -0.7);
    set(s.q, "jawWidth", 1.1);
    set(s.q, "eyeSpacing", -0.6);
    set(s.q, "noseLength", 0.9);
    set(s.q, "noseWidth", -0.8);
    set(s.q, "mouthWidth", 0.6);
    set(s.q, "cheekbones", 0.8);
    set(s.q, "chinProtrusion", -0.6);
    const double talk = spell(t, 9, 1, 6, 0.5), smile = spell(t, 9, 5.5, 8.6, 0.8),
                 brows = spell(t, 7, 2, 4, 0.5);
    set(s.q, "jawOpen", 0.16 * talk * (0.5 - 0.5 * wave(t, 0.37, 0.25)) * (0.7 + 0.3 * wave(t, 1.23)));
    set(s.q, "mouthFunnel", 0.4 * talk * (0.5 - 0.5 * wave(t, 0.77, 0.25)));
    set_pair(s.q, "mouthUpperUp", 0.2 * talk);
    set_pair(s.q, "mouthSmile", 0.8 * smile);
    set_pair(s.q, "eyeSquint", 0.4 * smile);
    set_pair(s.q, "browInnerUp", 0.7 * brows);
    set_pair(s.q, "browOuterUp", 0.6 * brows);
    set_pair(s.q, "eyeBlink", spell(t, 3.1, 2.7, 2.95, 0.1));
    return s;
  }

 private:
  static Quat quaternion_of(double yaw, double pitch, double roll) {
    const auto turn = [](Vec3 axis, double angle) { return exp_rotation(static_cast<float>(angle) * axis); };
    return turn({0, 0, 1}, roll) * turn({0, 1, 0}, yaw) * turn({1, 0, 0}, pitch);
  }
  /// A name that the model lacks moves nothing.
  void set(std::vector<float>& q, const std::string& name, double value) const {
    for (std::size_t k = 0; k < q.size(); ++k)
      if (name == model_.parameters()[k].name) q[k] = static_cast<float>(value);
  }
  void set_pair(std::vector<float>& q, const std::string& name, double value) const {
    set(q, name + "Left", value);
    set(q, name + "Right", value);
  }
  Model model_;
};

/// A blotchy board that crosses the face from left to right for three seconds of every fifteen.
class Occluder {
 public:
  Occluder() : texture_(host::make_background(kSide, kSide, 77)) {}
  bool is_there(double t) const { return phase(t) >= 0 && phase(t) <= 1; }
  void draw(host::Image& image, double t) const {
    if (!is_there(t)) return;
    const int x0 = static_cast<int>(40 + 170 * phase(t)), y0 = static_cast<int>(95 + 25 * wave(t, 1.7));
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x)
        if (image.contains(x0 + x, y0 + y))
          *image.at(x0 + x, y0 + y) = static_cast<std::uint8_t>(255 - *texture_.at(x, y));
  }

 private:
  static constexpr int kSide = 70;
  static double phase(double t) { return (std::fmod(t, 15.0) - 9) / 3; }
  host::Image texture_;
};

/// The camera's light control and a cloud: gain and bias.
void change_light(host::Image& image, double t) {
  const auto gain = static_cast<float>(1 + 0.2 * wave(t, 13)), bias = static_cast<float>(10 * wave(t, 17));
  for (std::uint8_t& pixel : image.pixels)
    pixel = static_cast<std::uint8_t>(clamp(gain * static_cast<float>(pixel) + bias + 0.5f, 0, 255));
}

/// (u,v) of the markers: a grid over what faces the camera in frame 0.
std::vector<Vec2> choose_markers(const Model& model, Cascade& cascade, const State& state, const View& view) {
  std::vector<Vec2> out;
  const Projector projector(view, true);
  for (float v = 0.12f; v < 0.95f; v += 0.13f)
    for (float u = 0.12f; u < 0.95f; u += 0.13f) {
      const SurfaceFrame frame = cascade.surface_frame({u, v}, state.q.data());
      const Vec3 normal = projector.rotated(normalised(cross(frame.pv, frame.pu)));
      if (model.is_on_surface({u, v}) && -dot(normal, normalised(projector.to_camera(frame.p))) > 0.5f)
        out.push_back({u, v});
    }
  return out;
}

/// Where the markers are; those turned away are not seen.
std::vector<std::optional<Vec2>> project_markers(Cascade& cascade, const std::vector<Vec2>& markers,
                                                 const State& state, const View& view) {
  std::vector<std::optional<Vec2>> out;
  const Projector projector(view, true);
  for (Vec2 uv : markers) {
    const SurfaceFrame frame = cascade.surface_frame(uv, state.q.data());
    const Vec3 normal = projector.rotated(normalised(cross(frame.pv, frame.pu)));
    Vec2 x;
    const bool seen =
        projector.project(frame.p, &x) && -dot(normal, normalised(projector.to_camera(frame.p))) > 0.2f;
    out.push_back(seen ? std::optional<Vec2>(x) : std::nullopt);
  }
  return out;
}

void fit_start(Experiment& e, const Model& model, const std::string& path, Cascade& cascade,
               const State& state) {
  std::mt19937 random(5);
  std::normal_distribution<float> noise(0, 0.5f);
  const Projector projector(view_of(state.pose, e.camera), true);
  std::vector<host::NamedPoint> points;
  for (const Landmark& l : model.landmarks()) {
    Vec2 x;
    if (std::string(l.name).rfind("ibug", 0) != 0 ||
        !projector.project(cascade.surface_point(l.uv(), state.q.data()), &x))
      continue;
    const Vec2 off{noise(random), noise(random)};
    points.push_back({l.name, x + off, "landmark"});
  }
  const host::ModelFile file(path);
  host::FitSetup setup;
  setup.size = {kWidth, kHeight};
  const host::FitFile fit = host::fit_to_points(file, "landmarks", points, setup);
  e.camera = fit.camera;
  e.pose = fit.pose;
  e.q.assign(model.parameters().count, 0.0f);
  host::apply(fit.parameters, "fit", model, e.q.data());
}

}  // namespace

Experiment make_rendered(const Model& model, const std::string& model_path, int frames) {
  Experiment e;
  e.name = "rendered";
  e.frames_per_second = kCameraRate / 4;
  e.camera = centred_camera(kWidth, kHeight, host::default_focal({kWidth, kHeight}));
  const Person person(model);
  const Occluder occluder;
  host::Owned<Cascade> cascade(model);
  const Camera true_camera = e.camera;
  const std::vector<Vec2> markers =
      choose_markers(model, *cascade, person.at(0), view_of(person.at(0).pose, true_camera));
  const host::Image background = host::make_background(kWidth, kHeight, 3);
  host::Scene scene(model, kWidth, kHeight, 192, 2);
  for (int k = 0; k < frames; ++k) {
    const double t = k / e.frames_per_second;
    // The shutter is open for the whole of a frame of 60 Hz, centred on t.
    std::vector<unsigned> sum(static_cast<std::size_t>(kWidth * kHeight));
    for (int i = 0; i < kExposures; ++i) {
      const State s = person.at(t + (i - (kExposures - 1) / 2.0) / (kExposures * kCameraRate));
      const host::Image part = scene.draw(s.q.data(), s.pose, true_camera, background);
      for (std::size_t p = 0; p < sum.size(); ++p) sum[p] += part.pixels[p];
    }
    host::Image image(kWidth, kHeight, 1);
    for (std::size_t p = 0; p < sum.size(); ++p)
      image.pixels[p] = static_cast<std::uint8_t>((sum[p] + kExposures / 2) / kExposures);
    occluder.draw(image, t);
    change_light(image, t);
    host::add_noise(image, 2.5f, 1000u + static_cast<unsigned>(k));
    const State s = person.at(t);
    e.frames.push_back(std::move(image));
    e.truth.push_back(project_markers(*cascade, markers, s, view_of(s.pose, true_camera)));
    e.is_hidden.push_back(occluder.is_there(t));
  }
  fit_start(e, model, model_path, *cascade, person.at(0));
  return e;
}

}  // namespace pliant::figure9
