#include "host/io/points_file.hpp"

#include <set>

#include "host/io/csv.hpp"
#include "host/io/failure.hpp"
#include "host/io/files.hpp"
#include "model/chart.hpp"

namespace pliant::host {

namespace {

/// The (u,v) of a row, if it has one.
std::optional<Vec2> parse_uv(const CsvTable& table, std::size_t row) {
  const auto u = table.find_column("u"), v = table.find_column("v");
  const bool has_u = u && !table.cell(row, *u).empty(), has_v = v && !table.cell(row, *v).empty();
  if (has_u != has_v) fail_input(table.where(row), "only one of u and v is given");
  if (!has_u) return std::nullopt;
  const Vec2 uv{table.number(row, *u), table.number(row, *v)};
  if (!is_in_chart(uv)) fail_input(table.where(row), "u or v is not between 0 and 1");
  return uv;
}

}  // namespace

std::vector<NamedPoint> parse_points(const std::string& source, const std::string& text) {
  const CsvTable table(source, text);
  const std::size_t name = table.column("landmark"), x = table.column("x"), y = table.column("y");
  std::vector<NamedPoint> points;
  std::set<std::string> names;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    NamedPoint point{table.cell(row, name),
                     {table.number(row, x), table.number(row, y)},
                     table.where(row),
                     parse_uv(table, row)};
    if (magnitude(point.x.x) > kFarthestPx || magnitude(point.x.y) > kFarthestPx)
      fail_input(point.where, "a position is more than a million pixels away");
    if (point.name.empty()) fail_input(point.where, "a landmark has no name");
    if (!names.insert(point.name).second)
      fail_input(point.where, "landmark '" + point.name + "' appears twice");
    points.push_back(std::move(point));
  }
  return points;
}

std::vector<NamedPoint> read_points(const std::string& path) {
  return parse_points(path, read_file(path));
}

}  // namespace pliant::host
