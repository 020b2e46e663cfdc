#include "host/io/numbers.hpp"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>

namespace pliant::host {

std::optional<double> parse_number(std::string_view text) {
  double value = 0;
  const char* first = text.data();
  const char* last = first + text.size();
  if (text.substr(0, 1) == "+" && text.substr(1, 1) != "-") ++first;
  const auto [end, error] = std::from_chars(first, last, value);
  if (error != std::errc() || end != last || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<float> parse_float(std::string_view text) {
  const std::optional<double> value = parse_number(text);
  constexpr auto kMost = static_cast<double>(std::numeric_limits<float>::max());
  if (!value || std::fabs(*value) > kMost) return std::nullopt;
  return static_cast<float>(*value);
}

std::string number_text(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.9g", value + 0.0);  // + 0.0: no "-0"
  return text;
}

std::string short_text(float value) {
  char text[64];  // of a float at most 50
  return {text, std::to_chars(text, text + sizeof text, value + 0.0f, std::chars_format::fixed).ptr};
}

std::string decimal_text(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.4f", value);
  return text;
}

}  // namespace pliant::host
