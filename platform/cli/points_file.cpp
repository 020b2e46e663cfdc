#include "cli/points_file.hpp"

#include "cli/csv.hpp"
#include "cli/failure.hpp"
#include "cli/files.hpp"

namespace pliant::cli {

namespace {
constexpr float kFarthest = 1e6f;  // px; nothing in a picture, or near it, is beyond
}

std::vector<NamedPoint> parse_points(const std::string& source, const std::string& text) {
  const CsvTable table(source, text);
  const std::size_t name = table.column("landmark"), x = table.column("x"), y = table.column("y");
  std::vector<NamedPoint> points;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    NamedPoint point{table.cell(row, name), {table.number(row, x), table.number(row, y)}, table.where(row)};
    if (magnitude(point.x.x) > kFarthest || magnitude(point.x.y) > kFarthest)
      fail_input(point.where, "a position a million pixels away");
    if (point.name.empty()) fail_input(point.where, "a landmark without a name");
    for (const NamedPoint& earlier : points)
      if (earlier.name == point.name) fail_input(point.where, "landmark '" + point.name + "' appears twice");
    points.push_back(std::move(point));
  }
  return points;
}

std::vector<NamedPoint> read_points(const std::string& path) {
  return parse_points(path, read_file(path));
}

}  // namespace pliant::cli
