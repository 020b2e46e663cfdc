// The same bits everywhere: a fit and a tracking run with all of its parts, on pictures drawn here with nothing but
// + - * / and sqrt, reduced to one number that every compiler, level and target must give.
#include <doctest/doctest.h>

#include <cstring>
#include <vector>

#include "model_builder.hpp"
#include "pliant/fit.hpp"
#include "pliant/tracker.hpp"
#include "random.hpp"

using namespace pliant;

namespace {

constexpr std::uint32_t kDigest = 3036851618u;
constexpr int kWidth = 200, kHeight = 160, kFrames = 12;

/// FNV-1a of the bits of what it is given.
struct Digest {
  std::uint32_t value = 2166136261u;
  void add(float x) {
    std::uint32_t bits;
    std::memcpy(&bits, &x, sizeof bits);
    for (int k = 0; k < 4; ++k) value = (value ^ ((bits >> (8 * k)) & 255u)) * 16777619u;
  }
  void add(Vec2 v) {
    add(v.x);
    add(v.y);
  }
  void add(const View& v) {
    for (float x : {v.q.w, v.q.x, v.q.y, v.q.z, v.s, v.tau.x, v.tau.y, v.rho}) add(x);
  }
};

/// A blotchy grey for every (u,v), without libm.
float paint(Vec2 uv) {
  const auto wave = [](float t) {
    t = t - static_cast<float>(static_cast<int>(t));
    return 16 * t * t * (1 - t) * (1 - t);
  };
  return 40 + 90 * wave(4 * uv.x + uv.y + 1) * wave(5 * uv.y + 1) +
         80 * wave(9 * uv.x + 3) * wave(11 * uv.y + 2 * uv.x);
}

/// Draws the model as a grid of 96 x 96 squares, each two triangles, front ones only, flat grey in 3 x 3 sub-samples.
std::vector<std::uint8_t> draw(Cascade& cascade, const float* q, const View& view) {
  constexpr int n = 96;
  std::vector<Vec2> x(static_cast<std::size_t>((n + 1) * (n + 1)));
  const Projector projector(view, true);
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i)
      REQUIRE(
          projector.project(cascade.surface_point({static_cast<float>(i) / n, static_cast<float>(j) / n}, q),
                            &x[static_cast<std::size_t>(j * (n + 1) + i)]));
  std::vector<std::uint8_t> picture(kWidth * kHeight, 20);
  const auto triangle = [&](int i, int j, int a, int b, int c) {
    const int corner[4][2] = {{i, j}, {i + 1, j}, {i + 1, j + 1}, {i, j + 1}};
    const int k[3] = {a, b, c};
    Vec2 p[3], t[3];
    for (int m = 0; m < 3; ++m) {
      p[m] = x[static_cast<std::size_t>(corner[k[m]][1] * (n + 1) + corner[k[m]][0])];
      t[m] = {static_cast<float>(corner[k[m]][0]) / n, static_cast<float>(corner[k[m]][1]) / n};
    }
    const float area = doubled_area(p[0], p[1], p[2]);
    if (!(area > 1e-4f)) return;
    const auto pixel = [](float v, int most) {
      return static_cast<int>(clamp(v, 0, static_cast<float>(most)));
    };
    for (int y = pixel(min(p[0].y, min(p[1].y, p[2].y)), kHeight - 1);
         y <= pixel(max(p[0].y, max(p[1].y, p[2].y)) + 1, kHeight - 1); ++y)
      for (int c0 = pixel(min(p[0].x, min(p[1].x, p[2].x)), kWidth - 1);
           c0 <= pixel(max(p[0].x, max(p[1].x, p[2].x)) + 1, kWidth - 1); ++c0) {
        const Vec2 at{static_cast<float>(c0), static_cast<float>(y)};
        const float wa = doubled_area(at, p[1], p[2]) / area, wb = doubled_area(p[0], at, p[2]) / area,
                    wc = 1 - wa - wb;
        if (wa < 0 || wb < 0 || wc < 0) continue;
        picture[static_cast<std::size_t>(y * kWidth + c0)] =
            static_cast<std::uint8_t>(clamp(paint(wa * t[0] + (wb * t[1] + wc * t[2])), 0, 255));
      }
  };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      triangle(i, j, 0, 1, 2);
      triangle(i, j, 0, 2, 3);
    }
  return picture;
}

}  // namespace

TEST_CASE("a fit and a tracking run give the one digest") {
  const auto words = egg_model(4).table();
  Model model;
  REQUIRE(Model::open(words.data(), words.size() * 4, &model) == Status::ok);
  InArena<Cascade> cascade(model);
  Random random(77);
  Digest digest;
  std::vector<float> truth(model.parameters().count, 0.0f);
  for (std::size_t k = 0; k < 4; ++k) truth[k] = random.uniform(-1.5f, 1.5f);
  const Camera camera = centred_camera(kWidth, kHeight, 280);
  Pose pose{exp_rotation({0.05f, -0.1f, 0.03f}), {4, -3, 420}};

  // The fit: noise, a few gross errors, focal length unknown.
  std::vector<Correspondence> points;
  for (const Landmark& l : model.landmarks()) {
    Correspondence c;
    c.uv = {l.u, l.v};
    REQUIRE(Projector(view_of(pose, camera), true).project(cascade->surface_point(c.uv, truth.data()), &c.x));
    const float dx = 0.3f * random.normal();
    c.x = c.x + Vec2{dx, 0.3f * random.normal()};
    if (points.size() % 9 == 4) c.x.x += 25;
    points.push_back(c);
  }
  FitLimits fit_limits;
  fit_limits.points = 100;
  InArena<Fitter> fitter(model, fit_limits);
  FitOptions options;
  options.width = kWidth;
  options.height = kHeight;
  std::vector<float> q(truth.size(), 0), sd(truth.size());
  FitReport report;
  REQUIRE(fitter->fit({points.data(), points.size()}, options, q.data(), &report, sd.data(), nullptr,
                      nullptr) == Status::ok);
  digest.add(report.view);
  for (float v : q) digest.add(v);
  for (float v : sd) digest.add(v);

  // The run: turns, a jaw that opens, a hand's worth of black over some frames.
  TrackerLimits limits;
  limits.width = kWidth;
  limits.height = kHeight;
  limits.patches = 60;
  limits.markers = 1;
  limits.vertices = 200;
  InArena<Tracker> tracker(model, limits);
  int tracking = 0;
  for (int k = 0; k < kFrames; ++k) {
    const float s = static_cast<float>(k) / kFrames;
    truth[6] = 0.2f * s;
    const Pose moved_pose{normalised(exp_rotation({0.1f * s, 0.25f * s, -0.1f * s}) * pose.q),
                          pose.t + Vec3{6 * s, 4 * s, 20 * s}};
    auto picture = draw(cascade.object, truth.data(), view_of(moved_pose, camera));
    if (k > 5 && k < 9)
      for (std::size_t i = 0; i < picture.size(); ++i)
        if (i % kWidth < 90 && i / kWidth > 90) picture[i] = 0;
    const FrameView frame{picture.data(),
                          kWidth,
                          kHeight,
                          kWidth,
                          1,
                          k * std::int64_t{40'000'000},
                          static_cast<std::uint32_t>(k)};
    FrameResult result;
    const Vec2 marker{100, 70};
    if (k == 0) {
      REQUIRE(tracker->start(frame, camera, moved_pose, truth.data(), {&marker, 1}, {}) == Status::ok);
      result = tracker->result();
    } else {
      REQUIRE(tracker->update(frame, &result) == Status::ok);
    }
    tracking += result.state == TrackState::tracking;
    digest.add(tracker->estimator().view());
    for (float v : tracker->estimator().parameters()) digest.add(v);
    Vec2 x;
    REQUIRE(tracker->marker(0, &x));
    digest.add(x);
    digest.add(static_cast<float>(result.inliers));
    for (VertexId v : tracker->estimator().mesh().vertices())
      digest.add(tracker->estimator().vertex_images()[v]);
  }
  CHECK(tracking == kFrames);
  CHECK(magnitude(tracker->estimator().parameters()[6] - truth[6]) < 0.05f);
  CHECK(digest.value == kDigest);
}
