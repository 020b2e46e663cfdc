#pragma once
/// \file json.hpp
/// JSON by nlohmann-json, with numbers as the files here have them, and a reader with bounds.
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace pliant::host {

/// One JSON value. Objects keep the order of their members. Numbers with a fraction are floats: `dump` writes the fewest digits
/// that give the same bits again, and null for one that is not finite.
using Json = nlohmann::basic_json<nlohmann::ordered_map, std::vector, std::string, bool, std::int64_t,
                                  std::uint64_t, float>;

/// Containers in each other, members of one object, and bytes of a text, at most: time and memory are then a few hundred
/// milliseconds and megabytes for any input. A member is looked for among those before it.
constexpr std::size_t kMaxJsonDepth = 32, kMaxJsonMembers = 1000, kMaxJsonBytes = std::size_t{1} << 22;

/// One line, in which bytes that are no UTF-8, in a name that someone gave, are replaced.
std::string json_text(const Json& value);

/// A name that a file gives, in single quotes, on one line.
std::string quoted(const std::string& name);

/// Parses a text that is one value. Bad input, with `source`, line and column, for anything but strict JSON: comments, trailing
/// commas, NaN, numbers that no float holds, repeated members, text after the value; or more than the bounds above.
Json parse_json(const std::string& source, const std::string& text);

}  // namespace pliant::host
