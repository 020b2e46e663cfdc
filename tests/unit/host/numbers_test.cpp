// Numbers as text.
#include "host/io/numbers.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "random.hpp"

namespace numbers_test {

using namespace pliant::host;

TEST_CASE("a number for people has the fewest decimals that name the float, and no exponent") {
  for (const auto& [value, text] : {std::pair{0.45f, "0.45"},
                                    {100000.0f, "100000"},
                                    {-3.0f, "-3"},
                                    {-0.0f, "0"},
                                    {0.01f, "0.01"},
                                    {1e-5f, "0.00001"},
                                    {1.0f / 3, "0.33333334"}})
    CHECK(short_text(value) == text);
  using Float = std::numeric_limits<float>;
  for (const float value :
       {Float::max(), Float::lowest(), Float::min(), -Float::min(), Float::denorm_min()}) {
    CHECK(short_text(value).find('e') == std::string::npos);
    CHECK(parse_float(short_text(value)) == value);
  }
  Random random(7);
  for (int k = 0; k < 1000; ++k) {
    const float value = random.uniform(-1000, 1000);
    CHECK(parse_float(short_text(value)) == value);
  }
}

TEST_CASE("a number is all of its text, finite, and within the type") {
  for (const char* text : {"", " 1", "1 ", "1,5", "nan", "inf", "1e400", "0x10", "--1", "+-1"})
    CHECK_FALSE(parse_number(text));
  CHECK(parse_number("+1.5e3") == 1500.0);
  CHECK_FALSE(parse_float("1e39"));
  CHECK(number_text(-0.0) == "0");
  CHECK(decimal_text(0.45) == "0.4500");
}

}  // namespace numbers_test
