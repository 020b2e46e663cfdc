// Limits of a tracker: refused, or a tracker that runs; and starts that no picture has.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "aligned_block.hpp"
#include "face_film.hpp"
#include "model_builder.hpp"
#include "pliant/tracker.hpp"
#include "random.hpp"
#include "track/tracker_sizes.hpp"

namespace tracker_limits_test {

using namespace pliant;

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Status create(const TrackerLimits& limits, Tracker& tracker, AlignedBlock& block) {
  Arena arena(block.data(), block.size());
  return create_in(arena, tracker, baked_face().model, limits);
}

}  // namespace

TEST_CASE("limits of which no tracker can be made are refused, and measure nothing") {
  AlignedBlock block(1 << 22);
  const auto refused = [&](auto change) {
    TrackerLimits limits;
    change(limits);
    Tracker tracker;
    CHECK(check(limits) == Status::bad_argument);
    CHECK(create(limits, tracker, block) == Status::bad_argument);
    CHECK(measured_bytes<Tracker>(baked_face().model, limits) == 0);
  };
  refused([](TrackerLimits& l) { l.pyramid_levels = 0; });
  refused([](TrackerLimits& l) { l.pyramid_levels = 40; });
  refused([](TrackerLimits& l) { l.width = l.height = 65535; });
  refused([](TrackerLimits& l) { l.width = 63; });
  refused([](TrackerLimits& l) { l.height = 16385; });
  refused([](TrackerLimits& l) { l.region_width = 64; });
  refused([](TrackerLimits& l) { l.region_width = 320, l.region_height = 63; });
  refused([](TrackerLimits& l) { l.patch_window = 12; });
  refused([](TrackerLimits& l) { l.patch_window = 23; });
  refused([](TrackerLimits& l) { l.patch_margin = 17; });
  refused([](TrackerLimits& l) { l.patches = 7; });
  refused([](TrackerLimits& l) { l.patches = 16000, l.key_patches = 400; });
  refused([](TrackerLimits& l) { l.key_patches = 3; });
  refused([](TrackerLimits& l) { l.markers = 65535; });
  refused([](TrackerLimits& l) { l.personal_field = {1, 128}; });
  refused([](TrackerLimits& l) { l.personal_field = {128, 257}; });
  refused([](TrackerLimits& l) { l.start_points = 3; });
  refused([](TrackerLimits& l) { l.thumbnail_width = 257; });
  for (const TrackerLimits& l : {profile_s(), profile_m(), profile_l()}) CHECK(check(l) == Status::ok);
}

TEST_CASE("limits without room for the model's base mesh are refused, not found out in every frame") {
  AlignedBlock block(1 << 22);
  TrackerLimits limits;
  const auto least = static_cast<std::uint16_t>(baked_face().model.base_uv().count);
  for (const std::uint16_t vertices : {std::uint16_t{0}, static_cast<std::uint16_t>(least - 1)}) {
    limits.vertices = vertices;
    Tracker tracker;
    CHECK(check(limits) == Status::ok);
    CHECK(create(limits, tracker, block) == Status::bad_argument);
    CHECK(measured_bytes<Tracker>(baked_face().model, limits) == 0);
  }
  limits.vertices = least;
  Tracker tracker;
  CHECK(create(limits, tracker, block) == Status::ok);
}

TEST_CASE("a start with a few templates is refused, or the next frame is tracked") {
  const FaceFilm film(320, 240, 1, [](float, Pose&, auto&) {});
  AlignedBlock block(1 << 22);
  for (const bool has_edges : {false, true}) {
    const TrackerLimits limits = without_detection(has_edges ? profile_m() : without_edges(profile_m()));
    int refused = 0, started = 0;
    for (int k = 0; k < 90; ++k) {  // of the textured part of the picture: left to right, larger and larger
      const int side = 10 + 2 * (k / 5), left = 110 + 20 * (k % 5);
      std::vector<std::uint8_t> pixels(film.frames[0].size(), 128);
      for (int y = 120 - side / 2; y < 120 + side / 2; ++y)
        for (int x = left; x < left + side; ++x) {
          const auto at = static_cast<std::size_t>(320 * y + x);
          pixels[at] = film.frames[0][at];
        }
      FrameView view = film.view(0);
      view.data = pixels.data();
      Tracker tracker;
      REQUIRE(create(limits, tracker, block) == Status::ok);
      const Status status = tracker.start_from_pose(view, film.camera, film.poses[0], nullptr);
      ++(status == Status::ok ? started : refused);
      if (status != Status::ok) continue;
      CAPTURE(k);
      CAPTURE(tracker.result().tracked);
      view.time_ns += 33'000'000;
      ++view.sequence;
      FrameResult result;
      REQUIRE(tracker.update(view, &result) == Status::ok);
      CHECK(result.state == TrackState::tracking);
    }
    CHECK(refused > 20);
    CHECK(started > 20);
  }
}

TEST_CASE("random limits are refused or give a tracker that starts and tracks, or says why not") {
  const FaceFilm film(64, 64, 3, [](float s, Pose& pose, auto&) {
    pose.q = exp_rotation({0, 0.05f * s, 0});
  });
  Random random(11);
  AlignedBlock block(std::size_t{24} << 20);
  int made = 0, started = 0;
  for (int k = 0; k < 300; ++k) {
    const auto any = [&](int often, int most) { return random.below(4) == 0 ? random.below(most) : often; };
    TrackerLimits l;
    l.width = static_cast<std::uint16_t>(any(64, 200));
    l.height = static_cast<std::uint16_t>(any(64, 200));
    l.region_width = l.region_height = static_cast<std::uint16_t>(any(0, 80));
    l.patches = static_cast<std::uint16_t>(any(32, 400));
    l.key_patches = static_cast<std::uint16_t>(any(16, 400));
    l.key_frames = static_cast<std::uint8_t>(any(2, 256));
    l.markers = static_cast<std::uint16_t>(any(0, 50));
    l.curve_points = static_cast<std::uint16_t>(any(32, 300));
    l.silhouette_points = static_cast<std::uint16_t>(any(0, 100));
    l.vertices = static_cast<std::uint16_t>(any(512, 2000));
    l.pyramid_levels = static_cast<std::uint8_t>(any(3, 9));
    l.patch_window = static_cast<std::uint8_t>(any(11, 24));
    l.patch_margin = static_cast<std::uint8_t>(any(4, 20));
    l.keeps_templates = any(1, 2) != 0;
    l.keeps_previous = any(1, 2) != 0;
    l.copies_frame = any(1, 2) != 0;
    l.thumbnail_width = static_cast<std::uint16_t>(any(48, 300));
    l.free_parameters = static_cast<std::uint16_t>(any(0, 120));
    l.samples_per_point = static_cast<std::uint16_t>(any(0, 200));
    l.rejection_sample = static_cast<std::uint16_t>(any(256, 400));
    l.texture_cells = static_cast<std::uint8_t>(any(0, 256));
    if (any(0, 1) == 1) l.surface_texture = &kSurfaceTexture;
    l.mesh_following = any(1, 2) != 0 ? &kMeshFollowing : nullptr;
    l.personal_field.width = l.personal_field.height = static_cast<std::uint16_t>(any(0, 300));
    CAPTURE(k);
    Tracker tracker;
    const Status status = create(l, tracker, block);
    const bool is_usable = check(l) == Status::ok && l.vertices >= baked_face().model.base_uv().count;
    CHECK((status == Status::ok) == is_usable);
    if (status != Status::ok) continue;
    ++made;
    const FrameView first = film.view(0);
    const Status start = tracker.start_from_pose(first, film.camera, film.poses[0], nullptr);
    CHECK((start == Status::size_mismatch) == (l.width != first.width || l.height != first.height));
    if (start != Status::ok) continue;
    ++started;
    FrameResult result;
    for (std::size_t i = 1; i < 3; ++i) CHECK(tracker.update(film.view(i), &result) == Status::ok);
    CHECK(std::isfinite(result.rms_px));
  }
  CHECK(made > 50);
  CHECK(started > 20);
}

TEST_CASE("a pose, a camera or a box that no picture has is refused") {
  const FaceFilm film(320, 240, 1, [](float, Pose&, auto&) {});
  AlignedBlock block(1 << 22);
  Tracker tracker;
  REQUIRE(create({}, tracker, block) == Status::ok);
  const auto start = [&](auto change) {
    Pose pose = film.poses[0];
    Camera camera = film.camera;
    change(pose, camera);
    return tracker.start_from_pose(film.view(0), camera, pose, nullptr);
  };
  CHECK(start([](Pose&, Camera&) {}) == Status::ok);
  for (const float z : {1e-20f, 0.0f, -600.0f, 49.0f, 2e5f, 1e30f, kNan})
    CHECK(start([&](Pose& p, Camera&) { p.t.z = z; }) == Status::bad_argument);
  for (const Quat q : {Quat{0, 0, 0, 0}, Quat{1e20f, 0, 0, 0}, Quat{0.5f, 0, 0, 0}, Quat{1, kNan, 0, 0}})
    CHECK(start([&](Pose& p, Camera&) { p.q = q; }) == Status::bad_argument);
  for (const float far : {1e8f, -1e30f, kNan}) {
    CHECK(start([&](Pose& p, Camera&) { p.t.x = far; }) == Status::bad_argument);
    CHECK(start([&](Pose&, Camera& c) { c.cy = far; }) == Status::bad_argument);
    CHECK(start([&](Pose&, Camera& c) { c.f = far; }) == Status::bad_argument);
  }
  const struct {
    Vec2 corner, size;
  } boxes[] = {{{0, 0}, {1e30f, 1e30f}}, {{0, 0}, {0, 50}},   {{0, 0}, {kNan, 50}},  {{1e30f, 0}, {50, 50}},
               {{kNan, 0}, {50, 50}},    {{0, 0}, {50, -50}}, {{0, 0}, {1e-30f, 50}}};
  for (const auto& b : boxes) CHECK(tracker.start_from_box(film.view(0), b.corner, b.size) != Status::ok);
}

TEST_CASE("options out of their bounds are refused by every start, and the track goes on") {
  const FaceFilm film(320, 240, 2, [](float, Pose&, auto&) {});
  AlignedBlock block(1 << 22);
  Tracker tracker;
  REQUIRE(create({}, tracker, block) == Status::ok);
  const FrameView frame = film.view(0);
  REQUIRE(tracker.start_from_pose(frame, film.camera, film.poses[0], nullptr) == Status::ok);
  TrackerOptions fast, negative, unknown;
  fast.estimator.cue_scale_rate = 100;
  negative.marker_exclusion_px = -8;
  unknown.marker_exclusion_px = kNan;
  for (const TrackerOptions& bad : {fast, negative, unknown}) {
    CHECK(tracker.start_from_pose(frame, film.camera, film.poses[0], nullptr, bad) == Status::bad_argument);
    CHECK(tracker.start_from_box(frame, {100, 60}, {90, 90}, {}, bad) == Status::bad_argument);
    CHECK(tracker.start_by_detection({}, bad) != Status::ok);
  }
  FrameResult result;
  REQUIRE(tracker.update(film.view(1), &result) == Status::ok);
  CHECK(result.state == TrackState::tracking);
}

TEST_CASE("the largest limits: sizes that follow from them do not overflow") {
  // A constant expression has no overflow, or it is not compiled.
  constexpr auto largest = [] {
    TrackerLimits l =
        without_person(without_edges(without_detection(without_stretch(without_rejection(TrackerLimits{})))));
    l.width = l.height = 16384;
    l.patches = 16000;
    l.key_patches = 384;
    return l;
  }();
  static_assert(check(largest) == Status::ok);
  constexpr int side = cell_px_of(largest);
  CHECK(side >= kTemplatePlacementTuning.least_cell_px);
  CHECK(side <= kTemplatePlacementTuning.most_cell_px);
}

TEST_CASE("another detection is named in a constant, so that no other one is linked; the other limits stay") {
  constexpr TrackerLimits faces = with_detection(profile_s(), kUprightFaceDetection);
  static_assert(faces.detection == &kUprightFaceDetection);
  static_assert(check(faces) == Status::ok);
  const Model& model = baked_face().model;
  CHECK(measured_bytes<Tracker>(model, faces) == measured_bytes<Tracker>(model, profile_s()));
}

TEST_CASE("without the previous frame nothing is matched against it, whatever the cues say") {
  const FaceFilm film(320, 240, 8, [](float s, Pose& pose, auto& q) {
    pose.t.x += 15 * s;
    FaceFilm::set(q, "jawOpen", 0.4f * s);
  });
  TrackerLimits limits;
  limits.keeps_previous = false;
  Pose end[2];
  for (const bool with_flow : {false, true}) {
    InArena<Tracker> tracker(baked_face().model, limits);
    TrackerOptions options;
    const auto flow = static_cast<std::uint8_t>(1u << static_cast<unsigned>(Cue::flow));
    options.estimator.cues =
        static_cast<std::uint8_t>(with_flow ? options.estimator.cues | flow : options.estimator.cues & ~flow);
    REQUIRE(film.start_at_pose(tracker.object, 0, options) == Status::ok);
    FrameResult result;
    for (std::size_t k = 1; k < film.count(); ++k) {
      REQUIRE(tracker->update(film.view(k), &result) == Status::ok);
      CHECK(result.state == TrackState::tracking);
    }
    end[with_flow] = result.pose;
  }
  CHECK(end[0].q.y == end[1].q.y);
  CHECK(end[0].t.x == end[1].t.x);
  CHECK(end[0].t.z == end[1].t.z);
}

TEST_CASE("a limit on the samples of a point takes less memory, and refuses starts that need more") {
  const FaceFilm film(320, 240, 1, [](float, Pose&, auto&) {});
  const auto& model = baked_face().model;
  TrackerLimits all, enough, few;
  enough.samples_per_point = 60;
  few.samples_per_point = 3;
  CHECK(measured_bytes<Tracker>(model, enough) + 5000 < measured_bytes<Tracker>(model, all));
  CHECK(measured_bytes<Tracker>(model, few) < measured_bytes<Tracker>(model, enough));
  AlignedBlock block(1 << 22);
  Tracker tracker;
  REQUIRE(create(enough, tracker, block) == Status::ok);
  CHECK(film.start_at_pose(tracker) == Status::ok);
  REQUIRE(create(few, tracker, block) == Status::ok);
  CHECK(film.start_at_pose(tracker) == Status::capacity);
}

}  // namespace tracker_limits_test
