#include "face/gradient_cells.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "texture.hpp"

namespace gradient_cells_test {

using namespace pliant;
using texture::Picture;

namespace {

struct Map {
  int columns, rows;
  std::vector<std::uint8_t> bytes;
  const std::uint8_t* at(int column, int row) const {
    return bytes.data() + (row * columns + column) * kCellChannels;
  }
};

Map cells_of(const ImageView& image, int cell_px, int reach) {
  Map map{(image.width - 2) / cell_px, (image.height - 2) / cell_px, {}};
  const int count = map.columns * map.rows;
  map.bytes.resize(static_cast<std::size_t>(count * kCellChannels));
  alignas(16) static std::uint8_t block[1 << 18];
  Arena arena(block, sizeof block);
  GradientCells cells;
  cells.lay_out(arena, count);
  REQUIRE(!arena.exhausted());
  cells.compute(image, map.columns, map.rows, cell_px, reach, map.bytes.data());
  return map;
}

// Grey levels that rise by `slope` a pixel towards an angle.
Picture ramp(double degrees, double slope) {
  Picture p(34, 34);
  const double c = std::cos(degrees * 3.14159265 / 180), s = std::sin(degrees * 3.14159265 / 180);
  for (int y = 0; y < 34; ++y)
    for (int x = 0; x < 34; ++x)
      p.pixels[static_cast<std::size_t>(y * 34 + x)] =
          static_cast<std::uint8_t>(std::lround(128 + slope * ((x - 17) * c + (y - 17) * s)));
  return p;
}

}  // namespace

TEST_CASE("a ramp in one of the eight directions fills that channel and no other") {
  for (int k = 0; k < 8; ++k) {
    CAPTURE(k);
    const Picture p = ramp(45.0 * k, 5);
    const Map map = cells_of(p.view(), 4, 1);
    REQUIRE(map.columns == 8);
    const std::uint8_t* const cell = map.at(4, 4);
    for (int j = 0; j < 8; ++j) {
      if (j == k)
        CHECK(cell[j] > 80);
      else
        CHECK(cell[j] < 10);
    }
    CHECK(std::abs(cell[8] - 128) <= 2);
  }
}

TEST_CASE("a ramp between two directions fills both") {
  const Picture p = ramp(22.5, 5);
  const Map map = cells_of(p.view(), 4, 1);
  const std::uint8_t* const cell = map.at(4, 4);
  CHECK(std::abs(cell[0] - cell[1]) < 12);
  CHECK(cell[0] > 40);
}

TEST_CASE("an even ramp fills all cells alike, those at the rim too") {
  const Picture p = ramp(45, 4);
  for (const int cell_px : {2, 4, 8}) {
    const Map map = cells_of(p.view(), cell_px, 1);
    for (int row = 0; row < map.rows; ++row)
      for (int column = 0; column < map.columns; ++column)
        for (int k = 0; k < 8; ++k) {
          CAPTURE(row);
          CAPTURE(column);
          CHECK(std::abs(map.at(column, row)[k] - map.at(map.columns / 2, map.rows / 2)[k]) <= 12);
        }
  }
}

TEST_CASE("gain and bias of the light hardly change the cells") {
  Picture p = texture::noise(66, 66, 3), q = p;
  for (auto& v : q.pixels) v = static_cast<std::uint8_t>(40 + v / 2);
  const Map a = cells_of(p.view(), 4, 1), b = cells_of(q.view(), 4, 1);
  int largest = 0;
  for (std::size_t k = 0; k < a.bytes.size(); ++k)
    largest = std::max(largest, std::abs(a.bytes[k] - b.bytes[k]));
  CHECK(largest <= 12);
}

TEST_CASE("a flat picture has no direction, and brightness in the middle") {
  const Picture p(34, 34);
  const Map map = cells_of(p.view(), 4, 2);
  for (int k = 0; k < 8; ++k) CHECK(map.at(3, 3)[k] == 0);
  CHECK(map.at(3, 3)[8] == 128);
}

TEST_CASE("sums do not depend on the number of columns that are summed at once") {
  const Picture p = texture::noise(130, 34, 3);
  for (int cell_px = 1; cell_px <= kLargestCellPx; ++cell_px) {
    CAPTURE(cell_px);
    const int columns = 128 / cell_px;
    std::vector<CellSums> all(static_cast<std::size_t>(columns));
    const std::uint8_t* const first = p.pixels.data() + 131;
    sum_cells(first, 130, columns, cell_px, all.data());
    for (int c = 0; c < columns; ++c) {
      CellSums one{};
      sum_cells(first + c * cell_px, 130, 1, cell_px, &one);
      const CellSums& there = all[static_cast<std::size_t>(c)];
      CHECK(one.total == there.total);
      CHECK(one.brightness == there.brightness);
      int total = 0;
      for (int k = 0; k < 8; ++k) {
        CHECK(one.direction[k] == there.direction[k]);
        total += one.direction[k];
      }
      CHECK(one.total == total);
    }
  }
}

TEST_CASE("the strongest gradients of the largest cells neither overflow nor wrap around") {
  Picture p(34, 34);
  for (int y = 0; y < 34; ++y)
    for (int x = 0; x < 34; ++x) p.pixels[static_cast<std::size_t>(y * 34 + x)] = (x + y) % 4 < 2 ? 255 : 0;
  for (const int cell_px : {1, 4, 8}) {
    const Map map = cells_of(p.view(), cell_px, 2);
    const std::uint8_t* const cell = map.at(map.columns / 2, map.rows / 2);
    int sum = 0;
    for (int k = 0; k < 8; ++k) sum += cell[k];
    CHECK(sum > 0);
    CHECK(sum <= 360);
  }
}

}  // namespace gradient_cells_test
