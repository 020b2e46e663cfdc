// The print compared with the frame where a surface is curved: a picture that is warped by a known map.
#include "print/print_check.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "host/bake/bake.hpp"
#include "host/io/files.hpp"
#include "print_film.hpp"
#include "random.hpp"
#include "scratch_folder.hpp"

namespace print_check_test {

using namespace pliant;
using namespace pliant::host;

namespace {

/// The sheet of the fixtures with squares of random grey as its print, so small that a block agrees only where each of its samples
/// is in its place.
const Model& noisy_sheet() {
  static const auto* opened = [] {
    constexpr int kSide = 256, kSquare = 2;
    Random random(5);
    Image print(kSide, kSide, 1);
    for (int y = 0; y < kSide; y += kSquare)
      for (int x = 0; x < kSide; x += kSquare) {
        const auto grey = static_cast<std::uint8_t>(random.below(256));
        for (int k = 0; k < kSquare * kSquare; ++k) *print.at(x + k % kSquare, y + k / kSquare) = grey;
      }
    const Folder folder("noisy");
    write_file((folder.path / "noise.png").string(), encode_png(print));
    bake::BakeOptions options;
    options.source = PLIANT_FIXTURES "/sheet";
    options.texture = (folder.path / "noise.png").string();
    std::vector<std::uint8_t> bytes;
    std::string error;
    REQUIRE_MESSAGE(bake::bake(options, bytes, error), error);
    return new bake::OpenedTable(bytes);
  }();
  REQUIRE(opened->status() == Status::ok);
  return opened->model();
}

/// Waves across the chart in both directions: a surface that bends and is twisted everywhere.
struct Wavy {
  float px;  ///< height of the waves

  Vec2 operator()(Vec2 uv) const {
    constexpr float kPerUv = 14;
    const float wave = px * std::sin(kPerUv * uv.x) * std::sin(kPerUv * uv.y);
    return {40 + 240 * uv.x + wave, 20 + 200 * uv.y};
  }
  /// Where of the chart a pixel looks. The map keeps rows, so that only u has to be searched for.
  Vec2 inverse(Vec2 x) const {
    Vec2 uv{0, (x.y - 20) / 200};
    float low = -0.3f, high = 1.3f;
    for (int k = 0; k < 14; ++k) {
      uv.x = 0.5f * (low + high);
      ((*this)(uv).x < x.x ? low : high) = uv.x;
    }
    return uv;
  }
  SurfaceProjection projection() const {
    return {const_cast<Wavy*>(this), [](void* self, Vec2 uv, Vec2* x) {
              *x = (*static_cast<const Wavy*>(self))(uv);
              return true;
            }};
  }
};

/// The print under the map, each pixel the mean of 3 x 3 samples.
Image picture_under(const Wavy& map) {
  const ChartImage albedo = noisy_sheet().albedo();
  Image image(kWidth, kHeight, 1, 128);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      float sum = 0;
      for (int k = 0; k < 9; ++k) {
        const Vec2 uv = map.inverse({static_cast<float>(x) + static_cast<float>(k % 3 - 1) / 3,
                                     static_cast<float>(y) + static_cast<float>(k / 3 - 1) / 3});
        const bool is_on = uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1;
        const auto i = static_cast<std::size_t>(uv.x * static_cast<float>(albedo.width - 1) + 0.5f),
                   j = static_cast<std::size_t>(uv.y * static_cast<float>(albedo.height - 1) + 0.5f);
        sum += is_on ? static_cast<float>(albedo.pixels[j * albedo.width + i]) : 128.0f;
      }
      *image.at(x, y) = static_cast<std::uint8_t>(sum / 9);
    }
  return image;
}

/// Fraction of the blocks that agree when the picture shows `shown` and `expected` is compared with it.
float agreement(const Wavy& shown, const Wavy& expected, float block_px) {
  PrintTable table;
  REQUIRE(PrintTable::open(noisy_sheet().print(), &table) == Status::ok);
  const Image image = picture_under(shown);
  const PrintAgreement found =
      compare_print(frame_of(image), noisy_sheet(), table, expected.projection(), block_px);
  REQUIRE(found.visible > 15);
  return static_cast<float>(found.agreed) / static_cast<float>(found.visible);
}

}  // namespace

TEST_CASE("blocks agree where the print is seen, and not where it is expected elsewhere") {
  CHECK(agreement({0}, {0}, 4) > 0.95f);
  CHECK(agreement({8}, {0}, 4) < 0.3f);
}

TEST_CASE("blocks of a surface that bends and is twisted agree, since they are placed to the second order") {
  CHECK(agreement({8}, {8}, 5) > 0.93f);
  CHECK(agreement({10}, {10}, 4) > 0.93f);
}

TEST_CASE("blocks behind another part of the surface are not counted, others that do not agree are") {
  PrintTable table;
  REQUIRE(PrintTable::open(noisy_sheet().print(), &table) == Status::ok);
  Image image = picture_under({0});
  const Wavy map{0};
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth / 2; ++x) *image.at(x, y) = 128;
  SurfaceProjection projection = map.projection();
  const PrintAgreement covered = compare_print(frame_of(image), noisy_sheet(), table, projection, 4);
  CHECK(covered.agreed > 0.3f * static_cast<float>(covered.visible));
  CHECK(covered.agreed < 0.7f * static_cast<float>(covered.visible));
  projection.shows = [](void*, Vec2, Vec2 x) { return x.x > 0.5f * kWidth; };
  const PrintAgreement seen = compare_print(frame_of(image), noisy_sheet(), table, projection, 4);
  CHECK(seen.agreed == covered.agreed);
  CHECK(seen.agreed > 0.95f * static_cast<float>(seen.visible));
}

TEST_CASE("a history has the blocks that have agreed in any of its comparisons") {
  PrintTable table;
  REQUIRE(PrintTable::open(noisy_sheet().print(), &table) == Status::ok);
  const Wavy map{0};
  PrintHistory history;
  PrintAgreement found;
  for (const bool is_left : {true, false}) {
    Image image = picture_under(map);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth / 2; ++x) *image.at(is_left ? x : x + kWidth / 2, y) = 128;
    found = compare_print(frame_of(image), noisy_sheet(), table, map.projection(), 4, &history);
    CHECK(found.agreed < 0.7f * static_cast<float>(found.visible));
    if (is_left) CHECK(found.agreed_once == found.agreed);
  }
  CHECK(found.agreed_once > 0.85f * static_cast<float>(found.visible));
  history.clear();
  CHECK_FALSE(history.has(0));
  history.add(33);
  CHECK(history.has(33));
  CHECK_FALSE(history.has(32));
}

}  // namespace print_check_test
