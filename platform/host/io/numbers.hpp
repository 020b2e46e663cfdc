#pragma once
/// \file numbers.hpp
/// Numbers as text, the same in every locale.
#include <optional>
#include <string>
#include <string_view>

namespace pliant::host {

/// The finite decimal number that `text` spells from its first to its last character; nothing otherwise.
std::optional<double> parse_number(std::string_view text);

/// The same as a float; nothing where it is larger than any.
std::optional<float> parse_float(std::string_view text);

/// A number as files hold it that are read again: nine significant digits, the fewest that keep every float.
std::string number_text(double value);

/// A number for people: the fewest decimals that name this float, without an exponent.
std::string short_text(float value);

/// A number with four decimals: image positions, probabilities.
std::string decimal_text(double value);

}  // namespace pliant::host
