#include "host/bake/text_table.hpp"

#include <fstream>
#include <optional>
#include <sstream>
#include <string_view>

#include "host/bake/source_error.hpp"
#include "host/io/numbers.hpp"
#include "host/io/words.hpp"

namespace pliant::host::bake {

namespace {

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream in(line.substr(0, line.find('#')));
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

/// Throws SourceError if the file cannot be read.
std::string text_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string text;
  for (char c = 0; in.get(c);) text += c;
  if (!in.eof()) throw SourceError(path, 0, "cannot be read");
  return text;
}

bool is_open(const std::vector<std::string>& columns) {
  const std::string& last = columns.back();
  return last.size() > 3 && last.compare(last.size() - 3, 3, "...") == 0;
}

}  // namespace

TextTable::TextTable(const std::string& path, const std::vector<std::string>& columns)
    : path_(path), columns_(columns) {
  const std::string text = text_of(path);
  bool have_header = false;
  int number = 0;
  for (std::string_view rest = without_byte_order_mark(text); !rest.empty();) {
    const std::string line(take_line(rest));
    TextRow row{++number, words_of(line)};
    if (row.cells.empty()) continue;
    if (!have_header) {
      for (std::size_t i = 0; i < columns.size(); ++i)
        if (i >= row.cells.size() || row.cells[i] != columns[i])
          fail(row,
               "expected a column '" + columns[i] + "'" +
                   (line.find(',') == std::string::npos ? "" : ": blanks are between columns, not commas"));
      if (row.cells.size() > columns.size()) fail(row, "unknown column '" + row.cells[columns.size()] + "'");
      have_header = true;
      continue;
    }
    if (row.cells.size() < columns.size())
      fail(row, "no value for column '" + columns[row.cells.size()] + "'");
    if (row.cells.size() > columns.size() && !is_open(columns))
      fail(row, "'" + row.cells[columns.size()] + "' is one value too many");
    rows_.push_back(std::move(row));
  }
  if (!have_header) throw SourceError(path, 0, "has no table");
}

const std::string& TextTable::name(const TextRow& row, std::size_t column) const {
  check_name(path_, row.line, row.cells[column]);
  return row.cells[column];
}

float TextTable::number(const TextRow& row, std::size_t column) const {
  const std::string& cell = row.cells[column];
  const std::optional<float> value = parse_float(cell);
  if (!value) fail(row, "'" + cell + "' in column '" + columns_[column] + "' is not a number");
  return *value;
}

Vec3 TextTable::vector(const TextRow& row, std::size_t first_column) const {
  return {number(row, first_column), number(row, first_column + 1), number(row, first_column + 2)};
}

std::vector<std::string> TextTable::words(const TextRow& row, std::size_t first_column) const {
  return {row.cells.begin() + static_cast<std::ptrdiff_t>(first_column), row.cells.end()};
}

void TextTable::fail(const TextRow& row, const std::string& what) const {
  throw SourceError(path_, row.line, what);
}

}  // namespace pliant::host::bake
