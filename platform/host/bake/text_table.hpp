#pragma once
/// \file text_table.hpp
/// Reads text tables: words separated by blanks. '#' starts a comment. The first line that is not empty names the columns. A
/// last column named "NAME..." takes all further words of its line. Lines end with a line feed, a carriage return, or both.
#include <string>
#include <vector>

#include "pliant/geometry.hpp"

namespace pliant::host::bake {

struct TextRow {
  int line;                        ///< in the file, from 1
  std::vector<std::string> cells;  ///< one for each column, then the further words of an open last column
};

/// A table file, read at once. Every error throws SourceError with the line.
class TextTable {
 public:
  /// Reads `path`, which must have exactly these columns in this order.
  TextTable(const std::string& path, const std::vector<std::string>& columns);

  const std::vector<TextRow>& rows() const { return rows_; }
  const std::string& path() const { return path_; }

  /// Cell `column` of a row as a name in the model table: at most 27 letters.
  const std::string& name(const TextRow& row, std::size_t column) const;
  /// Cell `column` of a row as a finite number.
  float number(const TextRow& row, std::size_t column) const;
  /// Three adjacent cells as a vector.
  Vec3 vector(const TextRow& row, std::size_t first_column) const;
  /// The words of a column and of all after it.
  std::vector<std::string> words(const TextRow& row, std::size_t first_column) const;
  [[noreturn]] void fail(const TextRow& row, const std::string& what) const;

 private:
  std::string path_;
  std::vector<std::string> columns_;
  std::vector<TextRow> rows_;
};

}  // namespace pliant::host::bake
