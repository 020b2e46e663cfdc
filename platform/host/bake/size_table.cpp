#include "host/bake/size_table.hpp"

#include "host/bake/record_limit.hpp"

namespace pliant::host::bake {

namespace {

/// Gives the source the albedo that a table of this size has.
void paint_for(Source& source, int size) {
  if (source.paint) source.albedo = source.paint(source, most_texture_side(size));
}

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

std::vector<SizeRow> compare_sizes(Source source, const BakeOptions& options, const std::vector<int>& sizes) {
  leave_out_corrections(source);
  std::vector<SizeRow> rows(2 * sizes.size());
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    paint_for(source, sizes[k]);
    rows[k] = row_of(source, options, sizes[k], 16);
    rows[sizes.size() + k] = row_of(source, options, sizes[k], 8);
  }
  return rows;
}

SizeRow finest_within(Source source, const BakeOptions& options, std::size_t most_bytes) {
  leave_out_corrections(source);
  for (const int size : {256, 192, 128, 112, 96, 80, 64, 56, 48, 40, 32, 24, 16}) {
    const std::size_t rest_shape_bytes = 6 * std::size_t{4} * static_cast<std::size_t>(size * size);
    if (rest_shape_bytes > most_bytes) continue;
    paint_for(source, size);
    const SizeRow row = row_of(source, options, size, 8);
    if (row.table_bytes <= most_bytes) return row;
  }
  return {};
}

}  // namespace pliant::host::bake
