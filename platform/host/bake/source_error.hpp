#pragma once
/// \file source_error.hpp
/// An error in a source: one line that names the file and what is wrong.
#include <stdexcept>
#include <string>

#include "pliant/model.hpp"

namespace pliant::host::bake {

/// "`file`:`line`: `what`", or "`file`: `what`" with line 0. Thrown by the functions that read and bake a source; `bake`
/// (bake.hpp) catches it.
class SourceError : public std::runtime_error {
 public:
  SourceError(const std::string& file, int line, const std::string& what)
      : std::runtime_error(file + (line > 0 ? ":" + std::to_string(line) : "") + ": " + what) {}
};

/// Throws if the name of a parameter, landmark or curve is empty or too long for a table.
inline void check_name(const std::string& file, int line, const std::string& name) {
  if (name.empty()) throw SourceError(file, line, "a name is empty");
  if (name.size() >= table::kNameBytes)
    throw SourceError(
        file, line,
        "the name '" + name + "' is longer than " + std::to_string(table::kNameBytes - 1) + " letters");
}

}  // namespace pliant::host::bake
