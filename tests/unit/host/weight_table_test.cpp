// Tables of learnt weights.
#include "host/learn/weight_table.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>

#include "host/io/table_checksum.hpp"

namespace weight_table_test {

using namespace pliant::host;
using namespace pliant::host::learn;

TEST_CASE("the largest weight of each row becomes 127, and rows of zeros stay zeros") {
  const std::vector<double> weights = {0.5, -1, 0.25, 0, 0, 0};
  const QuantisedRows rows(weights, 3);
  CHECK(rows.bytes == std::vector<std::int8_t>{64, -127, 32, 0, 0, 0});
  REQUIRE(rows.scale.size() == 2);
  for (std::size_t k = 0; k < 3; ++k)
    CHECK(std::abs(rows.scale[0] * rows.bytes[k] - weights[k]) <= 0.5 * rows.scale[0]);
}

TEST_CASE("only the entries off the diagonal of an information matrix shrink") {
  const std::vector<double> safe = safe_information({4, 2, 1, 9, -3, 1});
  CHECK(safe == std::vector<double>{4, 2 * 0.999, 1, 9, -3 * 0.999, 1});
}

TEST_CASE("numbers stand in the order in which they are put, and the checksum covers what is behind it") {
  struct Header {
    std::uint32_t magic, crc32;
    std::uint16_t count, rest;
  };
  WeightTable table;
  table.put(Header{1, 0, 2, 0});
  table.put_floats({1.5});
  table.put_bytes({-1, 2, 3});
  CHECK(table.size() == sizeof(Header) + 7);
  table.pad();
  REQUIRE(table.size() == sizeof(Header) + 8);
  table.replace(offsetof(Header, count), std::uint16_t{7});
  set_checksum<Header>(table.bytes());
  const std::vector<std::uint8_t>& bytes = table.bytes();
  Header header;
  std::memcpy(&header, bytes.data(), sizeof header);
  CHECK(header.magic == 1);
  CHECK(header.count == 7);
  CHECK(header.crc32 == pliant::crc32(bytes.data() + 8, bytes.size() - 8));
  float number = 0;
  std::memcpy(&number, bytes.data() + sizeof header, sizeof number);
  CHECK(number == 1.5f);
  CHECK(std::vector<std::uint8_t>(bytes.end() - 4, bytes.end()) == std::vector<std::uint8_t>{255, 2, 3, 0});
}

}  // namespace weight_table_test
