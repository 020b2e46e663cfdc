#pragma once
/// \file source_error.hpp
/// An error in a source: one line that names the file and what is wrong.
#include <stdexcept>
#include <string>

namespace pliant::host::bake {

/// "`file`:`line`: `what`", or "`file`: `what`" with line 0. Thrown by the functions that read and bake a source; `bake`
/// (bake.hpp) catches it.
class SourceError : public std::runtime_error {
 public:
  SourceError(const std::string& file, int line, const std::string& what)
      : std::runtime_error(file + (line > 0 ? ":" + std::to_string(line) : "") + ": " + what) {}
};

/// Throws if the name of a parameter, landmark or curve is empty, too long for a table, or one that CSV and JSON files do not give
/// back: not UTF-8, with control characters, or with blanks at an end.
void check_name(const std::string& file, int line, const std::string& name);

}  // namespace pliant::host::bake
