#include "host/bake/size_table.hpp"

namespace pliant::host::bake {

namespace {

SizeRow row_of(const Source& source, BakeOptions options, int size, int bits) {
  options.size = size;
  options.bits = bits;
  BakeReport report;
  SizeRow row;
  row.size = size;
  row.bits = bits;
  for (const SourceParameter& p : source.parameters)
    ++(p.group == Group::identity ? row.identities : row.expressions);
  row.table_bytes = bake_source(source, options, &report).size();
  row.errors = report.errors;
  return row;
}

}  // namespace

std::vector<SizeRow> compare_sizes(const Source& source, const BakeOptions& options,
                                   const std::vector<int>& sizes) {
  std::vector<SizeRow> rows;
  for (const int bits : {16, 8})
    for (const int size : sizes) rows.push_back(row_of(source, options, size, bits));
  return rows;
}

SizeRow finest_within(const Source& source, const BakeOptions& options, std::size_t most_bytes) {
  for (const int size : {256, 192, 128, 112, 96, 80, 64, 56, 48, 40, 32, 24, 16}) {
    const std::size_t rest_shape_bytes = 6 * std::size_t{4} * static_cast<std::size_t>(size * size);
    if (rest_shape_bytes > most_bytes) continue;
    const SizeRow row = row_of(source, options, size, 8);
    if (row.table_bytes <= most_bytes) return row;
  }
  return {};
}

}  // namespace pliant::host::bake
