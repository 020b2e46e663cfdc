#include "host/io/json.hpp"

#include <charconv>
#include <cmath>
#include <cstdio>

#include "host/io/failure.hpp"
#include "host/io/numbers.hpp"

namespace pliant::host {

namespace {

class Parser {
 public:
  Parser(const std::string& source, std::string_view text) : source_(source), text_(text) {}

  Json whole() {
    Json value = parse_value(0);
    skip_space();
    if (at_ != text_.size()) fail("something follows the end");
    return value;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    std::size_t line = 1, column = 1;
    for (std::size_t i = 0; i < at_ && i < text_.size(); ++i, ++column)
      if (text_[i] == '\n') {
        ++line;
        column = 0;
      }
    fail_input(source_, "line " + std::to_string(line) + ", column " + std::to_string(column) + ": " + what);
  }

  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  void skip_space() {
    while (at_ < text_.size() && std::string_view(" \t\r\n").find(text_[at_]) != std::string_view::npos)
      ++at_;
  }
  bool take(char c) {
    skip_space();
    if (peek() != c) return false;
    ++at_;
    return true;
  }
  bool take_word(std::string_view word) {
    if (text_.substr(at_, word.size()) != word) return false;
    at_ += word.size();
    return true;
  }

  Json parse_value(int depth) {
    if (depth > Json::kMaxDepth) fail("nested too deeply");
    skip_space();
    switch (peek()) {
      case '{':
        return parse_object(depth);
      case '[':
        return parse_array(depth);
      case '"':
        return Json(parse_string());
      default:
        break;
    }
    if (take_word("true")) return Json(true);
    if (take_word("false")) return Json(false);
    if (take_word("null")) return Json();
    return parse_number();
  }

  Json parse_object(int depth) {
    Json::Object members;
    take('{');
    if (take('}')) return Json(std::move(members));
    do {
      skip_space();
      if (peek() != '"') fail("a member's name is expected");
      std::string name = parse_string();
      for (const auto& member : members)
        if (member.first == name) fail("'" + name + "' appears twice");
      if (!take(':')) fail("':' is expected");
      members.emplace_back(std::move(name), parse_value(depth + 1));
    } while (take(','));
    if (!take('}')) fail("',' or '}' is expected");
    return Json(std::move(members));
  }

  Json parse_array(int depth) {
    Json::Array items;
    take('[');
    if (take(']')) return Json(std::move(items));
    do items.push_back(parse_value(depth + 1));
    while (take(','));
    if (!take(']')) fail("',' or ']' is expected");
    return Json(std::move(items));
  }

  Json parse_number() {
    // The grammar of JSON is checked first, as from_chars accepts more.
    const std::size_t start = at_;
    const auto digits = [&] {
      const std::size_t first = at_;
      while (peek() >= '0' && peek() <= '9') ++at_;
      return at_ != first;
    };
    if (peek() == '-') ++at_;
    const bool leading_zero =
        peek() == '0' && at_ + 1 < text_.size() && text_[at_ + 1] >= '0' && text_[at_ + 1] <= '9';
    bool valid = !leading_zero && digits();
    if (valid && peek() == '.') {
      ++at_;
      valid = digits();
    }
    if (valid && (peek() == 'e' || peek() == 'E')) {
      ++at_;
      if (peek() == '+' || peek() == '-') ++at_;
      valid = digits();
    }
    double value = 0;
    if (!valid || std::from_chars(text_.data() + start, text_.data() + at_, value).ec != std::errc()) {
      at_ = start;
      fail("a value is expected");
    }
    return Json(value);
  }

  std::string parse_string() {
    std::string out;
    ++at_;
    for (;;) {
      if (at_ >= text_.size()) fail("a string without end");
      const char c = text_[at_++];
      if (c == '"') return out;
      if (static_cast<unsigned char>(c) < 0x20) fail("a control character in a string");
      if (c != '\\') {
        out += c;
        continue;
      }
      const char escape = peek();
      ++at_;
      static constexpr std::string_view kFrom = "\"\\/bfnrt", kTo = "\"\\/\b\f\n\r\t";
      const std::size_t plain = kFrom.find(escape);
      if (plain != std::string_view::npos && escape != '\0')
        out += kTo[plain];
      else if (escape == 'u')
        append_utf8(out, parse_code_point());
      else
        fail("an unknown escape");
    }
  }

  unsigned parse_code_unit() {
    unsigned code = 0;
    if (at_ + 4 > text_.size()) fail("four hexadecimal digits are expected");
    const auto [end, error] = std::from_chars(text_.data() + at_, text_.data() + at_ + 4, code, 16);
    if (error != std::errc() || end != text_.data() + at_ + 4) fail("four hexadecimal digits are expected");
    at_ += 4;
    return code;
  }

  unsigned parse_code_point() {
    const unsigned high = parse_code_unit();
    if (high < 0xd800 || high > 0xdfff) return high;
    if (high > 0xdbff || !take_word("\\u")) fail("half of a surrogate pair");
    const unsigned low = parse_code_unit();
    if (low < 0xdc00 || low > 0xdfff) fail("half of a surrogate pair");
    return 0x10000 + ((high - 0xd800) << 10) + (low - 0xdc00);
  }

  static void append_utf8(std::string& out, unsigned code) {
    const auto tail = [&](int shift) { out += static_cast<char>(0x80 | ((code >> shift) & 0x3f)); };
    if (code < 0x80) {
      out += static_cast<char>(code);
    } else if (code < 0x800) {
      out += static_cast<char>(0xc0 | code >> 6);
      tail(0);
    } else if (code < 0x10000) {
      out += static_cast<char>(0xe0 | code >> 12);
      tail(6), tail(0);
    } else {
      out += static_cast<char>(0xf0 | code >> 18);
      tail(12), tail(6), tail(0);
    }
  }

  const std::string& source_;
  std::string_view text_;
  std::size_t at_ = 0;
};

void write_string(std::string& out, const std::string& text) {
  out += '"';
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      (out += '\\') += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      char escape[8];
      std::snprintf(escape, sizeof escape, "\\u%04x", static_cast<unsigned>(c));
      out += escape;
    } else {
      out += c;
    }
  }
  out += '"';
}

/// Whole numbers exactly (checksums need all ten digits), others with nine digits.
std::string json_number(double value) {
  if (!std::isfinite(value)) return "null";
  if (value != std::floor(value) || std::fabs(value) > 9e15) return number_text(value);
  return std::to_string(static_cast<long long>(value));
}

bool is_plain(const Json& value) {
  return value.array() == nullptr && value.object() == nullptr;
}
bool is_plain(const std::pair<std::string, Json>& member) {
  return is_plain(member.second);
}

}  // namespace

void Json::write_item(std::string& out, const Json& item, int indent) {
  item.write(out, indent);
}
void Json::write_item(std::string& out, const std::pair<std::string, Json>& member, int indent) {
  write_string(out, member.first);
  out += ": ";
  member.second.write(out, indent);
}

/// Writes short containers of plain values on one line, others with one member a line.
template <class Items>
void Json::write_members(std::string& out, char open, const Items& items, char close, int indent) {
  bool one_line = items.size() <= 8 || open == '[';
  for (const auto& item : items) one_line = one_line && is_plain(item);
  const std::string line = "\n" + std::string(static_cast<std::size_t>(indent), ' ');
  out += open;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (i > 0) out += one_line ? ", " : ",";
    if (!one_line) out += line + "  ";
    write_item(out, items[i], indent + 2);
  }
  if (!one_line) out += line;
  out += close;
}

const Json* Json::find(std::string_view name) const {
  if (const Object* members = object())
    for (const auto& member : *members)
      if (member.first == name) return &member.second;
  return nullptr;
}

Json Json::parse(const std::string& source, std::string_view text) {
  return Parser(source, text).whole();
}

std::string Json::text() const {
  std::string out;
  write(out, 0);
  return out + "\n";
}

void Json::write(std::string& out, int indent) const {
  if (const bool* b = boolean())
    out += *b ? "true" : "false";
  else if (const double* n = number())
    out += json_number(*n);
  else if (const std::string* s = string())
    write_string(out, *s);
  else if (const Array* items = array())
    write_members(out, '[', *items, ']', indent);
  else if (const Object* members = object())
    write_members(out, '{', *members, '}', indent);
  else
    out += "null";
}

}  // namespace pliant::host
