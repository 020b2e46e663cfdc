#include "host/bake/source_error.hpp"

#include <string_view>

#include "host/io/words.hpp"
#include "pliant/model.hpp"

namespace pliant::host::bake {

namespace {

bool is_control(char c) {
  return (c >= 0 && c < ' ') || c == '\x7f';
}

/// Bytes of the character that the text begins with; 0 where it is not UTF-8.
std::size_t utf8_bytes(std::string_view text) {
  const auto byte = [text](std::size_t k) {
    return k < text.size() ? static_cast<unsigned char>(text[k]) : 0u;
  };
  const unsigned first = byte(0), second = byte(1);
  const std::size_t count = first < 0x80   ? 1
                            : first < 0xc2 ? 0
                            : first < 0xe0 ? 2
                            : first < 0xf0 ? 3
                            : first < 0xf5 ? 4
                                           : 0;
  for (std::size_t k = 1; k < count; ++k)
    if ((byte(k) & 0xc0u) != 0x80) return 0;
  const bool is_overlong = (first == 0xe0 && second < 0xa0) || (first == 0xf0 && second < 0x90);
  const bool is_none =
      (first == 0xed && second >= 0xa0) || (first == 0xf4 && second >= 0x90);  // no such character
  return is_overlong || is_none ? 0 : count;
}

bool is_utf8(std::string_view text) {
  for (std::size_t bytes = 0; !text.empty(); text.remove_prefix(bytes))
    if ((bytes = utf8_bytes(text)) == 0) return false;
  return true;
}

/// The text in one line, whatever it is.
std::string shown(std::string text) {
  for (char& c : text)
    if (is_control(c)) c = '?';
  return text;
}

}  // namespace

void check_name(const std::string& file, int line, const std::string& name) {
  const auto fail = [&](const std::string& what) { throw SourceError(shown(file), line, what); };
  if (name.empty()) fail("a name is empty");
  const std::string of = "the name '" + shown(name) + "' ";
  if (name.size() >= table::kNameBytes)
    fail(of + "is longer than " + std::to_string(table::kNameBytes - 1) + " letters");
  if (shown(name) != name) fail(of + "has a control character, such as a line's end");
  if (trimmed(name) != name) fail(of + "begins or ends with a blank");
  if (!is_utf8(name)) fail(of + "is not in UTF-8");
}

}  // namespace pliant::host::bake
