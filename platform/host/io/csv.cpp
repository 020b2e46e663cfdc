#include "host/io/csv.hpp"

#include <cmath>

#include "host/io/failure.hpp"
#include "host/io/numbers.hpp"
#include "host/io/words.hpp"

namespace pliant::host {

std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

namespace {

/// Reads one cell at `at` and moves `at` after the comma, or to npos at the end of the line. `is_sound` becomes false for quotes
/// that do not end with the cell.
std::string take_cell(std::string_view line, std::size_t& at, bool& is_sound) {
  const std::size_t first = line.find_first_not_of(" \t", at);
  if (first == std::string_view::npos || line[first] != '"') {
    const std::size_t comma = line.find(',', at);
    const std::string cell = trimmed(line.substr(at, comma - at));
    at = comma == std::string_view::npos ? comma : comma + 1;
    return cell;
  }
  std::string cell;
  std::size_t i = first + 1;
  for (; i < line.size(); ++i) {
    if (line[i] == '"' && (i + 1 == line.size() || line[i + 1] != '"')) break;
    if (line[i] == '"') ++i;
    cell += line[i];
  }
  const std::size_t comma = line.find(',', i);
  is_sound = is_sound && i < line.size() && trimmed(line.substr(i + 1, comma - i - 1)).empty();
  at = comma == std::string_view::npos ? comma : comma + 1;
  return cell;
}

std::vector<std::string> split(std::string_view line, bool& is_sound) {
  std::vector<std::string> cells;
  for (std::size_t at = 0; at != std::string_view::npos;) cells.push_back(take_cell(line, at, is_sound));
  return cells;
}

}  // namespace

CsvTable::CsvTable(std::string source, std::string_view text) : source_(std::move(source)) {
  if (text.substr(0, 2) == "\xff\xfe" || text.substr(0, 2) == "\xfe\xff")
    fail_input(source_, "is text in UTF-16: save it in UTF-8");
  text = without_byte_order_mark(text);
  std::size_t line_number = 0;
  while (!text.empty()) {
    const std::string_view line = take_line(text);
    ++line_number;
    if (line.find_first_not_of(" \t") == std::string_view::npos) continue;
    bool is_sound = true;
    std::vector<std::string> cells = split(line, is_sound);
    if (!is_sound)
      fail_input(source_ + ": line " + std::to_string(line_number), "the quotes of a cell do not end with it");
    if (columns_.empty()) {
      columns_ = std::move(cells);
      if (columns_.size() == 1 && line.find_first_of(";\t") != std::string_view::npos)
        fail_input(source_,
                   "has no commas between its columns: save it with commas, and with points in numbers");
      continue;
    }
    rows_.push_back({line_number, std::move(cells)});
    if (rows_.back().cells.size() != columns_.size())
      fail_input(where(rows_.size() - 1), std::to_string(rows_.back().cells.size()) +
                                              " cells, but the header has " +
                                              std::to_string(columns_.size()));
  }
  if (columns_.empty()) fail_input(source_, "is empty: no header line");
  for (std::size_t i = 0; i < columns_.size(); ++i)
    if (!index_.emplace(columns_[i], i).second)
      fail_input(source_, "two columns are called '" + columns_[i] + "'");
}

std::optional<std::size_t> CsvTable::find_column(std::string_view name) const {
  const auto found = index_.find(name);
  return found == index_.end() ? std::nullopt : std::optional<std::size_t>(found->second);
}

std::size_t CsvTable::column(std::string_view name) const {
  const auto found = find_column(name);
  if (!found) fail_input(source_, "has no column '" + std::string(name) + "'");
  return *found;
}

float CsvTable::number(std::size_t row, std::size_t column) const {
  return static_cast<float>(precise_number(row, column));
}

double CsvTable::precise_number(std::size_t row, std::size_t column) const {
  const std::string& text = cell(row, column);
  const auto value = parse_number(text);
  if (!value || *value > 1e30 || *value < -1e30)
    fail_input(where(row), "column '" + columns_[column] + "': not a finite number: '" + text + "'");
  return *value;
}

std::size_t CsvTable::whole_number(std::size_t row, std::size_t column) const {
  const float value = number(row, column);
  if (!(value >= 0 && value <= 1e7f && value == std::floor(value)))
    fail_input(where(row), "column '" + columns_[column] + "': not a number of the kind 0, 1, 2: '" + cell(row, column) + "'");
  return static_cast<std::size_t>(value);
}

std::string CsvTable::where(std::size_t row) const {
  return source_ + ": line " + std::to_string(rows_[row].line);
}

}  // namespace pliant::host
