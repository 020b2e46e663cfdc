#pragma once
// A line of text put together without a C library.
#include <cstddef>
#include <cstdint>

/// Holds at most 255 characters; what is longer is cut.
class Line {
 public:
  Line& add(const char* text) {
    while (*text != 0) put(*text++);
    return *this;
  }
  Line& add(int value) {
    if (value < 0) put('-');
    return add_digits(value < 0 ? 0u - static_cast<unsigned>(value) : static_cast<unsigned>(value), 1);
  }
  /// With three decimals; for people to read.
  Line& add(float value) {
    if (value < 0) put('-');
    const float size = value < 0 ? -value : value;
    if (!(size < 4e6f)) return add("?");
    const auto thousandths = static_cast<std::uint32_t>(size * 1000 + 0.5f);
    add_digits(thousandths / 1000, 1);
    put('.');
    return add_digits(thousandths % 1000, 3);
  }
  /// All bits of it, for comparing.
  Line& add_hex(std::uint32_t bits) {
    for (int shift = 28; shift >= 0; shift -= 4) put("0123456789abcdef"[(bits >> shift) & 15u]);
    return *this;
  }
  const char* text() const { return text_; }

 private:
  void put(char c) {
    if (used_ + 1 < sizeof text_) text_[used_++] = c;
  }
  Line& add_digits(std::uint32_t value, int least) {
    char digits[10];
    int count = 0;
    while (value != 0 || count < least) {
      digits[count++] = static_cast<char>('0' + value % 10);
      value /= 10;
    }
    while (count > 0) put(digits[--count]);
    return *this;
  }

  char text_[256] = {};
  std::size_t used_ = 0;
};
