#pragma once
/// \file words.hpp
/// Small operations on text.
#include <string>
#include <string_view>
#include <vector>

namespace pliant::host {

inline bool ends_with(std::string_view text, std::string_view ending) {
  return text.size() >= ending.size() && text.substr(text.size() - ending.size()) == ending;
}

/// The text with its ASCII letters in lower case.
inline std::string in_lower_case(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

/// The text without blanks, tabs and carriage returns at its ends.
inline std::string trimmed(std::string_view text) {
  constexpr const char* kBlanks = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(kBlanks) - first + 1));
}

/// The text without the quotes that some programs put around a name with blanks.
inline std::string_view unquoted(std::string_view text) {
  const bool is_quoted = text.size() >= 2 && text.front() == '"' && text.back() == '"';
  return is_quoted ? text.substr(1, text.size() - 2) : text;
}

/// Takes the first line from a text, without its end: a line feed, a carriage return, or both. A text may have all of them. Where
/// text with both has been written as text once more there are two carriage returns before the line feed: these are one end, too.
inline std::string_view take_line(std::string_view& text) {
  const std::string_view line = text.substr(0, text.find_first_of("\r\n"));
  text.remove_prefix(line.size());
  const std::size_t end = text.substr(0, 3) == "\r\r\n" ? 3 : text.substr(0, 2) == "\r\n" ? 2 : text.empty() ? 0 : 1;
  text.remove_prefix(end);
  return line;
}

/// The text without the byte order mark that some editors and spreadsheets put before it.
inline std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view kMark = "\xef\xbb\xbf";
  return text.substr(0, kMark.size()) == kMark ? text.substr(kMark.size()) : text;
}

/// The parts between commas; one empty part for an empty text.
inline std::vector<std::string> split_at_commas(std::string_view text) {
  std::vector<std::string> parts{""};
  for (const char c : text)
    if (c == ',')
      parts.emplace_back();
    else
      parts.back() += c;
  return parts;
}

}  // namespace pliant::host
