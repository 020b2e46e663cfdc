#include "face/detector_table.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "detector_pattern.hpp"

namespace detector_table_test {

using namespace pliant;
using detector_pattern::Bytes;

namespace {

Status status_of(const Bytes& bytes) {
  DetectorTable table;
  const Status status = DetectorTable::open(bytes.span(), &table);
  CHECK(table.is_open() == (status == Status::ok));
  return status;
}

DetectorHeader& header_of(Bytes& bytes) {
  return *reinterpret_cast<DetectorHeader*>(bytes.words.data());
}
DetectorTree& tree_of(Bytes& bytes, std::size_t t) {
  return reinterpret_cast<DetectorTree*>(reinterpret_cast<char*>(bytes.words.data()) +
                                         sizeof(DetectorHeader))[t];
}

}  // namespace

TEST_CASE("a table cut at any byte does not open") {
  Bytes bytes = detector_pattern::table(20);
  const std::size_t size = bytes.size;
  REQUIRE(status_of(bytes) == Status::ok);
  for (bytes.size = 0; bytes.size < size; ++bytes.size)
    REQUIRE(status_of(bytes) == (bytes.size == 0 ? Status::not_found : Status::truncated));
  bytes.size = size + 3;  // padding behind a table is no error
  CHECK(status_of(bytes) == Status::ok);
}

TEST_CASE("a table with any bit flipped does not open") {
  Bytes bytes = detector_pattern::table(20);
  auto* const data = reinterpret_cast<std::uint8_t*>(bytes.words.data());
  for (std::size_t k = 0; k < bytes.size; ++k)
    for (int bit = 0; bit < 8; ++bit) {
      data[k] = static_cast<std::uint8_t>(data[k] ^ (1 << bit));
      REQUIRE(status_of(bytes) != Status::ok);
      data[k] = static_cast<std::uint8_t>(data[k] ^ (1 << bit));
    }
  CHECK(status_of(bytes) == Status::ok);
}

TEST_CASE("values out of range do not open, even with the right checksum") {
  const auto with = [](auto&& change) {
    Bytes bytes = detector_pattern::table(20);
    change(bytes);
    detector_pattern::seal(&bytes);
    return status_of(bytes);
  };
  CHECK(with([](Bytes&) {}) == Status::ok);
  CHECK(with([](Bytes& b) { tree_of(b, 3).feature[1] = 256 * kWindowCells; }) == Status::bad_table);
  CHECK(with([](Bytes& b) { tree_of(b, 19).feature[0] = kWindowCells * kCellChannels; }) ==
        Status::bad_table);
  CHECK(with([](Bytes& b) { tree_of(b, 0).reserved = 1; }) == Status::bad_table);
  CHECK(with([](Bytes& b) { header_of(b).tree_depth = kTreeDepth + 1; }) == Status::bad_table);
  CHECK(with([](Bytes& b) { header_of(b).knot_sum[3] = header_of(b).knot_sum[2]; }) == Status::bad_table);
  CHECK(with([](Bytes& b) { header_of(b).knot_probability[3] = 0; }) == Status::bad_table);
  CHECK(with([](Bytes& b) { header_of(b).tree_count = 0; }) == Status::bad_table);
  CHECK(with([](Bytes& b) { header_of(b).magic += 1; }) == Status::bad_magic);
}

TEST_CASE("a table at an odd address is misaligned") {
  Bytes bytes = detector_pattern::table(20);
  DetectorTable table;
  const Span<const std::uint8_t> all = bytes.span();
  CHECK(DetectorTable::open({all.data + 1, all.count - 1}, &table) == Status::misaligned);
}

TEST_CASE("the probability is the broken line through the knots") {
  Bytes bytes = detector_pattern::table(20);
  for (int k = 0; k < kScoreKnots; ++k) {
    header_of(bytes).knot_sum[k] = static_cast<std::int16_t>(100 * k - 50);
    header_of(bytes).knot_probability[k] = static_cast<std::uint16_t>(9362 * k);
  }
  detector_pattern::seal(&bytes);
  DetectorTable table;
  REQUIRE(DetectorTable::open(bytes.span(), &table) == Status::ok);
  CHECK(table.probability(-100000) == 0);
  CHECK(table.probability(-50) == 0);
  CHECK(table.probability(0) == doctest::Approx(0.5 / 7).epsilon(0.001));
  CHECK(table.probability(50) == doctest::Approx(1.0 / 7).epsilon(0.001));
  CHECK(table.probability(100000) == doctest::Approx(1).epsilon(0.001));
}

TEST_CASE("a window's sum adds the leaves that its values lead to, until a tree rejects it") {
  DetectorTree trees[2]{};
  for (DetectorTree& t : trees) {
    for (int node = 0; node < kTreeNodes; ++node) {
      t.feature[node] = detector_feature(1, 2, 3);
      t.threshold[node] = 100;
    }
    for (int leaf = 0; leaf < kTreeLeaves; ++leaf) t.leaf[leaf] = static_cast<std::int8_t>(leaf);
    t.rejection = 1;
  }
  std::vector<std::uint8_t> cells(kWindowCells * kWindowCells * kCellChannels);
  const int stride = kWindowCells * kCellChannels;
  std::uint8_t& value = cells[static_cast<std::size_t>(stride + 2 * kCellChannels + 3)];
  value = 99;
  CHECK(sum_of_trees({trees, 2}, cells.data(), stride) == kRejected);
  value = 100;
  CHECK(sum_of_trees({trees, 2}, cells.data(), stride) == 2 * (kTreeLeaves - 1));
}

}  // namespace detector_table_test
