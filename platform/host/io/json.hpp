#pragma once
/// \file json.hpp
/// JSON: a strict reader of bounded depth, and a writer.
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace pliant::host {

/// One JSON value. Objects keep the order of their members.
class Json {
 public:
  using Array = std::vector<Json>;
  using Object = std::vector<std::pair<std::string, Json>>;

  Json() = default;  ///< null
  Json(bool value) : value_(value) {}
  Json(double value) : value_(value) {}
  Json(int value) : value_(static_cast<double>(value)) {}
  Json(std::string value) : value_(std::move(value)) {}
  Json(const char* value) : value_(std::string(value)) {}
  Json(Array value) : value_(std::move(value)) {}
  Json(Object value) : value_(std::move(value)) {}

  const bool* boolean() const { return std::get_if<bool>(&value_); }
  const double* number() const { return std::get_if<double>(&value_); }
  const std::string* string() const { return std::get_if<std::string>(&value_); }
  const Array* array() const { return std::get_if<Array>(&value_); }
  const Object* object() const { return std::get_if<Object>(&value_); }
  /// A member of an object; null if this is not an object or has no such member.
  const Json* find(std::string_view name) const;

  /// Depth of containers, at most, so that no input can exhaust the stack.
  static constexpr int kMaxDepth = 32;
  /// Parses a text that is one value. Bad input, with `source`, line and column, for anything but strict JSON: comments,
  /// trailing commas, NaN, repeated members or text after the value.
  static Json parse(const std::string& source, std::string_view text);

  /// Indented text with a final newline; short containers of plain values on one line; numbers with nine
  /// digits.
  std::string text() const;

 private:
  void write(std::string& out, int indent) const;
  static void write_item(std::string& out, const Json& item, int indent);
  static void write_item(std::string& out, const std::pair<std::string, Json>& member, int indent);
  template <class Items>
  static void write_members(std::string& out, char open, const Items& items, char close, int indent);
  std::variant<std::monostate, bool, double, std::string, Array, Object> value_;
};

}  // namespace pliant::host
