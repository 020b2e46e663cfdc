// Starts by print that are hard for what the surface is or stands before: closed surfaces, curved ones, dull prints before sharp
// pictures, pale ones.
#include <doctest/doctest.h>

#include <cmath>

#include "print/print_check.hpp"
#include "print_film.hpp"
#include "printed_shapes.hpp"
#include "random.hpp"

namespace print_surroundings_test {

using namespace pliant;
using namespace pliant::host;

namespace {

/// A can, printed all around. Its seam is at the back.
Vec3 can(float s, float t) {
  const float a = 6.2831853f * (s - 0.5f);
  return {90 * std::sin(a), 280 * (t - 0.5f), 90 * std::cos(a)};
}

/// A box, printed all around, 190 x 270 x 160 mm. Its seam is in the middle of the back.
Vec3 box(float s, float t) {
  const float at = 700 * s, y = 270 * (t - 0.5f);
  if (at < 95) return {-at, y, -80};
  if (at < 255) return {-95, y, at - 175};
  if (at < 445) return {at - 350, y, 80};
  if (at < 605) return {95, y, 525 - at};
  return {700 - at, y, -80};
}

/// Squares of random grey, sharper than any print.
Image squares(std::uint32_t seed) {
  Image image(kWidth, kHeight, 1);
  Random random(seed);
  constexpr int kSide = 7;
  for (int y = 0; y < kHeight; y += kSide)
    for (int x = 0; x < kWidth; x += kSide) {
      const std::uint8_t grey = random.below(2) == 0 ? 10 : 245;
      for (int k = 0; k < kSide * kSide; ++k)
        if (x + k % kSide < kWidth && y + k / kSide < kHeight) *image.at(x + k % kSide, y + k / kSide) = grey;
    }
  return image;
}

/// The picture of a sheet with little contrast before a background of much.
Image dull_picture(const Pose& pose, float contrast, std::uint32_t seed) {
  static auto* scene = new Scene(sheet(), kWidth, kHeight);
  const Image background = squares(3), black(kWidth, kHeight, 1, 0), white(kWidth, kHeight, 1, 255);
  const Image on_black = scene->draw(kRest.data(), pose, kCamera, black),
              on_white = scene->draw(kRest.data(), pose, kCamera, white);
  Image image = background;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      if (*on_black.at(x, y) == *on_white.at(x, y))
        *image.at(x, y) =
            static_cast<std::uint8_t>(110 + contrast * (static_cast<float>(*on_black.at(x, y)) - 128));
  add_noise(image, 2, seed);
  return image;
}

}  // namespace

TEST_CASE("as many blocks of a closed surface are compared as of an open one, all on the side that is seen") {
  const std::vector<std::uint8_t> bytes = printed(can);
  const bake::OpenedTable opened(bytes);
  PrintTable table;
  REQUIRE(PrintTable::open(opened.model().print(), &table) == Status::ok);
  Scene scene(opened.model(), kWidth, kHeight);
  InArena<Cascade> cascade(opened.model());
  const Pose pose = posed(0, 0.5f, 0, 0.8f);
  const Image image = scene.draw(nullptr, pose, kCamera, make_background(kWidth, kHeight, 1));
  const View view = view_of(pose, kCamera);
  struct Posed {
    Cascade* cascade;
    Projector projector;
  } posed_can{&cascade.object, Projector(view, true)};
  const SurfaceProjection projection{&posed_can, [](void* self, Vec2 uv, Vec2* x) {
                                       auto& s = *static_cast<Posed*>(self);
                                       return s.projector.project(s.cascade->surface_point(uv, nullptr), x);
                                     }};
  const FrameView frame{image.pixels.data(), kWidth, kHeight, kWidth, 1, 0, 1};
  const PrintAgreement found = compare_print(frame, opened.model(), table, projection, 1.5f);
  CHECK(found.visible >= 30);
  CHECK(found.agreed >= 0.9 * found.visible);
}

TEST_CASE("a can is found within three frames, in most cases in the first one, whichever side it shows") {
  const std::vector<std::uint8_t> bytes = printed(can);
  const bake::OpenedTable opened(bytes);
  Scene scene(opened.model(), kWidth, kHeight);
  int at_once = 0;
  constexpr int kSides = 8;
  for (int k = 0; k < kSides; ++k) {
    CAPTURE(k);
    Film film(opened.model());
    const Pose pose = posed(0.15f, 0.75f * static_cast<float>(k), 0.2f, 0.8f);
    for (int frame = 0; frame < 3 && !film.tracker->is_started(); ++frame) {
      Image image = scene.draw(nullptr, pose, kCamera, make_background(kWidth, kHeight, 3));
      add_noise(image, 2, static_cast<std::uint32_t>(frame + 5));
      REQUIRE(film.show(image) == Status::ok);
      at_once += frame == 0 && film.tracker->is_started();
    }
    CHECK(film.tracker->is_started());
    CHECK(film.turned_from(pose) < 0.05f);
  }
  CHECK(at_once >= 6);
}

// All that is seen of its front lies before the origin. A closed surface has views from its sides only, so that the front is read
// as not tilted, and the fit may tilt it to the wrong side.
TEST_CASE("a box that was first read as tilted to the wrong side is found in its first frame") {
  const std::vector<std::uint8_t> bytes = printed(box);
  const bake::OpenedTable opened(bytes);
  Scene scene(opened.model(), kWidth, kHeight);
  // The first eight of the fourteen of 240 such poses that are not found where the other tilt is not tried.
  int found = 0;
  for (const int k : {23, 26, 29, 58, 59, 80, 82, 87}) {
    CAPTURE(k);
    const auto at = [k](int period) { return static_cast<float>(k % period); };
    const Pose pose = posed(k % 3 == 0 ? 0.1f : -0.1f, (k % 2 == 0 ? 0.6f : -0.6f) - 0.01f * at(29),
                            0.7f * static_cast<float>(k), 1.0f + 0.03f * at(31));
    Film film(opened.model());
    Image image = scene.draw(nullptr, pose, kCamera, make_background(kWidth, kHeight, 3));
    add_noise(image, 2, 5);
    REQUIRE(film.show(image) == Status::ok);
    if (!film.tracker->is_started()) continue;
    ++found;
    CHECK(film.turned_from(pose) < 0.05f);
  }
  CHECK(found >= 6);
}

TEST_CASE("the pose in which a curved surface is found is exact to a third of a percent of its distance") {
  const std::vector<std::uint8_t> bytes = printed(cap);
  const bake::OpenedTable opened(bytes);
  Scene scene(opened.model(), kWidth, kHeight);
  for (int k = 0; k < 4; ++k) {
    CAPTURE(k);
    Film film(opened.model());
    const Pose pose = posed(0.2f, 0.3f * static_cast<float>(k) - 0.5f, 0.1f, 0.8f);
    for (std::uint32_t frame = 0; frame < 3 && !film.tracker->is_started(); ++frame) {
      Image image = scene.draw(nullptr, pose, kCamera, make_background(kWidth, kHeight, 3));
      add_noise(image, 2, frame + 5);
      REQUIRE(film.show(image) == Status::ok);
    }
    REQUIRE(film.tracker->is_started());
    CHECK(std::fabs(film.result.pose.t.z / pose.t.z - 1) < 0.0033f);
  }
}

TEST_CASE(
    "of dull prints before a sharp picture, which has the strongest corners, half are found in six frames") {
  int found = 0;
  for (int k = 0; k < 8; ++k) {
    Film film(sheet());
    const auto turn = static_cast<float>(k);
    const Pose pose = posed(0.2f, 0.2f * turn - 0.3f, 0.7f * turn, 0.8f);
    for (int frame = 0; frame < 6 && !film.tracker->is_started(); ++frame)
      REQUIRE(film.show(dull_picture(pose, 0.5f, static_cast<std::uint32_t>(frame + 1))) == Status::ok);
    if (!film.tracker->is_started()) continue;
    ++found;
    CHECK(film.turned_from(pose) < 0.05f);
  }
  CHECK(found >= 4);
}

TEST_CASE("a print with an eighth of the contrast is found in its first frames") {
  constexpr float kContrast = 0.12f;
  const std::vector<std::uint8_t> bytes = printed(
      [](float s, float t) {
        return Vec3{210 * (s - 0.5f), 224 * (t - 0.5f), 0};
      },
      kContrast);
  const bake::OpenedTable opened(bytes);
  REQUIRE(opened.status() == Status::ok);
  Scene scene(opened.model(), kWidth, kHeight);
  for (int k = 0; k < 4; ++k) {
    CAPTURE(k);
    Film film(opened.model());
    const auto turn = static_cast<float>(k);
    const Pose pose = posed(0.2f - 0.1f * turn, 0.15f * turn - 0.2f, 0.8f * turn, 0.6f);
    for (std::uint32_t frame = 0; frame < 4 && !film.tracker->is_started(); ++frame) {
      Image image = scene.draw(nullptr, pose, kCamera, make_background(kWidth, kHeight, 3));
      add_noise(image, 1, 10 * static_cast<std::uint32_t>(k) + frame + 5);
      REQUIRE(film.show(image) == Status::ok);
    }
    REQUIRE(film.tracker->is_started());
    CHECK(film.turned_from(pose) < 0.05f);
  }
}

}  // namespace print_surroundings_test
