// The tracker's mesh while it tracks: it follows the view and the texture within its budget, and nobody notices.
#include <doctest/doctest.h>

#include <set>
#include <utility>

#include "face_film.hpp"
#include "model_builder.hpp"
#include "pliant/tracker.hpp"

namespace tracker_mesh_test {

using namespace pliant;

namespace {

constexpr std::uint16_t kBudget = 620, kOperations = 16;
constexpr std::size_t kFrames = 40;

/// A head that turns, of which one half has texture.
const FaceFilm& film() {
  static const FaceFilm* one = new FaceFilm(
      320, 240, kFrames,
      [](float s, Pose& pose, auto& q) {
        pose.q = exp_rotation({0, 0.4f * s, 0});
        FaceFilm::set(q, "jawOpen", 0.2f * s);
      },
      0.7f, 255);
  return *one;
}

TrackerLimits limits_with(std::uint8_t texture_cells) {
  TrackerLimits limits;
  limits.vertices = 700;
  if (texture_cells > 0) limits.surface_texture = &kSurfaceTexture;
  limits.texture_cells = texture_cells;
  return limits;
}

TrackerOptions options_with(std::uint16_t operations) {
  TrackerOptions options;
  options.estimator.mesh_error_mm = 0.8f;
  options.estimator.mesh_error_px = 0.3f;
  options.estimator.vertex_budget = kBudget;
  options.estimator.mesh_operations = operations;
  options.estimator.texture.shortest_edge_mm = 1.5f;
  return options;
}

Status start(Tracker& tracker, const TrackerOptions& options) {
  return film().start_at_truth(tracker, 0, options);
}

using Places = std::set<std::pair<float, float>>;

Places places_of(const Mesh& mesh) {
  Places out;
  for (VertexId v : mesh.vertices()) out.insert({mesh.uv(v).x, mesh.uv(v).y});
  return out;
}

int gone_or_new(const Places& before, const Places& now) {
  int n = 0;
  for (const auto& p : before) n += now.count(p) == 0;
  for (const auto& p : now) n += before.count(p) == 0;
  return n;
}

/// Vertices in the half of the chart that has texture, of all.
double fraction_in_texture(const Mesh& mesh) {
  int n = 0;
  for (VertexId v : mesh.vertices()) n += mesh.uv(v).x > 0.5f;
  return static_cast<double>(n) / mesh.vertex_count();
}

}  // namespace

TEST_CASE("in every frame the mesh keeps to its budget and to its operations, and is valid") {
  InArena<Tracker> tracker(baked_face().model, limits_with(32));
  REQUIRE(start(tracker.object, options_with(kOperations)) == Status::ok);
  const Mesh& mesh = tracker->estimator().mesh();
  CHECK(mesh.vertex_count() <= kBudget);
  Places before = places_of(mesh);
  int changed = 0;
  for (std::size_t k = 1; k < kFrames; ++k) {
    FrameResult result;
    REQUIRE(tracker->update(film().view(k), &result) == Status::ok);
    CHECK(result.state == TrackState::tracking);
    CHECK(result.vertices <= kBudget);
    CHECK(result.vertices == mesh.vertex_count());
    const Places now = places_of(mesh);
    CHECK(gone_or_new(before, now) <= kOperations);
    changed += gone_or_new(before, now);
    before = now;
  }
  CHECK(changed > 100);
  CHECK(mesh.validate().invariant == 0);
}

TEST_CASE("a changing mesh costs no tracked point and no accuracy") {
  InArena<Tracker> still(baked_face().model, limits_with(0)), adapts(baked_face().model, limits_with(32));
  REQUIRE(start(still.object, options_with(0)) == Status::ok);
  REQUIRE(start(adapts.object, options_with(kOperations)) == Status::ok);
  float error[2] = {};
  int seen[2] = {};
  for (std::size_t k = 1; k < kFrames; ++k) {
    Tracker* const trackers[2] = {&still.object, &adapts.object};
    for (int i = 0; i < 2; ++i) {
      FrameResult result;
      REQUIRE(trackers[i]->update(film().view(k), &result) == Status::ok);
      error[i] += film().landmark_error(*trackers[i], k) / (kFrames - 1);
      seen[i] += result.inliers;
    }
  }
  MESSAGE("landmark error: still " << error[0] << " px, adaptive " << error[1] << " px");
  CHECK(error[1] < 1.08f * error[0]);
  CHECK(seen[1] > 0.97 * seen[0]);
}

TEST_CASE("the mesh is finer where the picture has texture") {
  double fraction[2];
  for (int textured = 0; textured < 2; ++textured) {
    InArena<Tracker> tracker(baked_face().model, limits_with(textured ? 32 : 0));
    REQUIRE(start(tracker.object, options_with(kOperations)) == Status::ok);
    FrameResult result;
    for (std::size_t n = 1; n < 40; ++n) {  // the head stands still
      FrameView view = film().view(0);
      view.time_ns = static_cast<std::int64_t>(n) * 33'333'333;
      view.sequence = static_cast<std::uint32_t>(n);
      REQUIRE(tracker->update(view, &result) == Status::ok);
    }
    fraction[textured] = fraction_in_texture(tracker->estimator().mesh());
  }
  MESSAGE("fraction of the vertices in the textured half: " << fraction[0] << ", by texture " << fraction[1]);
  CHECK(fraction[0] < 0.53);
  CHECK(fraction[1] > fraction[0] + 0.05);
}

TEST_CASE("without room for texture, or with a score of the caller's own, none is noted") {
  InArena<Tracker> tracker(baked_face().model, limits_with(32));
  TrackerOptions options = options_with(kOperations);
  int asked = 0;
  options.estimator.texture.context = &asked;
  options.estimator.texture.score = [](void* context, Vec2) {
    ++*static_cast<int*>(context);
    return 0.0f;
  };
  REQUIRE(start(tracker.object, options) == Status::ok);
  CHECK(asked > 0);
  const std::size_t with = measured_bytes<Tracker>(baked_face().model, limits_with(32)),
                    less = measured_bytes<Tracker>(baked_face().model, limits_with(16));
  CHECK(with - less == 32 * 32 - 16 * 16);
  TrackerLimits none = limits_with(32);
  none.texture_cells = 0;
  CHECK(check(none) == Status::bad_argument);
}

}  // namespace tracker_mesh_test
