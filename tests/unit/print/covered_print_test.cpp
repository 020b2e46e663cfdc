// Starts by print while a part of the surface is covered: a search may fold that part away, and is then no track.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "host/bake/bake.hpp"
#include "print/print_check.hpp"
#include "print_film.hpp"
#include "printed_shapes.hpp"
#include "random.hpp"

namespace covered_print_test {

using namespace pliant;
using namespace pliant::host;

namespace {

constexpr int kModes = 6, kWide = 640, kHigh = 480;
const std::vector<float> kAtRest(kModes, 0.0f);
const Camera kFilmCamera = centred_camera(kWide, kHigh, 896);

/// The front of a mug.
Vec3 half_mug(float s, float t) {
  const float a = 3.1415927f * (s - 0.5f);
  return {90 * std::sin(a), 210 * (t - 0.5f), 90 * std::cos(a)};
}

Vec3 can(float s, float t) {
  const float a = 6.2831853f * (s - 0.5f);
  return {90 * std::sin(a), 210 * (t - 0.5f), 90 * std::cos(a)};
}

Vec3 flat(float s, float t) {
  return {200 * (s - 0.5f), 210 * (t - 0.5f), 0};
}

/// Discs and boxes of random grey, size and direction.
Image marks() {
  constexpr int kPixels = 480;
  Random random(1);
  Image print(kPixels, kPixels, 1, 200);
  for (int k = 0; k < 120; ++k) {
    const int x = random.below(kPixels), y = random.below(kPixels), size = 4 + random.below(37),
              grey = 30 + random.below(200);
    const bool is_disc = random.below(2) == 0;
    const float flatness = 0.01f * static_cast<float>(30 + random.below(70)),
                a = 0.01f * static_cast<float>(random.below(314)), side = static_cast<float>(size);
    for (int j = std::max(0, y - size); j < std::min(kPixels, y + size + 1); ++j)
      for (int i = std::max(0, x - size); i < std::min(kPixels, x + size + 1); ++i) {
        const float dx = static_cast<float>(i - x), dy = static_cast<float>(j - y);
        const float p = std::cos(a) * dx + std::sin(a) * dy,
                    q = (std::cos(a) * dy - std::sin(a) * dx) / flatness;
        if (is_disc ? p * p + q * q < side * side : std::fabs(p) < 0.7f * side && std::fabs(q) < 0.7f * side)
          *print.at(i, j) = static_cast<std::uint8_t>(grey);
      }
  }
  return print;
}

std::vector<std::uint8_t> marked(const obj_folder::Shape& shape, int modes = kModes) {
  const obj_folder::ObjFolder folder("marked");
  folder.write("neutral", shape);
  bake::BakeOptions options;
  options.source = folder.path.string();
  options.modes = modes;
  options.texture = folder.put("print.png", encode_png(marks()));
  std::vector<std::uint8_t> bytes;
  std::string error;
  REQUIRE_MESSAGE(bake::bake(options, bytes, error), error);
  return bytes;
}

/// Mean distance in the picture of places of a track from those of a surface with these parameters, over its height.
float error_of(Film& film, Cascade& cascade, const Pose& pose, const float* q) {
  const Projector truth(view_of(pose, kFilmCamera), true),
      found(view_of(film.result.pose, kFilmCamera), true);
  float sum = 0;
  for (int k = 0; k < 81; ++k) {
    const Vec2 uv =
        obj_folder::chart(0.1f + 0.1f * static_cast<float>(k % 9), 0.1f + 0.1f * static_cast<float>(k / 9));
    Vec2 a, b;
    REQUIRE(truth.project(cascade.surface_point(uv, q), &a));
    REQUIRE(found.project(cascade.surface_point(uv, film.tracker->parameters().data), &b));
    sum += length(a - b);
  }
  return sum / 81 / (kFilmCamera.f * 210 / pose.t.z);
}

}  // namespace

TEST_CASE(
    "a half mug of which one side is covered at the start is not tracking while that side is folded away") {
  const std::vector<std::uint8_t> bytes = marked(half_mug);
  const bake::OpenedTable opened(bytes);
  Scene scene(opened.model(), kWide, kHigh);
  InArena<Cascade> cascade(opened.model());
  TrackerLimits limits = searching_at_once(profile_l());
  limits.width = kWide, limits.height = kHigh;
  std::vector<float> q = kAtRest;
  q[0] = 0.3f;
  const Image background = make_background(kWide, kHigh, 3);
  struct {
    float turn;
    int cover;
  } const starts[] = {{-0.35f, 312}, {-0.3f, 312}, {-0.35f, 320}};
  std::uint32_t seed = 1;
  for (const auto& start : starts) {
    CAPTURE(start.turn);
    CAPTURE(start.cover);
    Film film(opened.model(), limits);
    int folded = 0, wrong = 0, right = 0;
    for (int frame = 0; frame < 50; ++frame) {
      const float more = 0.006f * static_cast<float>(frame);
      const Pose pose = posed(0.2f + more, start.turn + more, 0.13f, 0.75f);
      Image image = scene.draw(q.data(), pose, kFilmCamera, background);
      for (int y = 0; y < kHigh && frame < 12; ++y)
        for (int x = start.cover + 1; x < kWide; ++x) *image.at(x, y) = 128;
      add_noise(image, 2, seed++);
      REQUIRE(film.show(image) == Status::ok);
      if (!film.tracker->is_started()) continue;
      const bool is_wrong = error_of(film, cascade.object, pose, q.data()) > 0.1f;
      folded += is_wrong;
      (is_wrong ? wrong : right) += film.result.state == TrackState::tracking;
    }
    CHECK(folded > 5);  // the search still finds it so
    CHECK(wrong == 0);
    CHECK(right > 10);
  }
}

Vec3 square(float s, float t) {
  return {210 * (s - 0.5f), 210 * (t - 0.5f), 0};
}

TEST_CASE(
    "a card of which a third is covered is tracked all the same: rigid and flat, it cannot hide that part") {
  const std::vector<std::uint8_t> bytes = marked(square, 0);
  const bake::OpenedTable opened(bytes);
  Scene scene(opened.model(), kWide, kHigh);
  InArena<Cascade> cascade(opened.model());
  TrackerLimits limits = searching_at_once(profile_l());
  limits.width = kWide, limits.height = kHigh;
  Film film(opened.model(), limits);
  const Image background = make_background(kWide, kHigh, 3);
  int tracking = 0;
  for (std::uint32_t frame = 0; frame < 30; ++frame) {
    const float more = 0.006f * static_cast<float>(frame);
    const Pose pose = posed(0.2f + more, 0.3f + more, 0.13f, 0.75f);
    Image image = scene.draw(nullptr, pose, kFilmCamera, background);
    for (int y = 0; y < kHigh; ++y)
      for (int x = 390; x < kWide; ++x) *image.at(x, y) = 128;
    add_noise(image, 2, frame);
    REQUIRE(film.show(image) == Status::ok);
    if (!film.tracker->is_started()) continue;
    tracking += film.result.state == TrackState::tracking;
    CHECK(error_of(film, cascade.object, pose, nullptr) < 0.02f);
  }
  CHECK(tracking >= 26);
}

TEST_CASE("all places of a sheet can face one camera at rest, less than half of those of a can") {
  struct {
    Vec3 (*shape)(float, float);
    int least, most;
  } const cases[] = {{flat, 48, 48}, {half_mug, 36, 48}, {can, 15, 26}};
  for (const auto& c : cases) {
    const std::vector<std::uint8_t> bytes = printed(c.shape);
    const bake::OpenedTable opened(bytes);
    PrintTable table;
    REQUIRE(PrintTable::open(opened.model().print(), &table) == Status::ok);
    InArena<Cascade> cascade(opened.model());
    const FacingAtRest front = facing_at_rest(table, cascade.object, nullptr, posed(0, 0, 0, 1));
    CHECK(front.most >= c.least);
    CHECK(front.most <= c.most);
    CHECK(front.in_view <= front.most + 2);
    CHECK(front.in_view >= 12);
    const FacingAtRest behind = facing_at_rest(table, cascade.object, nullptr, posed(0, 3.14f, 0, 1));
    CHECK(behind.most == front.most);
    CHECK((behind.in_view == 0) == (c.shape != can));
  }
}

}  // namespace covered_print_test
