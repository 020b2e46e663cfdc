#pragma once
/// \file csv.hpp
/// Reads CSV: a header line, then rows. Quotes are allowed; blank lines are skipped.
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pliant::host {

/// Text as a cell of a CSV table: quoted if it has commas, quotes or line ends.
std::string csv_cell(const std::string& text);

/// A CSV file in memory. Every error names the file, the line and the column.
class CsvTable {
 public:
  /// Bad input: no header, a column name twice, a row whose number of cells differs from the header's, or quotes that do not end
  /// with their cell.
  CsvTable(std::string source, std::string_view text);

  const std::string& source() const { return source_; }
  const std::vector<std::string>& columns() const { return columns_; }
  std::size_t row_count() const { return rows_.size(); }
  std::optional<std::size_t> find_column(std::string_view name) const;
  /// Index of a column; bad input if there is none.
  std::size_t column(std::string_view name) const;

  const std::string& cell(std::size_t row, std::size_t column) const { return rows_[row].cells[column]; }
  /// A cell as a finite number; bad input otherwise.
  float number(std::size_t row, std::size_t column) const;
  double precise_number(std::size_t row, std::size_t column) const;  ///< The same, for times of a clock.
  /// A cell as a whole number from 0 to ten million, of a frame or a vertex; bad input otherwise.
  std::size_t whole_number(std::size_t row, std::size_t column) const;
  /// "FILE: line N", for messages about a row.
  std::string where(std::size_t row) const;

 private:
  struct Row {
    std::size_t line;
    std::vector<std::string> cells;
  };
  std::string source_;
  std::vector<std::string> columns_;
  std::map<std::string, std::size_t, std::less<>> index_;  // of each column
  std::vector<Row> rows_;
};

}  // namespace pliant::host
