// What stays of a printed surface from one track to the next, and what a new start forgets: landmark offsets, markers, camera.
#include <doctest/doctest.h>

#include "host/bake/bake.hpp"
#include "obj_folder.hpp"
#include "print_film.hpp"

namespace print_again_test {

using namespace pliant;
using namespace pliant::host;

namespace {

constexpr const char* kNames[] = {"a", "b", "c", "d", "middle"};

/// A curved label with the print of the sheet, and landmarks at its corners and in its middle.
const std::vector<std::uint8_t>& label_bytes() {
  static const auto* baked = [] {
    const obj_folder::ObjFolder folder("label");
    folder.write("neutral", obj_folder::Shape([](float s, float t) {
                   return Vec3{300 * (s - 0.5f), 240 * (t - 0.5f), 60 * s * (1 - s)};
                 }));
    folder.put("landmarks.csv", std::string("landmark,vertex\na,0\nb,32\nc,1056\nd,1088\nmiddle,544\n"));
    bake::BakeOptions options;
    options.source = folder.path.string();
    options.texture = PLIANT_FIXTURES "/sheet/print.png";
    auto* bytes = new std::vector<std::uint8_t>;
    std::string error;
    REQUIRE_MESSAGE(bake::bake(options, *bytes, error), error);
    return bytes;
  }();
  return *baked;
}

const Model& label() {
  static const auto* opened = new bake::OpenedTable(label_bytes());
  REQUIRE(opened->status() == Status::ok);
  return opened->model();
}

const Pose kPose = posed(0.1f, 0.2f, 0, 0.8f);

Image picture(std::uint32_t seed, const Pose& pose = kPose, const Camera& camera = kCamera) {
  static auto* scene = new Scene(label(), kWidth, kHeight);
  Image image = scene->draw(nullptr, pose, camera, make_background(kWidth, kHeight, 3));
  add_noise(image, 2, seed);
  return image;
}

/// Shows the label until it is tracked.
void find(Film& film, const Pose& pose = kPose, const Camera& camera = kCamera) {
  for (int k = 0; k < 6 && !film.tracker->is_started(); ++k)
    REQUIRE(film.show(picture(film.count, pose, camera)) == Status::ok);
  REQUIRE(film.tracker->is_started());
}

/// Shows other pictures until the track is given up.
void lose(Film& film) {
  const Image empty = make_background(kWidth, kHeight, 7);
  for (int k = 0; k < 12 && film.tracker->is_started(); ++k) REQUIRE(film.show(empty) == Status::ok);
  REQUIRE_FALSE(film.tracker->is_started());
}

/// Where a pose and a camera have a landmark, px.
Vec2 truth(const char* name, const Pose& pose, const Camera& camera) {
  static auto* cascade = new InArena<Cascade>(label());
  const Landmark& l = label().landmarks()[label().find_landmark(name)];
  Vec2 x;
  REQUIRE(
      Projector(pliant::view_of(pose, camera), true).project((*cascade)->surface_point(l.uv(), nullptr), &x));
  return x;
}

/// Distance of a landmark from there.
float landmark_error(Film& film, const char* name) {
  Vec2 x;
  REQUIRE(film.tracker->landmark(name, &x) == Status::ok);
  return length(x - truth(name, kPose, kCamera));
}

/// The next frame of a film, for a start.
FrameView view(const Image& image, Film& film) {
  ++film.count;
  return {image.pixels.data(), kWidth, kHeight, std::size_t{kWidth}, 1, film.count * std::int64_t{33333333},
          film.count};
}

}  // namespace

TEST_CASE("landmarks of a surface that a new tracker finds by itself are where the model has them") {
  Film film(label());
  find(film);
  for (const char* name : kNames) CHECK(landmark_error(film, name) < 3);
}

TEST_CASE("start_by_detection forgets where the landmarks of a printed surface were placed") {
  Film film(label());
  find(film);
  Vec2 x;
  REQUIRE(film.tracker->landmark("middle", &x) == Status::ok);
  const NamedPoint beside{"middle", x + Vec2{30, 0}};
  REQUIRE(film.tracker->place_landmarks({&beside, 1}) == Status::ok);
  CHECK(landmark_error(film, "middle") > 25);
  REQUIRE(film.tracker->start_by_detection() == Status::ok);
  find(film);
  CHECK(landmark_error(film, "middle") < 3);
}

TEST_CASE("a start from landmarks that fails leaves no landmark offsets to the track that follows") {
  Film film(label());
  std::vector<NamedPoint> points;
  for (const char* name : kNames) {
    const Vec2 off{points.size() % 2 == 0 ? -6.0f : 6.0f, points.size() % 3 == 0 ? -5.0f : 5.0f};
    points.push_back({name, truth(name, kPose, kCamera) + off});
  }
  const Image grey(kWidth, kHeight, 1, 90);
  CHECK(film.tracker->start_from_landmarks(view(grey, film), {points.data(), points.size()}) ==
        Status::too_few_points);
  find(film);
  for (const char* name : kNames) CHECK(landmark_error(film, name) < 3);
}

TEST_CASE(
    "markers of a surface that is found again are where they were, and no template is captured near them") {
  TrackerLimits limits;
  limits.markers = 3;
  Film film(label(), limits);
  const Vec2 markers[] = {{160, 120}, {130, 100}, {190, 140}};
  TrackerOptions options;
  options.marker_exclusion_px = 12;
  const Image first = picture(0);
  REQUIRE(film.tracker->start_from_pose(view(first, film), kCamera, kPose, nullptr, options, {markers, 3}) ==
          Status::ok);
  for (int k = 0; k < 6; ++k) REQUIRE(film.show(picture(film.count)) == Status::ok);
  lose(film);
  find(film);
  for (std::size_t k = 0; k < 3; ++k) {
    Vec2 at;
    REQUIRE(film.tracker->marker(k, &at));
    CHECK(length(at - markers[k]) < 2);
    for (std::size_t p = 0; p < film.tracker->patch_count(); ++p) {
      Vec2 x;
      if (film.tracker->patch(p, &x)) CHECK(length(x - at) >= 12);
    }
  }
}

TEST_CASE("a start of the caller's that fails forgets the markers of the track before") {
  TrackerLimits limits;
  limits.markers = 1;
  Film film(label(), limits);
  const Vec2 marker{160, 120};
  const Image first = picture(0);
  REQUIRE(film.tracker->start_from_pose(view(first, film), kCamera, kPose, nullptr, {}, {&marker, 1}) ==
          Status::ok);
  for (int k = 0; k < 6; ++k) REQUIRE(film.show(picture(film.count)) == Status::ok);
  lose(film);
  const Image grey(kWidth, kHeight, 1, 90);
  CHECK(film.tracker->start_from_pose(view(grey, film), kCamera, kPose, nullptr) == Status::too_few_points);
  find(film);
  Vec2 at;
  CHECK_FALSE(film.tracker->marker(0, &at));
}

TEST_CASE("the focal length that a start from landmarks has found stays where the surface is found again") {
  Film film(label());
  const Camera wide = centred_camera(kWidth, kHeight, 300);
  const Pose pose = posed(0.5f, 0.4f, 0, 0.55f);
  std::vector<NamedPoint> points;
  for (const char* name : kNames) points.push_back({name, truth(name, pose, wide)});
  const Image first = picture(0, pose, wide);
  REQUIRE(film.tracker->start_from_landmarks(view(first, film), {points.data(), points.size()}) ==
          Status::ok);
  const float focal = film.tracker->camera().f;
  CHECK(magnitude(focal - wide.f) < 30);
  for (int k = 0; k < 4; ++k) REQUIRE(film.show(picture(film.count, pose, wide)) == Status::ok);
  lose(film);
  find(film, pose, wide);
  CHECK(film.tracker->camera().f == focal);
  CHECK(film.turned_from(pose) < 0.05f);
  REQUIRE(film.tracker->start_by_detection() == Status::ok);
  find(film, pose, wide);
  CHECK(film.tracker->camera().f == kDefaultFocalRatio * kWidth);
}

TEST_CASE(
    "the state of a surface without parameters is saved, and starts another tracker, without an array for "
    "them") {
  Film first(label()), second(label());
  find(first);
  SavedState state;
  REQUIRE(first.tracker->save(&state) == Status::ok);
  const Image same = picture(first.count - 1);
  REQUIRE(second.tracker->start_from_state(view(same, second), state) == Status::ok);
  CHECK(length(second.tracker->result().pose.t - first.result.pose.t) < 1e-3f);
  Film bending(sheet());
  while (!bending.tracker->is_started())
    REQUIRE(bending.show(picture_of(posed(0.1f, 0.1f, 0, 1), kRest, bending.count)) == Status::ok);
  CHECK(bending.tracker->save(&state) == Status::bad_argument);
  state.parameters.count = kRest.size();
  CHECK(bending.tracker->save(&state) == Status::bad_argument);
}

TEST_CASE(
    "a printed surface that is hidden for some frames is tracked on, and given up when it stays hidden") {
  Film film(label());
  find(film);
  for (int k = 0; k < 3; ++k) REQUIRE(film.show(picture(film.count)) == Status::ok);
  const Image empty = make_background(kWidth, kHeight, 7);
  for (int k = 0; k < 3; ++k) {
    REQUIRE(film.show(empty) == Status::ok);
    CHECK(film.tracker->is_started());
    CHECK(film.result.state != TrackState::tracking);
  }
  for (int k = 0; k < 3; ++k) {
    REQUIRE(film.show(picture(film.count)) == Status::ok);
    CHECK(film.tracker->is_started());
  }
  CHECK(film.turned_from(kPose) < 0.02f);
  int hidden = 0;
  for (; hidden < 12 && film.tracker->is_started(); ++hidden) REQUIRE(film.show(empty) == Status::ok);
  CHECK(hidden == 4);
}

}  // namespace print_again_test
