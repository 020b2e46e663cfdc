// How a surface is followed while it is searched for: patches from frame to frame in thumbnails, places in small pictures.
#include "print/print_motion.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "print_film.hpp"
#include "random.hpp"

namespace print_motion_test {

using namespace pliant;
using namespace pliant::host;

namespace {

constexpr float kDegree = 0.0174533f;

/// The scene turned about the middle of the picture, and shifted.
struct Motion {
  float degrees = 0;
  Vec2 shift;

  Vec2 moved(Vec2 x) const {
    const Vec2 middle{0.5f * kWidth, 0.5f * kHeight}, d = x - middle;
    const float c = std::cos(degrees * kDegree), s = std::sin(degrees * kDegree);
    return middle + shift + Vec2{c * d.x - s * d.y, s * d.x + c * d.y};
  }
};

/// A picture without borders, as the camera sees it after the motion.
Image seen(const Image& scene, const Motion& motion) {
  Image image(kWidth, kHeight, 1);
  const Motion back{-motion.degrees, {}};
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const Vec2 at =
          back.moved(Vec2{static_cast<float>(x), static_cast<float>(y)} - motion.shift) + Vec2{100, 100};
      const int column = static_cast<int>(at.x), row = static_cast<int>(at.y);
      *image.at(x, y) = *scene.at(std::min(std::max(column, 0), scene.width - 1),
                                  std::min(std::max(row, 0), scene.height - 1));
    }
  return image;
}

FrameView view_of(const Image& image) {
  return {image.pixels.data(), image.width, image.height, static_cast<std::size_t>(image.width)};
}

struct Scene {
  Image picture = make_background(kWidth + 200, kHeight + 200, 5);
  InArena<SceneMotion> motion{kWidth, kHeight};

  void begin() { motion->begin(view_of(seen(picture, {}))); }
  void follow(const Motion& m) { motion->follow(view_of(seen(picture, m))); }
};

constexpr Vec2 kPlaces[] = {{160, 120}, {100, 90}, {220, 150}, {120, 160}, {200, 80}};

}  // namespace

TEST_CASE("places are followed to a few pixels while the scene shifts and turns, faster and faster") {
  const Motion steps[] = {{1, {3, 2}},      {2.2f, {7, 4}}, {3.6f, {13, 7}},
                          {5.2f, {21, 11}}, {7, {31, 16}},  {9, {43, 22}}};
  Scene scene;
  scene.begin();
  for (const Motion& step : steps) scene.follow(step);
  for (const Vec2 x : kPlaces) {
    Vec2 to;
    REQUIRE(scene.motion->moved(x, &to));
    CHECK(length(to - steps[5].moved(x)) < 4);
  }
}

TEST_CASE("a place stays where nothing moves, at the picture's rim too") {
  Scene scene;
  scene.begin();
  for (int k = 0; k < 5; ++k) scene.follow({});
  for (const Vec2 x : {Vec2{160, 120}, Vec2{0, 0}, Vec2{kWidth - 1, kHeight - 1}, Vec2{-50, 400}}) {
    Vec2 to;
    REQUIRE(scene.motion->moved(x, &to));
    CHECK(length(to - x) < 0.5f);
  }
}

TEST_CASE("what is not seen again is not followed: a flat frame, a cut to another picture") {
  const Image flat(kWidth, kHeight, 1, 90), other = make_background(kWidth, kHeight, 77);
  for (const Image* next : {&flat, &other}) {
    Scene scene;
    scene.begin();
    scene.motion->follow(view_of(*next));
    int followed = 0;
    for (const Vec2 x : kPlaces) {
      Vec2 to{1, 2};
      if (scene.motion->moved(x, &to))
        ++followed;
      else
        CHECK((to.x == 1 && to.y == 2));
    }
    CHECK(followed <= 1);
    scene.follow({});  // lost for good
    Vec2 to;
    if (next == &flat) CHECK_FALSE(scene.motion->moved(kPlaces[0], &to));
  }
}

TEST_CASE("frames of every size have patches, and as many as are told") {
  const struct { int width, height; } sizes[] = {{64, 64}, {8192, 64}, {64, 8192}, {320, 240}, {1920, 1080}};
  for (const auto& size : sizes) {
    InArena<SceneMotion> motion(size.width, size.height);
    const Image image = make_background(size.width, size.height, 2);
    motion->begin(view_of(image));
    motion->follow(view_of(image));
    const std::size_t patches = SceneMotion::patches(size.width, size.height);
    CHECK(patches >= 2);
    CHECK(patches <= 300);
    const SmallPictures shown = motion->pictures();
    CHECK(shown.before.width == shown.now.width);
    CHECK(static_cast<float>(shown.now.width) * shown.scale <= static_cast<float>(size.width));
  }
}

TEST_CASE("places of a sheet are found in small pictures, around where they are expected") {
  PrintTable table;
  REQUIRE(PrintTable::open(sheet().print(), &table) == Status::ok);
  struct Flat {
    Vec2 shift;
    static bool project(void* state, Vec2 uv, Vec2* x) {
      *x = Vec2{120, 60} + Vec2{80 * uv.x, 120 * uv.y} + static_cast<const Flat*>(state)->shift;
      return true;
    }
  };
  Scene scene;
  Random random(4);
  Image& grains = scene.picture;  // of 4 x 4 pixels
  for (int y = 0; y < grains.height; ++y)
    for (int x = 0; x < grains.width; ++x)
      *grains.at(x, y) = x % 4 > 0   ? *grains.at(x - 1, y)
                         : y % 4 > 0 ? *grains.at(x, y - 1)
                                     : static_cast<std::uint8_t>(random.below(256));
  const Image first = seen(scene.picture, {}), second = seen(scene.picture, {0, {9, -6}});
  Flat before{}, expected{{7, -5}}, far{{40, 30}};
  const SmallPictures shown{
      {first.pixels.data(), kWidth, kHeight, kWidth}, {second.pixels.data(), kWidth, kHeight, kWidth}, 1};
  Correspondence points[48];
  const std::size_t count =
      match_pictures(shown, table, {&before, Flat::project}, {&expected, Flat::project}, {points, 48});
  CHECK(count >= 24);
  for (std::size_t k = 0; k < count; ++k) {
    Vec2 x;
    Flat::project(&before, points[k].uv, &x);
    CHECK(length(points[k].x - x - Vec2{9, -6}) < 0.5f);
  }
  // Elsewhere grains look alike by chance.
  CHECK(4 * match_pictures(shown, table, {&before, Flat::project}, {&far, Flat::project}, {points, 48}) <
        count);
  CHECK(match_pictures(shown, table, {&before, Flat::project}, {&expected, Flat::project}, {points, 0}) == 0);
}

}  // namespace print_motion_test
