#pragma once
// printf at the end of a string.
#include <cstdio>
#include <string>

namespace pliant::host {

/// At most 255 characters; what is beyond is left out.
template <class... Values>
void append(std::string& out, const char* format, Values... values) {
  char text[256];
  std::snprintf(text, sizeof text, format, values...);
  out += text;
}

}  // namespace pliant::host
