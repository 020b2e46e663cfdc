// Pictures of one face, crops of them, and the gradients of a crop.
#include "face/face_picture.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <vector>

#include "aligned_block.hpp"
#include "face/gradient_map.hpp"
#include "random.hpp"
#include "texture.hpp"
#include "vision/bilinear.hpp"

namespace face_picture_test {

using namespace pliant;
using texture::Picture;

namespace {

constexpr int kSide = 48, kCells = 3, kCellPx = 4;
constexpr float kEnd = kSide - 1;

/// The part of a frame around its middle, without reduction.
struct Bench {
  AlignedBlock block{1 << 18};
  Arena arena{block.data(), block.size()};
  FacePicture picture;
  GradientMap map;
  CropMap crop;

  explicit Bench(const Picture& frame) {
    picture.lay_out(arena);
    map.lay_out(arena);
    REQUIRE(!arena.exhausted());
    const Vec2 middle =
        0.5f * Vec2{static_cast<float>(frame.width - 1), static_cast<float>(frame.height - 1)};
    std::vector<int> columns(static_cast<std::size_t>(picture.side() * kFacePictureTuning.most_samples));
    picture.take(frame.frame(), middle, 1, columns.data());
    crop = {middle, {1, 0}, kSide};
  }
  std::array<std::uint8_t, kCells * kCells * kBlockChannels> describe(Vec2 at) const {
    std::array<std::uint8_t, kCells * kCells * kBlockChannels> out{};
    map.describe(at, kCells, kCellPx, out.data());
    return out;
  }
};

Picture slope(int width, int height, int along_x, int along_y) {
  Picture p(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) p.at(x, y) = static_cast<std::uint8_t>(5 + along_x * x + along_y * y);
  return p;
}

}  // namespace

TEST_CASE("an even slope has one description everywhere in the crop, at its rim too") {
  for (const int along_y : {0, 1}) {
    Bench b(slope(120, 120, 1, along_y));
    b.map.compute(b.picture, b.crop);
    const auto middle = b.describe({0.5f * kEnd, 0.5f * kEnd});
    for (const Vec2 at :
         {Vec2{0, 0}, Vec2{kEnd, 0}, Vec2{0, kEnd}, Vec2{kEnd, kEnd}, Vec2{20, 0}, Vec2{0, 20}})
      CHECK(b.describe(at) == middle);
  }
}

TEST_CASE("the blocks of a mirrored crop are the mirror images of the crop's") {
  Bench b(render(texture::Texture(3), {}, 120, 120));
  const Vec2 at{20.5f, 17.5f}, there{kEnd - at.x, at.y};
  b.map.compute(b.picture, b.crop);
  const auto block = b.describe(at);
  auto mirrored = block;
  mirror_block(block.data(), kCells, mirrored.data());
  CHECK(mirrored != block);
  b.map.compute(b.picture, b.crop, true);
  CHECK(b.describe(there) == mirrored);
}

TEST_CASE("a block has the sums of its pixels' gradients, by cell and direction") {
  constexpr int kStride = 71;
  Random random(5);
  std::vector<std::uint16_t> gradients(kStride * kStride + kReadBeyondBlock);
  for (std::uint16_t& g : gradients) g = static_cast<std::uint16_t>(random.uniform(0, 65536));
  for (int cells = 1; cells <= kMostBlockCells; ++cells)
    for (int cell_px = 1; cell_px <= kMostBlockCellPx; ++cell_px) {
      CAPTURE(cells);
      CAPTURE(cell_px);
      const int first = kStride - cells * cell_px;  // the last block, which ends at the last gradient
      std::vector<std::uint16_t> sums(static_cast<std::size_t>(cells * cells * kBlockChannels));
      sum_block(gradients.data() + first * kStride + first, kStride, cells, cell_px, sums.data());
      for (int j = 0; j < cells; ++j)
        for (int i = 0; i < cells; ++i) {
          unsigned expected[kBlockChannels] = {};
          for (int y = j * cell_px; y < (j + 1) * cell_px; ++y)
            for (int x = i * cell_px; x < (i + 1) * cell_px; ++x) {
              const unsigned g = gradients[static_cast<std::size_t>((first + y) * kStride + first + x)];
              const bool is_left = g >> 15 & 1, is_up = g >> 14 & 1, is_steep = g >> 13 & 1;
              expected[is_steep ? (is_up ? 6 : 2) : (is_left ? 4 : 0)] += g >> 6 & 127;
              expected[is_up ? (is_left ? 5 : 7) : (is_left ? 3 : 1)] += g & 63;
            }
          for (int d = 0; d < kBlockChannels; ++d) {
            const unsigned scaled = d % 2 == 0 ? expected[d] : expected[d] * 181 / 128;  // sqrt(2)
            CHECK(sums[static_cast<std::size_t>((j * cells + i) * kBlockChannels + d)] == scaled);
          }
        }
    }
}

TEST_CASE("a row of a crop is interpolated between four pixels, however the crop is turned") {
  const Picture frame = render(texture::Texture(7), {}, 200, 200);
  Bench b(frame);
  Random random(11);
  for (int trial = 0; trial < 40; ++trial) {
    const float angle = random.uniform(-3, 3), step = random.uniform(0.3f, 1.1f);
    const Vec2 right = step * Vec2{std::cos(angle), std::sin(angle)};
    const CropMap map{b.crop.origin + Vec2{random.uniform(-30, 30), random.uniform(-30, 30)}, right, 104};
    const CropReader reader(b.picture, map);
    std::uint8_t row[106];
    const int y = static_cast<int>(random.uniform(-1, 104.9f));
    reader.read_row(y, row);
    for (int i = 0; i < 106; ++i) {
      const float end = static_cast<float>(b.picture.side() - 1);
      Vec2 at = b.picture.from_frame(map.to_frame({static_cast<float>(i - 1), static_cast<float>(y)}));
      at = {clamp(at.x, 0, end - 1e-4f), clamp(at.y, 0, end - 1e-4f)};
      const int x0 = static_cast<int>(at.x), y0 = static_cast<int>(at.y);
      const std::uint8_t* const p = b.picture.pixels() + y0 * b.picture.side() + x0;
      const float grey =
          bilinear(p, p + b.picture.side(), 1, at.x - static_cast<float>(x0), at.y - static_cast<float>(y0));
      CHECK(magnitude(grey - static_cast<float>(row[i])) < 3);  // fractions of a pixel are cut to 1/256
    }
  }
}

TEST_CASE("beyond the picture a crop reads the pixels of its border") {
  const Picture frame = slope(240, 240, 1, 0);
  Bench b(frame);
  const float middle = 119.5f, half = 0.5f * static_cast<float>(b.picture.side() - 1);
  std::uint8_t row[kSide + 2];
  for (const float side : {-1.0f, 1.0f}) {
    const Vec2 corner = b.crop.origin + side * Vec2{half, half};  // the middle of the picture's last pixel
    const CropReader reader(b.picture, {corner, {1, 0}, kSide});
    for (const int y : {-1, 0, kSide / 2, kSide}) {
      reader.read_row(y, row);
      for (int i = 0; i < kSide + 2; ++i) {
        const float x = corner.x + static_cast<float>(i - 1) - 0.5f * kEnd;
        const float within = clamp(x, middle - half, middle + half);
        CHECK(magnitude(static_cast<float>(row[i]) - (5 + within)) < 1.01f);
      }
    }
  }
}

TEST_CASE("information in a crop's millimetres weighs a displacement as that in the frame's pixels does") {
  Random random(3);
  for (int trial = 0; trial < 50; ++trial) {
    const Vec2 a{random.uniform(-3, 3), random.uniform(0.5f, 3)};  // a millimetre to the crop's right, px
    const Sym2 w{random.uniform(1, 4), random.uniform(-0.9f, 0.9f), random.uniform(1, 4)},
        v = to_frame_px(w, a);
    const Vec2 mm{random.normal(), random.normal()}, px{a.x * mm.x - a.y * mm.y, a.y * mm.x + a.x * mm.y};
    const auto square = [](Sym2 s, Vec2 d) {
      return s.xx * d.x * d.x + 2 * s.xy * d.x * d.y + s.yy * d.y * d.y;
    };
    CHECK(square(v, px) == doctest::Approx(double(square(w, mm))).epsilon(1e-4));
  }
}

TEST_CASE("a picture of a large face shows the same slope, averaged, at every reduction") {
  Picture frame(640, 640);
  for (int y = 0; y < 640; ++y)
    for (int x = 0; x < 640; ++x) frame.at(x, y) = static_cast<std::uint8_t>((2 * x + y) / 8);
  AlignedBlock block(1 << 16);
  Arena arena(block.data(), block.size());
  FacePicture picture;
  picture.lay_out(arena, 64);
  REQUIRE(!arena.exhausted());
  std::vector<int> columns(static_cast<std::size_t>(64 * kFacePictureTuning.most_samples));
  const Vec2 centre{320.3f, 317.8f};
  for (const float ratio : {0.4f, 1.0f, 1.3f, 2.0f, 2.6f, 3.0f, 3.7f, 5.0f, 6.0f, 8.5f}) {
    CAPTURE(ratio);
    picture.take(frame.frame(), centre, ratio, columns.data());
    const float step = max(1, ratio);
    CHECK(length(picture.along_from_frame({step, 0}) - Vec2{1, 0}) < 1e-4f);
    const Vec2 first = centre - step * picture.from_frame(centre);
    float worst = 0;
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) {
        const Vec2 at = first + step * Vec2{static_cast<float>(x), static_cast<float>(y)};
        const float grey = picture.pixels()[64 * y + x], truth = (2 * at.x + at.y) / 8;
        if (at.x > 0 && at.y > 0 && at.x < 639 && at.y < 639) worst = max(worst, magnitude(grey - truth));
      }
    CHECK(worst < 1.1f);
  }
}

}  // namespace face_picture_test
