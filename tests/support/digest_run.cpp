#include "digest_run.hpp"

#include <cstring>

#include "pliant/fit.hpp"
#include "pliant/tracker.hpp"
#include "random.hpp"

using namespace pliant;

namespace {

constexpr int kWidth = 200, kHeight = 160;
constexpr int kSquares = 96;  // a side of the grid that is drawn

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
    const float all[] = {v.q.w, v.q.x, v.q.y, v.q.z, v.s, v.tau.x, v.tau.y, v.rho};
    for (float x : all) add(x);
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

struct Corner {
  Vec2 x, uv;  // in the picture, and in the chart
};

/// One triangle that faces the camera.
void draw_triangle(const Corner& a, const Corner& b, const Corner& c, std::uint8_t* picture) {
  const float area = doubled_area(a.x, b.x, c.x);
  if (!(area > 1e-4f)) return;
  const auto pixel = [](float v, int most) {
    return static_cast<int>(clamp(v, 0, static_cast<float>(most)));
  };
  const int x0 = pixel(min(a.x.x, min(b.x.x, c.x.x)), kWidth - 1);
  const int x1 = pixel(max(a.x.x, max(b.x.x, c.x.x)) + 1, kWidth - 1);
  const int y1 = pixel(max(a.x.y, max(b.x.y, c.x.y)) + 1, kHeight - 1);
  for (int y = pixel(min(a.x.y, min(b.x.y, c.x.y)), kHeight - 1); y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const Vec2 at{static_cast<float>(x), static_cast<float>(y)};
      const float wa = doubled_area(at, b.x, c.x) / area, wb = doubled_area(a.x, at, c.x) / area;
      const float wc = 1 - wa - wb;
      if (wa < 0 || wb < 0 || wc < 0) continue;
      picture[y * kWidth + x] =
          static_cast<std::uint8_t>(clamp(paint(wa * a.uv + (wb * b.uv + wc * c.uv)), 0, 255));
    }
}

/// Draws the model as a grid of squares, each two triangles, front ones only. False behind the camera.
bool draw(Cascade& cascade, const float* q, const View& view, Vec2* grid, std::uint8_t* picture) {
  const Projector projector(view, true);
  const auto uv_at = [](int i, int j) {
    return Vec2{static_cast<float>(i) / kSquares, static_cast<float>(j) / kSquares};
  };
  for (int j = 0; j <= kSquares; ++j)
    for (int i = 0; i <= kSquares; ++i)
      if (!projector.project(cascade.surface_point(uv_at(i, j), q), &grid[j * (kSquares + 1) + i]))
        return false;
  for (int i = 0; i < kWidth * kHeight; ++i) picture[i] = 20;
  const auto corner = [&](int i, int j) { return Corner{grid[j * (kSquares + 1) + i], uv_at(i, j)}; };
  for (int j = 0; j < kSquares; ++j)
    for (int i = 0; i < kSquares; ++i) {
      draw_triangle(corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), picture);
      draw_triangle(corner(i, j), corner(i + 1, j + 1), corner(i, j + 1), picture);
    }
  return true;
}

/// The fit and the run, step by step. Everything it needs lies in the arena but the objects themselves.
struct Run {
  DigestSubject subject;
  Model model;
  Cascade cascade;
  Fitter fitter;
  Tracker tracker;
  Digest digest;
  Random random{77};
  Camera camera = centred_camera(kWidth, kHeight, 280);
  Pose pose{exp_rotation({0.05f, -0.1f, 0.03f}), {4, -3, 420}};
  Span<float> truth, q, sd;
  Span<Correspondence> points;
  Vec2* grid = nullptr;
  std::uint8_t* picture = nullptr;

  Status set_up(const void* table, std::size_t bytes, Arena& arena);
  Status fit();
  Status frame(int k, DigestRun* out);
};

Status Run::set_up(const void* table, std::size_t bytes, Arena& arena) {
  Status status = Model::open(table, bytes, &model);
  if (status != Status::ok) return status;
  FitLimits fit_limits;
  fit_limits.points = 100;
  TrackerLimits limits;
  limits.width = kWidth;
  limits.height = kHeight;
  limits.patches = 200;  // enough visible ones for a first pass
  limits.markers = 1;
  limits.vertices = 200;
  limits.curve_points = 0;
  limits.personal_field = {};
  status = create_in(arena, cascade, model);
  if (status == Status::ok) status = create_in(arena, fitter, model, fit_limits);
  if (status == Status::ok) status = create_in(arena, tracker, model, limits);
  if (status != Status::ok) return status;
  const std::size_t parameters = model.parameters().count;
  truth = arena.take_span<float>(parameters);
  q = arena.take_span<float>(parameters);
  sd = arena.take_span<float>(parameters);
  points = arena.take_span<Correspondence>(model.landmarks().count);
  grid = arena.take<Vec2>((kSquares + 1) * (kSquares + 1));
  picture = arena.take<std::uint8_t>(kWidth * kHeight);
  if (arena.exhausted()) return Status::out_of_memory;
  for (std::size_t k = 0; k < parameters; ++k) truth[k] = q[k] = 0;
  for (std::size_t k = 0; k < subject.identities; ++k) truth[k] = random.uniform(-1.5f, 1.5f);
  return Status::ok;
}

/// With noise, a few gross errors, and the focal length unknown.
Status Run::fit() {
  const Projector projector(view_of(pose, camera), true);
  for (std::size_t k = 0; k < points.count; ++k) {
    const Landmark& l = model.landmarks()[k];
    points[k] = Correspondence{l.uv(), {}};
    if (!projector.project(cascade.surface_point(points[k].uv, truth.data), &points[k].x))
      return Status::underdetermined;
    const float dx = 0.3f * random.normal();  // one by one: the order of evaluation of arguments is open
    points[k].x = points[k].x + Vec2{dx, 0.3f * random.normal()};
    if (k % 9 == 4) points[k].x.x += 25;
  }
  FitOptions options;
  options.width = kWidth;
  options.height = kHeight;
  FitReport report;
  const Status status = fitter.fit(points, options, q.data, &report, {sd.data});
  digest.add(report.view);
  for (float v : q) digest.add(v);
  for (float v : sd) digest.add(v);
  return status;
}

/// Turns, a parameter that moves, a hand's worth of black over some frames.
Status Run::frame(int k, DigestRun* out) {
  const float s = static_cast<float>(k) / kDigestFrames;
  truth[subject.moved] = subject.reach * s;
  const Pose moved_pose{normalised(exp_rotation({0.1f * s, 0.25f * s, -0.1f * s}) * pose.q),
                        pose.t + Vec3{6 * s, 4 * s, 20 * s}};
  if (!draw(cascade, truth.data, view_of(moved_pose, camera), grid, picture)) return Status::underdetermined;
  if (k > 11 && k < 19)
    for (int i = 0; i < kWidth * kHeight; ++i)
      if (i % kWidth < 90 && i / kWidth > 90) picture[i] = 0;
  const FrameView view{
      picture, kWidth, kHeight, kWidth, 1, k * std::int64_t{40'000'000}, static_cast<std::uint32_t>(k)};
  FrameResult result;
  const Vec2 marker{100, 70};
  const Status status = k == 0
                            ? tracker.start_from_pose(view, camera, moved_pose, truth.data, {}, {&marker, 1})
                            : tracker.update(view, &result);
  if (status != Status::ok) return status;
  result = tracker.result();
  out->frames_tracked += result.state == TrackState::tracking;
  const Estimator& estimator = tracker.estimator();
  out->moved_error = magnitude(estimator.parameters()[subject.moved] - truth[subject.moved]);
  digest.add(estimator.view());
  for (float v : estimator.parameters()) digest.add(v);
  Vec2 x;
  if (tracker.marker(0, &x)) digest.add(x);
  digest.add(static_cast<float>(result.inliers));
  for (VertexId v : estimator.mesh().vertices()) digest.add(estimator.vertex_images()[v]);
  return Status::ok;
}

}  // namespace

DigestRun digest_run(const DigestSubject& subject, const void* table, std::size_t bytes, Arena& arena) {
  DigestRun out;
  Run* const made = arena.make<Run>();  // too large for a small stack
  if (made == nullptr) {
    out.status = Status::out_of_memory;
    return out;
  }
  Run& run = *made;
  run.subject = subject;
  out.status = run.set_up(table, bytes, arena);
  if (out.status == Status::ok) out.status = run.fit();
  for (int k = 0; k < kDigestFrames && out.status == Status::ok; ++k) out.status = run.frame(k, &out);
  out.digest = run.digest.value;
  return out;
}
