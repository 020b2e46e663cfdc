#include "face/part_table.hpp"

#include <doctest/doctest.h>

#include <cstring>
#include <limits>
#include <vector>

#include "face/part_reader.hpp"
#include "model_builder.hpp"
#include "pliant/model.hpp"

namespace part_table_test {

using namespace pliant;

namespace {

/// A table of one part: corners, an upper lid and a pupil; one stage of 2 x 2 cells. All weights are zero.
struct Table {
  std::vector<std::uint32_t> words;
  std::size_t size = 0;

  Table() {
    PartRecord part{1.0f, 0, 40, 1, 1, 4, {36, 39}, 0, {{2, 4}}, {36, 37, 39, kPupilRight}, 0};
    part.first_byte = sizeof(PartHeader) + sizeof(PartRecord);
    size = part.first_byte + part_weight_bytes(part);
    words.assign((size + 3) / 4, 0);
    const PartHeader header{kPartMagic, kPartVersion, static_cast<std::uint32_t>(size), 0, 1, 0};
    std::memcpy(bytes(), &header, sizeof header);
    std::memcpy(bytes() + sizeof header, &part, sizeof part);
    for (std::size_t k = 0; k < 4; ++k) {
      numbers()[2 * k] = 3 * static_cast<float>(k);      // start
      numbers()[8 + 3 * k] = numbers()[10 + 3 * k] = 1;  // information
    }
    seal();
  }
  std::uint8_t* bytes() { return reinterpret_cast<std::uint8_t*>(words.data()); }
  PartRecord& part() { return *reinterpret_cast<PartRecord*>(bytes() + sizeof(PartHeader)); }
  float* numbers() { return reinterpret_cast<float*>(bytes() + sizeof(PartHeader) + sizeof(PartRecord)); }
  void seal() {
    constexpr std::size_t first = offsetof(PartHeader, part_count);
    const std::uint32_t sum = crc32(bytes() + first, size - first);
    std::memcpy(bytes() + offsetof(PartHeader, crc32), &sum, sizeof sum);
  }
  Status open(PartTable* table) { return PartTable::open({bytes(), size}, table); }
  Status open() {
    PartTable table;
    return open(&table);
  }
};

template <class Change>
Status with(const Change& change) {
  Table table;
  change(table);
  table.seal();
  return table.open();
}

}  // namespace

TEST_CASE("a table of parts that is cut at any byte, or has a flipped bit, does not open") {
  Table table;
  const std::size_t size = table.size;
  REQUIRE(table.open() == Status::ok);
  for (table.size = 0; table.size < size; ++table.size)
    REQUIRE(table.open() == (table.size == 0 ? Status::not_found : Status::truncated));
  for (std::size_t k = 0; k < size; ++k) {
    const auto bit = static_cast<std::uint8_t>(1 << k % 8);
    table.bytes()[k] = static_cast<std::uint8_t>(table.bytes()[k] ^ bit);
    REQUIRE(table.open() != Status::ok);
    table.bytes()[k] = static_cast<std::uint8_t>(table.bytes()[k] ^ bit);
  }
  PartTable out;
  CHECK(PartTable::open({table.bytes() + 1, size - 1}, &out) == Status::misaligned);
  CHECK(out.count() == 0);
}

TEST_CASE("values of parts out of range do not open, even with the right checksum") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  CHECK(with([](Table&) {}) == Status::ok);
  CHECK(with([&](Table& t) { t.part().mm_per_px = nan; }) == Status::bad_table);
  CHECK(with([](Table& t) { t.part().mm_per_px = 0; }) == Status::bad_table);
  CHECK(with([](Table& t) { t.part().below_mm = 1e9f; }) == Status::bad_table);
  CHECK(with([](Table& t) { t.part().crop_px = kMostPartCropPx + 1; }) == Status::bad_table);
  CHECK(with([](Table& t) { t.part().crop_px = 7; }) == Status::bad_table);
  CHECK(with([](Table& t) { t.part().stage[0].cells = 9; }) == Status::bad_table);
  CHECK(with([](Table& t) { t.part().stage[0].cell_px = 0; }) == Status::bad_table);
  CHECK(with([](Table& t) { t.part().stage_count = 5; }) == Status::bad_table);
  CHECK(with([](Table& t) { t.part().point_count = 0; }) == Status::bad_table);
  CHECK(with([](Table& t) { t.part().point_count = 25; }) == Status::bad_table);
  CHECK(with([](Table& t) { t.part().number[1] = 36; }) == Status::bad_table);
  CHECK(with([](Table& t) { t.part().number[1] = 70; }) == Status::bad_table);
  CHECK(with([](Table& t) { t.part().anchor[0] = 68; }) == Status::bad_table);
  CHECK(with([](Table& t) { t.part().is_paired = 2; }) == Status::bad_table);
  CHECK(with([](Table& t) { t.part().first_byte += 4; }) == Status::bad_table);
  CHECK(with([&](Table& t) { t.numbers()[0] = nan; }) == Status::bad_table);
  CHECK(with([](Table& t) { t.numbers()[8] = 0; }) == Status::bad_table);
  CHECK(with([](Table& t) { t.numbers()[9] = 1; }) == Status::bad_table);
  CHECK(with([&](Table& t) { t.numbers()[20] = nan; }) == Status::bad_table);
}

TEST_CASE("points without weights stay where they start; those of the left side in the mirror image") {
  Table table;
  PartTable opened;
  REQUIRE(table.open(&opened) == Status::ok);
  const std::vector<std::uint8_t> grey(64 * 64, 90);
  const FrameView frame{grey.data(), 64, 64, 64};
  InArena<PartReader> reader;
  CropMap map;
  map.side = 40;
  map.origin = {31.5f, 30.5f};
  map.right = {1, 0};
  PartReading right[4], left[4];
  reader->read(frame, opened, 0, map, false, right);
  reader->read(frame, opened, 0, map, true, left);
  for (int k = 0; k < 4; ++k) {
    // To a pixel: blocks lie on pixels.
    CHECK(magnitude(right[k].x.x - (31.5f + 3 * static_cast<float>(k))) <= 0.5f);
    CHECK(magnitude(left[k].x.x - (31.5f - 3 * static_cast<float>(k))) <= 0.5f);
    CHECK(magnitude(left[k].x.y - 30.5f) <= 0.5f);
    CHECK(right[k].information.xx == doctest::Approx(1));
  }
}

}  // namespace part_table_test
