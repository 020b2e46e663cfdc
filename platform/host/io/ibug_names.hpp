#pragma once
/// \file ibug_names.hpp
/// Names of the iBUG scheme's landmarks: ibug00 to ibug67.
#include <string>
#include <string_view>

namespace pliant::host {

inline constexpr int kIbugCount = 68;

/// \param number  0 to 99.
inline std::string ibug_name(int number) {
  return std::string("ibug") + static_cast<char>('0' + number / 10) + static_cast<char>('0' + number % 10);
}

/// NN of a name ibugNN with two digits; -1 for any other name.
inline int ibug_number(std::string_view name) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  if (name.size() != 6 || name.substr(0, 4) != "ibug" || !is_digit(name[4]) || !is_digit(name[5])) return -1;
  return 10 * (name[4] - '0') + (name[5] - '0');
}

}  // namespace pliant::host
