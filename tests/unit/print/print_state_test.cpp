// What a track by print says of itself: its state is that of the picture, and its templates are on the surface.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "print_film.hpp"
#include "printed_shapes.hpp"
#include "random.hpp"

namespace print_state_test {

using namespace pliant;
using namespace pliant::host;

namespace {

/// Columns from `first` to `end` are covered by squares of random grey.
Image covered(Image image, int first, int end) {
  Random random(11);
  constexpr int kSide = 5;
  for (int y = 0; y < kHeight; y += kSide)
    for (int x = first; x < end; x += kSide) {
      const auto grey = static_cast<std::uint8_t>(random.below(256));
      for (int j = y; j < std::min(kHeight, y + kSide); ++j)
        for (int i = x; i < std::min(end, x + kSide); ++i) *image.at(i, j) = grey;
    }
  return image;
}

/// Neighbouring columns are shifted against each other, up and down by `px`: no bending does that.
Image torn(const Image& image, float px) {
  Image out = image;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const float shift = px * std::sin(0.12f * static_cast<float>(x));
      const int from = y + static_cast<int>(std::floor(shift + 0.5f));
      *out.at(x, y) = *image.at(x, std::min(std::max(from, 0), kHeight - 1));
    }
  return out;
}

}  // namespace

TEST_CASE("a track is degraded or lost while the surface does what its shapes cannot, and recovers") {
  Film film(sheet());
  const Pose pose = posed(0.2f, 0.3f, 0, 0.9f);
  const auto show = [&](float px) {
    REQUIRE(film.show(torn(picture_of(pose, kRest, film.count), px)) == Status::ok);
    return film.result.state;
  };
  for (int k = 0; k < 8; ++k) show(0);
  CHECK(film.result.state == TrackState::tracking);
  for (int k = 1; k <= 24; ++k) show(0.5f * static_cast<float>(k));
  for (int k = 0; k < 6; ++k) CHECK(show(12) != TrackState::tracking);
  for (int k = 24; k >= 0; --k) show(0.5f * static_cast<float>(k));
  for (int k = 0; k < 8; ++k) show(0);
  CHECK(film.result.state == TrackState::tracking);
  CHECK(film.turned_from(pose) < 0.05f);
}

TEST_CASE(
    "a start by print behind something with texture takes no templates from that, and is degraded until the "
    "rest is seen") {
  Film film(sheet());
  const Pose pose = posed(0.1f, 0.2f, 0, 0.8f);
  constexpr int kFirst = 170, kEnd = 250;
  for (int k = 0; k < 6 && !film.tracker->is_started(); ++k)
    REQUIRE(film.show(covered(picture_of(pose, kRest, film.count), kFirst, kEnd)) == Status::ok);
  REQUIRE(film.tracker->is_started());
  CHECK(film.result.state == TrackState::degraded);
  std::size_t on_surface = 0, in_front = 0;
  for (std::size_t k = 0; k < film.tracker->patch_count(); ++k) {
    Vec2 x;
    if (!film.tracker->patch(k, &x)) continue;
    const bool is_covered = x.x > static_cast<float>(kFirst) && x.x < static_cast<float>(kEnd - 1);
    ++(is_covered ? in_front : on_surface);
  }
  CHECK(on_surface >= 20);
  CHECK(10 * in_front <= on_surface);
  for (int k = 0; k < 24; ++k) REQUIRE(film.show(picture_of(pose, kRest, film.count)) == Status::ok);
  CHECK(film.result.state == TrackState::tracking);
  CHECK(film.turned_from(pose) < 0.1f);
}

// What moves hides a fifth of the sheet: with a third, which starts are right is decided by chance. By the same rule 20 of 20
// were in time, 10 each with tables whose finest level is 640 and 672 px. None may be confirmed before it has moved.
TEST_CASE("a start by print behind something that moves on is confirmed when each part has been seen once") {
  constexpr int kFilms = 3, kMoves = 5;  // the frame in which it moves on
  Scene scene(sheet(), kWidth, kHeight);
  Random random(1);
  int in_time = 0;
  for (int k = 0; k < kFilms; ++k) {
    CAPTURE(k);
    Film film(sheet());
    const Pose pose = posed(random.uniform(-0.3f, 0.3f), random.uniform(-0.3f, 0.3f), random.uniform(0, 6.2831853f),
                            random.uniform(0.75f, 0.85f));
    const Image clean = scene.draw(kRest.data(), pose, kCamera, make_background(kWidth, kHeight, 3));
    int first_tracked = -1;
    for (int frame = 0; frame < 2 * kMoves; ++frame) {
      const int first = frame < kMoves ? 125 : 175;
      Image image = covered(clean, first, first + 24);
      add_noise(image, 2, static_cast<std::uint32_t>(20 * k + frame));
      REQUIRE(film.show(image) == Status::ok);
      if (first_tracked < 0 && film.result.state == TrackState::tracking) first_tracked = frame;
    }
    CHECK((first_tracked < 0 || first_tracked >= kMoves));
    in_time += first_tracked >= kMoves && film.turned_from(pose) < 0.1f;
  }
  CHECK(in_time >= 2);
}

TEST_CASE("a search that waits for further frames leaves the parameters of the last track as they are") {
  Film film(sheet());
  const Pose pose = posed(0.1f, 0.2f, 0, 0.8f);
  const std::vector<float> bent{1, 0.5f, 0}, otherwise{-1, 0, 0.3f};
  for (int k = 0; k < 6; ++k) REQUIRE(film.show(picture_of(pose, bent, film.count)) == Status::ok);
  const Image empty = make_background(kWidth, kHeight, 7);
  for (int k = 0; k < 12 && film.tracker->is_started(); ++k) REQUIRE(film.show(empty) == Status::ok);
  REQUIRE_FALSE(film.tracker->is_started());
  const std::vector<float> last(film.tracker->parameters().begin(), film.tracker->parameters().end());
  int waited = 0;
  for (; waited < 8; ++waited) {
    REQUIRE(film.show(covered(picture_of(pose, otherwise, film.count), 170, 250)) == Status::ok);
    if (film.tracker->is_started()) break;
    CHECK(std::equal(last.begin(), last.end(), film.tracker->parameters().begin()));
  }
  CHECK(waited > 0);
  CHECK(film.tracker->parameters()[0] < -0.5f);
}

TEST_CASE(
    "a curved surface is in state tracking from its first frame on, also where it is seen at a slant: a "
    "label, a cap") {
  const auto label = [](float s, float t) {
    const float a = 2.6f * (s - 0.5f);
    return Vec3{130 * std::sin(a), 300 * (t - 0.5f), 130 * std::cos(a) - 130};
  };
  for (const obj_folder::Shape& shape : {obj_folder::Shape(label), obj_folder::Shape(cap)}) {
    const std::vector<std::uint8_t> bytes = printed(shape);
    const bake::OpenedTable table(bytes);
    Scene scene(table.model(), kWidth, kHeight);
    Film film(table.model());
    int tracked = 0;
    for (int k = 0; k < 40; ++k) {
      const float turn = std::sin(0.1f * static_cast<float>(k));
      const Pose pose = posed(0.2f * turn, 0.5f * turn, 0.1f, 0.8f);
      Image image = scene.draw(nullptr, pose, kCamera, make_background(kWidth, kHeight, 3));
      add_noise(image, 2, film.count);
      REQUIRE(film.show(image) == Status::ok);
      if (film.result.state != TrackState::tracking) continue;
      ++tracked;
      CHECK(film.turned_from(pose) < 0.06f);
    }
    CHECK(tracked >= 38);
  }
}

}  // namespace print_state_test
