#include "host/commands/bake_sizes.hpp"

#include <cstdio>

#include "host/bake/size_table.hpp"
#include "host/bake/source_error.hpp"
#include "host/io/failure.hpp"

namespace pliant::host {

namespace {

void print_row(const bake::SizeRow& row, std::ostream& out) {
  char text[256];
  std::snprintf(text, sizeof text, "%5d %4d %10zu %11zu %10zu", row.size, row.bits, row.identities,
                row.expressions, row.table_bytes);
  out << text;
  for (const bake::Distances* d : {&row.errors.rest, &row.errors.identity, &row.errors.expression}) {
    std::snprintf(text, sizeof text, "  %7.3f %7.3f %7.2f", static_cast<double>(d->mean_mm),
                  static_cast<double>(d->p95_mm), static_cast<double>(d->max_mm));
    out << text;
  }
  out << "\n";
}

}  // namespace

void print_sizes(const bake::BakeOptions& options, const std::vector<int>& sizes, std::size_t flash_bytes,
                 Console& console) {
  std::ostream& out = console.out;
  try {
    const bake::Source source = bake::read_source(options);
    bake::Source small = source;
    bake::ParameterChoice choice;
    choice.identities = choice.expressions = 20;
    bake::choose_parameters(small, choice);
    out << "Distance of the table's surface from the source at its vertices, mm (mean, 95 %, largest): at "
           "rest, with\n"
           "each identity at one standard deviation, with each expression at its maximum.\n"
           " size bits identities expressions      bytes  rest                     identity"
           "                 expression\n";
    for (const bake::SizeRow& row : bake::compare_sizes(source, options, sizes)) print_row(row, out);
    const bake::SizeRow profile = bake::finest_within(small, options, flash_bytes);
    if (profile.size == 0) {
      out << "no small profile fits " << flash_bytes << " bytes\n";
      return;
    }
    out << "small profile, finest within " << flash_bytes << " bytes:\n";
    print_row(profile, out);
    out << "its expressions:";
    for (const bake::SourceParameter& p : small.parameters)
      if (p.group == Group::expression) out << " " << p.name;
    out << "\n";
  } catch (const std::runtime_error& e) {
    throw Failure(kBadInput, e.what());
  }
}

}  // namespace pliant::host
