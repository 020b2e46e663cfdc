#pragma once
/// \file source_error.hpp
/// What is wrong with a source of a model, and where: one line that names the file.
#include <stdexcept>
#include <string>

#include "pliant/model.hpp"

namespace pliant::host::bake {

/// "`file`:`line`: `what`", or "`file`: `what`" where no line is to blame (line 0). Thrown while a source is
/// read and caught by `bake` (bake.hpp); nothing of it leaves the baker.
class SourceError : public std::runtime_error {
 public:
  SourceError(const std::string& file, int line, const std::string& what)
      : std::runtime_error(file + (line > 0 ? ":" + std::to_string(line) : "") + ": " + what) {}
};

/// Throws when a name of a parameter, landmark or curve is empty or does not fit into a table.
inline void check_name(const std::string& file, int line, const std::string& name) {
  if (name.empty()) throw SourceError(file, line, "a name is empty");
  if (name.size() >= table::kNameBytes)
    throw SourceError(
        file, line,
        "the name '" + name + "' is longer than " + std::to_string(table::kNameBytes - 1) + " letters");
}

}  // namespace pliant::host::bake
