// Starts of the caller's, and start_by_detection, of a tracker that finds faces by itself. Detection and alignment are a fake that
// knows the truth.
#include <doctest/doctest.h>

#include <cstring>
#include <limits>
#include <string>

#include "fake_faces.hpp"
#include "model_builder.hpp"
#include "pliant/lens.hpp"
#include "track/start_fit.hpp"

namespace caller_start_test {

using namespace pliant;

namespace {

/// A face that drifts and opens its mouth.
const FaceFilm& film_of_face() {
  static const FaceFilm* film = new FaceFilm(
      320, 240, 8,
      [](float s, Pose& pose, auto& q) {
        pose.t.x = -0.2f * pose.t.z + 3 * s;
        FaceFilm::set(q, "jawOpen", 0.1f + 0.1f * s);
        FaceFilm::set(q, "faceWidth", 1.5f);
      },
      0.5f);
  return *film;
}

/// Tracks ten frames, the first one but if it was that of a start, and then has the track refused until it is given up.
/// \return number of the next frame; two are left.
std::size_t track_and_give_up(Tracker& tracker, const FaceFilm& film, FakeFaces& fake) {
  std::size_t k = tracker.is_started() ? 1 : 0;
  while (k < 10) update(tracker, film, k++);
  fake.verification = 0.05f;
  while (tracker.is_started() && k < film.frames.size()) update(tracker, film, k++);
  REQUIRE(k + 2 < film.frames.size());
  return k;
}

}  // namespace

TEST_CASE("a start from a box or from five points is refined where there are tables") {
  FakeFaces fake(film_of_face());
  const FaceFilm& film = film_of_face();
  InArena<Tracker> tracker(baked_face().model, limits_with_fake());
  const FaceBox box = fake.box(0);
  StartOptions start;
  start.box = BoxConvention::face_box;
  const Vec2 size{box.side, box.side};
  REQUIRE(tracker->start_from_box(film.view(0), box.center - 0.5f * size, size, start) == Status::ok);
  CHECK(film.landmark_error(tracker.object, 0) < 1.5f);
  CHECK(fake.alignments == 1);
  CHECK(tracker->result().landmark_error == doctest::Approx(0.02));
  std::vector<NamedPoint> five;
  for (const char* name : {"eye_right", "eye_left", "nose_tip", "mouth_right", "mouth_left"})
    five.push_back({name, film.truth(name, 0)});
  REQUIRE(tracker->start_from_landmarks(film.view(0), {five.data(), five.size()}) == Status::ok);
  CHECK(fake.alignments == 1);
  CHECK(fake.refinements == 1);
  CHECK(film.landmark_error(tracker.object, 0) < 1.5f);
}

TEST_CASE("a face box of a face that is farther than a pose can be has the model in its middle") {
  BakedModel& face = baked_face();
  const Camera camera = centred_camera(320, 240, 400);
  const Vec2 centre{100, 90};
  InArena<Cascade> cascade(face.model);
  StartPose start{camera, {}};
  FaceBox box;
  const Vec2 size{0.01f, 0.01f};
  REQUIRE(fit_to_box(cascade.object, {centre - 0.5f * size, size, BoxConvention::face_box}, 320, 240,
                     face.rest().data(), &start, &box) == Status::ok);
  Vec2 nose;
  REQUIRE(Projector(view_of(start.pose, camera), true).project(face.at("ibug30", face.rest()), &nose));
  CHECK(length(nose - centre) < 0.2f);
}

TEST_CASE("a box is where the lens shows the face") {
  BakedModel& face = baked_face();
  Camera camera = centred_camera(320, 240, 300);
  camera.k1 = -0.15f;
  Lens lens;
  REQUIRE(Lens::make(camera, 320, 240, &lens) == Status::ok);
  const auto fit = [&](const Camera& with, Vec2 corner, Vec2 size, BoxConvention convention, FaceBox* box) {
    InArena<Cascade> cascade(face.model);
    StartPose start{with, {}};
    REQUIRE(fit_to_box(cascade.object, {corner, size, convention}, 320, 240, face.rest().data(), &start,
                       box) == Status::ok);
    return start.pose;
  };
  const Vec2 centre{60, 50}, size{60, 60}, corner = centre - 0.5f * size;
  REQUIRE(length(lens.undistort(centre) - centre) > 2);
  FaceBox box;
  const auto middle_of = [&](const Pose& pose) {
    const Projector projector(view_of(pose, camera), true);
    Vec2 middle;
    for (const char* name : {"ibug36", "ibug45", "ibug48", "ibug54"}) {
      Vec2 x;
      REQUIRE(projector.project(face.at(name, face.rest()), &x));
      middle = middle + 0.25f * lens.distort(x);
    }
    return middle;
  };
  CHECK(length(middle_of(fit(camera, corner, size, BoxConvention::face_box, &box)) - centre) < 0.5f);
  CHECK(length(box.center - centre) < 1e-3f);
  CHECK(box.side == size.x);

  // Of the other conventions the pose is that of a pinhole which sees the box without the lens.
  const Pose seen = fit(camera, corner, size, BoxConvention::landmarks, &box);
  CHECK(length(box.center - middle_of(seen)) < 0.5f);
  const Vec2 ideal = lens.undistort(corner);
  FaceBox of_pinhole;
  const Pose pinhole = fit(centred_camera(320, 240, 300), ideal, lens.undistort(corner + size) - ideal,
                           BoxConvention::landmarks, &of_pinhole);
  CHECK(length(seen.t - pinhole.t) < 1e-3f);
  CHECK(box.side < of_pinhole.side);
}

TEST_CASE("boxes of all conventions, of one face, give about the same pose, with and without tables") {
  const FaceFilm& film = film_of_face();
  FakeFaces fake(film);
  const FaceBox box = fake.box(0);
  Vec2 low{1e9f, 1e9f}, high{-1e9f, -1e9f};
  for (int k = 0; k < 68; ++k) {
    const Vec2 x = film.truth((k < 10 ? "ibug0" : "ibug") + std::to_string(k), 0);
    low = min(low, x);
    high = max(high, x);
  }
  const Vec2 size = high - low;
  // Of OpenCV's square the middle of the forehead and a place just above the chin are known.
  const float side = size.x / kStartFitTuning.opencv_size, forehead = low.y - 0.23f * side;
  REQUIRE(high.y > forehead + side);
  struct Given {
    BoxConvention convention;
    Vec2 corner, size;
    float most_px;  // without tables: the model at rest, of a face that is wider and opens its mouth
  };
  const Given given[] = {
      {BoxConvention::landmarks, low, size, 7},
      {BoxConvention::opencv, {0.5f * (low.x + high.x - side), forehead}, {side, side}, 9},
      {BoxConvention::face_box, box.center - 0.5f * Vec2{box.side, box.side}, {box.side, box.side}, 4}};
  for (const bool has_tables : {false, true}) {
    InArena<Tracker> tracker(baked_face().model,
                             has_tables ? limits_with_fake() : without_detection(TrackerLimits{}));
    for (const Given& g : given) {
      CAPTURE(has_tables);
      CAPTURE(static_cast<int>(g.convention));
      StartOptions start;
      start.camera = &film.camera;
      start.box = g.convention;
      REQUIRE(tracker->start_from_box(film.view(0), g.corner, g.size, start) == Status::ok);
      CHECK(film.landmark_error(tracker.object, 0) < (has_tables ? 1.5f : g.most_px));
    }
  }
}

/// A turned face that is gone from frame 20 on: its track is given up before frame 30.
FaceFilm film_of_turned_face() {
  return FaceFilm(
      320, 240, 40,
      [](float s, Pose& pose, auto&) {
        const auto k = static_cast<std::size_t>(s * 39 + 0.5f);
        pose.q = exp_rotation({0, 0, 0.5f});
        if (k >= 20) pose.t.x = 50 * pose.t.z;
      },
      0.5f);
}

TEST_CASE("after a track a face is expected at its turn, until the caller asks for a search") {
  const FaceFilm film = film_of_turned_face();
  FakeFaces fake(film);
  InArena<Tracker> tracker(baked_face().model, limits_with_fake());
  for (std::size_t k = 0; k < 30; ++k) update(tracker.object, film, k);
  REQUIRE_FALSE(tracker->is_started());
  CHECK(fake.expected.z > 0.2f);
  REQUIRE(tracker->start_by_detection() == Status::ok);
  update(tracker.object, film, 30);
  CHECK(fake.expected.z == 0);
}

TEST_CASE("a start that fails forgets the turn and the place of the track before") {
  const FaceFilm film = film_of_turned_face();
  const std::vector<NamedPoint> one_spot(kFaceSearchTuning.enough_points, {"ibug30", {150, 100}});
  for (const bool from_box : {true, false}) {
    CAPTURE(from_box);
    FakeFaces fake(film);
    TrackerLimits limits = limits_with_fake();
    limits.search_work = kFaceSearchTuning.cells_for_both - 1;  // a search that begins at the place
    fake.calls_a_search = 2;
    InArena<Tracker> tracker(baked_face().model, limits);
    std::size_t k = 0;
    do update(tracker.object, film, k++);
    while (k < 20 || tracker->is_started());
    REQUIRE(k <= 30);
    const Status failed = from_box ? tracker->start_from_box(film.view(k), {-500, -500}, {60, 60})
                                   : tracker->start_from_landmarks(film.view(k), {one_spot.data(), one_spot.size()});
    REQUIRE(failed != Status::ok);
    REQUIRE_FALSE(tracker->is_started());
    fake.searches = 0;
    update(tracker.object, film, k + 1);
    CHECK(fake.expected.z == 0);
    CHECK(fake.searches == 1);
  }
}

TEST_CASE("who starts from a pose without landmark offsets gets none of another person who is found") {
  const FaceFilm film(
      320, 240, 40, [](float, Pose& pose, auto&) { pose.t.x = -0.2f * pose.t.z; }, 0.5f);
  for (const bool keeps : {true, false}) {
    CAPTURE(keeps);
    FakeFaces fake(film);
    fake.covered_frames = film.frames.size();
    fake.lowered_px = 5;        // of the mouth, against the model
    fake.covered_error = 0.2f;  // not the person of the start
    InArena<Tracker> tracker(baked_face().model, limits_with_fake());
    TrackerOptions options;
    options.keeps_landmark_offsets = keeps;
    REQUIRE(film.start_at_truth(tracker.object, 0, options) == Status::ok);
    std::size_t k = track_and_give_up(tracker.object, film, fake);
    fake.verification = 0.99f;
    while (k < film.frames.size() && !tracker->is_started()) update(tracker.object, film, k++);
    REQUIRE(tracker->is_started());
    CHECK(tracker->person_number() == 2);
    const Projector projector(tracker->estimator().view(), true);
    const Span<const float> q = tracker->parameters();
    Vec2 x, of_model;
    REQUIRE(tracker->landmark("ibug57", &x) == Status::ok);
    REQUIRE(projector.project(baked_face().at("ibug57", {q.begin(), q.end()}), &of_model));
    CHECK((length(x - of_model) > 2) == keeps);
  }
}

TEST_CASE("start_by_detection ends a track, forgets the person and keeps its options") {
  FakeFaces fake(film_of_face());
  const FaceFilm& film = film_of_face();
  InArena<Tracker> tracker(baked_face().model, limits_with_fake());
  for (std::size_t k = 0; k < 6; ++k) update(tracker.object, film, k);
  StartOptions start;
  start.camera = &film.camera;
  std::vector<std::uint8_t> is_free(baked_face().model.parameters().count, 0);
  TrackerOptions options;
  options.keeps_landmark_offsets = false;
  options.is_free = is_free.data();
  const std::vector<float> last(tracker->parameters().begin(), tracker->parameters().end());
  REQUIRE(tracker->start_by_detection(start, options) == Status::ok);
  CHECK(std::equal(last.begin(), last.end(), tracker->parameters().begin()));
  is_free.assign(is_free.size(), 1);  // it was read
  CHECK_FALSE(tracker->is_started());
  CHECK(tracker->result().state == TrackState::lost);
  const int held = fake.held_alignments;
  const FrameResult result = update(tracker.object, film, 6);
  CHECK(result.state == TrackState::tracking);
  CHECK(fake.held_alignments == held);
  CHECK(tracker->camera().f == film.camera.f);
  float before, after;
  REQUIRE(tracker->parameter("jawOpen", &before) == Status::ok);
  update(tracker.object, film, 7);
  REQUIRE(tracker->parameter("jawOpen", &after) == Status::ok);
  CHECK(before == after);
  Camera bad = film.camera;
  bad.k1 = -5;
  start.camera = &bad;
  CHECK(tracker->start_by_detection(start) == Status::bad_argument);
  start.camera = nullptr;
  for (const float focal :
       {-1.0f, 1e30f, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    start.focal_px = focal;
    CHECK(tracker->start_by_detection(start) == Status::bad_argument);
  }
  CHECK(tracker->is_started());
}

TEST_CASE("a start that fails forgets the person: the next one is not held to its parameters") {
  const FaceFilm film(
      320, 240, 40, [](float, Pose& pose, auto&) { pose.t.x = -0.2f * pose.t.z; }, 0.5f);
  FakeFaces fake(film);
  InArena<Tracker> tracker(baked_face().model, limits_with_fake());
  std::size_t k = track_and_give_up(tracker.object, film, fake);
  const std::vector<std::uint8_t> grey(320 * 240, 90);
  FrameView nothing = film.view(k++);
  nothing.data = grey.data();
  CHECK(tracker->start_from_box(nothing, {200, 60}, {60, 60}) == Status::too_few_points);
  fake.verification = 0.99f;
  const int held = fake.held_alignments;
  update(tracker.object, film, k);
  CHECK(tracker->is_started());
  CHECK(fake.held_alignments == held);
}

TEST_CASE("a start whose fit fails forgets the person, too") {
  const FaceFilm film(
      320, 240, 40,
      [](float, Pose& pose, auto& q) {
        pose.t.x = -0.2f * pose.t.z;
        FaceFilm::set(q, "faceWidth", 1.5f);
      },
      0.5f);
  FakeFaces fake(film);
  InArena<Tracker> tracker(baked_face().model, limits_with_fake());
  std::size_t k = track_and_give_up(tracker.object, film, fake);
  const std::vector<NamedPoint> one_spot(8, {"ibug30", {150, 100}});
  CHECK(tracker->start_from_landmarks(film.view(k++), {one_spot.data(), one_spot.size()}) ==
        Status::underdetermined);
  fake.verification = 0.99f;
  const int held = fake.held_alignments;
  update(tracker.object, film, k);
  REQUIRE(tracker->is_started());
  CHECK(fake.held_alignments == held);
  float width;
  REQUIRE(tracker->parameter("faceWidth", &width) == Status::ok);
  CHECK(width == 1.5f);
}

TEST_CASE("after start_by_detection a stream may begin again, with earlier times") {
  FakeFaces fake(film_of_face());
  const FaceFilm& film = film_of_face();
  InArena<Tracker> tracker(baked_face().model, limits_with_fake());
  for (std::size_t k = 0; k < 6; ++k) update(tracker.object, film, k);
  FrameResult result;
  CHECK(tracker->update(film.view(0), &result) == Status::stale_frame);
  REQUIRE(tracker->start_by_detection() == Status::ok);
  CHECK(update(tracker.object, film, 0).state == TrackState::tracking);
  CHECK(tracker->update(film.view(0), &result) == Status::stale_frame);
}

TEST_CASE("after a start that failed a stream may begin again, with earlier times") {
  FakeFaces fake(film_of_face());
  const FaceFilm& film = film_of_face();
  const std::vector<std::uint8_t> grey(320 * 240, 90);
  FrameView nothing = film.view(0);
  nothing.data = grey.data();
  const std::vector<NamedPoint> one_spot(8, {"ibug30", {150, 100}});
  for (int kind = 0; kind < 3; ++kind) {
    CAPTURE(kind);
    InArena<Tracker> tracker(baked_face().model, limits_with_fake());
    for (std::size_t k = 0; k < 6; ++k) update(tracker.object, film, k);
    if (kind == 0)
      CHECK(tracker->start_from_pose(nothing, film.camera, film.poses[0], nullptr) == Status::too_few_points);
    if (kind == 1) CHECK(tracker->start_from_box(nothing, {200, 60}, {60, 60}) == Status::too_few_points);
    if (kind == 2)
      CHECK(tracker->start_from_landmarks(nothing, {one_spot.data(), one_spot.size()}) ==
            Status::underdetermined);
    FrameResult result;
    CHECK(tracker->update(film.view(0), &result) == Status::ok);
    CHECK(tracker->update(film.view(0), &result) == Status::stale_frame);
    CHECK(tracker->update(film.view(1), &result) == Status::ok);
  }
}

TEST_CASE("what is told before the first frame, and after a start that failed, is a search") {
  FakeFaces fake(film_of_face());
  const FaceFilm& film = film_of_face();
  InArena<Tracker> tracker(baked_face().model, limits_with_fake());
  CHECK(tracker->result().is_searching);
  CHECK(tracker->result().state == TrackState::lost);
  for (std::size_t k = 0; k < 3; ++k) update(tracker.object, film, k);
  CHECK_FALSE(tracker->result().is_searching);
  const std::vector<std::uint8_t> grey(320 * 240, 90);
  FrameView view = film.view(3);
  view.data = grey.data();
  fake.score = fake.verification = 0;
  CHECK(tracker->start_from_box(view, {100, 60}, {100, 100}) == Status::too_few_points);
  CHECK_FALSE(tracker->is_started());
  CHECK(tracker->result().is_searching);
  CHECK(tracker->result().state == TrackState::lost);
  CHECK(tracker->result().tracked == 0);
  CHECK(tracker->work().searches == 0);
}

TEST_CASE("where a start fails in the picture, its camera and options are those of the search") {
  const FaceFilm& film = film_of_face();
  FakeFaces fake(film);
  InArena<Tracker> tracker(baked_face().model, limits_with_fake());
  const std::vector<std::uint8_t> grey(std::size_t{320} * 240, 90);
  FrameView nothing = film.view(0);
  nothing.data = grey.data();
  nothing.stride_bytes = static_cast<std::size_t>(nothing.width);
  Camera camera = film.camera;
  camera.f *= 1.25f;
  StartOptions start;
  start.camera = &camera;
  TrackerOptions options;
  options.estimator.smooths = true;
  REQUIRE(tracker->start_from_box(nothing, {100, 60}, {90, 90}, start, options) == Status::too_few_points);
  const FrameResult result = update(tracker.object, film, 1);
  REQUIRE(tracker->is_started());
  CHECK(tracker->camera().f == camera.f);
  CHECK(result.smoothed_pose.t.z == result.pose.t.z);
}

TEST_CASE("a start from landmarks whose camera is none leaves the search that of the start before") {
  const FaceFilm& film = film_of_face();
  FakeFaces fake(film);
  InArena<Tracker> tracker(baked_face().model, limits_with_fake());
  const std::vector<NamedPoint> one_spot(8, {"ibug30", {150, 100}});
  Camera wide = film.camera, far = film.camera;
  wide.aspect = 7;
  far.cx = 1e8f;
  std::size_t k = 0;
  for (const Camera& camera : {wide, far}) {
    StartOptions start;
    start.focal_px = 1.25f * film.camera.f;
    REQUIRE(tracker->start_by_detection(start) == Status::ok);
    const float focal = start.focal_px;
    start.camera = &camera;
    CHECK(tracker->start_from_landmarks(film.view(k++), {one_spot.data(), one_spot.size()}, start) ==
          Status::bad_argument);
    CHECK_FALSE(tracker->is_started());
    update(tracker.object, film, k++);
    REQUIRE(tracker->is_started());
    CHECK(tracker->camera().f == focal);
  }
}

TEST_CASE("limits that a found face does not fit are told by the frame that shows it") {
  const FaceFilm& film = film_of_face();
  FakeFaces fake(film);
  TrackerLimits limits = limits_with_fake();
  limits.free_parameters = 5;
  InArena<Tracker> tracker(baked_face().model, limits);
  FrameResult result;
  CHECK(tracker->update(film.view(0), &result) == Status::capacity);
  CHECK_FALSE(tracker->is_started());
}

TEST_CASE(
    "results do not depend on what the memory held, also where a part of the face is behind the camera") {
  const FaceFilm& film = film_of_face();
  const Model& model = baked_face().model;
  TrackerLimits limits = without_detection(TrackerLimits{});
  limits.region_width = limits.region_height = 192;
  const Camera near_camera{150.0f * 55 / 130, 159.5f, 119.5f};
  const std::size_t bytes = measured_bytes<Tracker>(model, limits);
  std::vector<float> seen[2];
  for (const int fill : {0, 0x43}) {
    AlignedBlock block(bytes);
    std::memset(block.data(), fill, bytes);
    Arena arena(block.data(), bytes);
    Tracker tracker;
    REQUIRE(create_in(arena, tracker, model, limits) == Status::ok);
    std::vector<float>& out = seen[fill != 0];
    const Status status = tracker.start_from_pose(film.view(0), near_camera, {{}, {0, 0, 55}}, nullptr);
    out.push_back(static_cast<float>(status));
    for (std::size_t k = 1; status == Status::ok && k < 4; ++k) {
      const FrameResult result = update(tracker, film, k);
      out.insert(out.end(), {result.pose.q.x, result.pose.q.y, result.pose.t.x, result.pose.t.z});
    }
    const PixelBox region = tracker.region();
    out.insert(out.end(), {static_cast<float>(region.x0), static_cast<float>(region.y0)});
    for (std::size_t k = 0; k < tracker.patch_count(); ++k)
      if (Vec2 x; tracker.patch(k, &x)) out.insert(out.end(), {x.x, x.y});
  }
  CHECK(seen[0].size() > 10);
  CHECK((seen[0] == seen[1]));
}

TEST_CASE("search and tracking share their memory; detection without tables costs nothing") {
  TrackerLimits none = without_detection(TrackerLimits{});
  const Model& model = baked_face().model;
  REQUIRE(model.detector().empty());
  const std::size_t tracking = measured_bytes<Tracker>(model, none);
  constexpr std::size_t kThumbnail = 80 * 60;  // of the last frame, for cuts
  CHECK(measured_bytes<Tracker>(model, TrackerLimits{}) <=
        tracking + model.parameters().count + 16 + kThumbnail);
  FakeFaces fake(film_of_face());
  CHECK(measured_bytes<Tracker>(model, limits_with_fake()) < tracking + 4096);
  CHECK(measured_bytes<Tracker>(model, none) == tracking);
  InArena<Tracker> tracker(model, none);
  FrameResult result;
  CHECK(tracker->update(film_of_face().view(0), &result) == Status::not_started);
  CHECK(tracker->start_by_detection() == Status::not_found);
}

}  // namespace caller_start_test
