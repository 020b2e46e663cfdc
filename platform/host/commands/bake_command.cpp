// `pliant bake`: makes a model table from a readable source.
#include <algorithm>
#include <string>

#include "host/bake/bake.hpp"
#include "host/bake/embedded.hpp"
#include "host/commands/bake_sizes.hpp"
#include "host/commands/command.hpp"
#include "host/commands/tracker_limits.hpp"
#include "host/io/failure.hpp"
#include "host/io/files.hpp"
#include "host/io/numbers.hpp"
#include "model/table_reader.hpp"

namespace pliant::host {

namespace {

bake::ParameterChoice choice_of(const Args& args) {
  bake::ParameterChoice choice;
  choice.identities = args.integer("--identities", choice.identities, 0, int{table::kMaxParameters});
  const auto expressions = args.text("--expressions");
  if (!expressions) return choice;
  if (parse_number(*expressions))
    choice.expressions = args.integer("--expressions", 0, 0, int{table::kMaxParameters});
  else
    choice.named = args.list("--expressions");
  return choice;
}

std::vector<int> sizes_of(const Args& args) {
  std::vector<int> sizes;
  for (const std::string& word : args.list("--sizes")) {
    const auto number = parse_number(word);
    if (!number || *number < 16 || *number > 512 || *number != static_cast<int>(*number))
      fail_usage("--sizes must be whole numbers from 16 to 512, separated by commas, not '" + word + "'");
    sizes.push_back(static_cast<int>(*number));
  }
  return sizes;
}

bake::BakeOptions bake_options(const Args& args) {
  bake::BakeOptions options;
  options.source = args.operand(0);
  options.size = args.integer("--size", options.size, 16, 512);
  options.bits = args.integer("--bits", options.bits, 8, 16);
  if (options.bits != 8 && options.bits != 16) fail_usage("--bits must be 8 or 16");
  options.unit_mm = static_cast<float>(args.number("--unit", 1, static_cast<double>(bake::kLeastUnitMm),
                                                   static_cast<double>(bake::kMostUnitMm)));
  options.base_vertices = args.integer("--base-mesh", options.base_vertices, 60, 5000);
  options.components = args.integer("--pca", 0, 1, int{table::kMaxParameters});
  options.relaxes_chart = args.has("--relax-chart");
  options.modes = args.integer("--modes", 0, 1, 64);
  options.stiffness = static_cast<float>(args.number("--stiffness", 1, 1e-4, 1e4));
  options.stretch = static_cast<float>(args.number("--stretch", -1, 0, 1));
  if (options.stretch > 0 && options.stretch < bake::kLeastStretch)
    fail_usage("--stretch must be 0, or from 0.0001 to 1: " + *args.text("--stretch"));
  options.texture = args.text("--texture").value_or("");
  options.choice = choice_of(args);
  options.learnt = args.text("--learnt").value_or("");
  return options;
}

void print_report(const std::string& output, const bake::BakeReport& report, bool all, Console& console) {
  const auto print = [&](const char* what, const bake::Distances& d) {
    console.out << what << " to " << d.mean_mm << " mm mean, " << d.p95_mm << " at 95 %, " << d.max_mm
                << " worst";
  };
  console.out << output << ": " << report.table_bytes << " bytes, " << report.field_count << " fields; ";
  print("rest shape", report.errors.rest);
  const auto has = [&](Group group) {
    const auto& p = report.errors.parameters;
    return std::any_of(p.begin(), p.end(), [group](const auto& error) { return error.group == group; });
  };
  if (has(Group::identity)) print("; identities", report.errors.identity);
  if (has(Group::expression)) print("; expressions", report.errors.expression);
  console.out << "; base mesh of " << report.base_vertices << " vertices";
  if (report.base_vertices > TrackerLimits{}.vertices)
    console.out << ": TrackerLimits::vertices has to be at least as many";
  console.out << "\n";
  if (report.has_texture && report.print_bytes == 0)
    console.out << "the texture has too few corners of its own: the surface will not be found by it\n";
  for (const std::string& warning : report.warnings) console.err << output << ": " << warning << '\n';
  for (const bake::ParameterError& error : report.errors.parameters) {
    if (!all) break;
    print(error.name.c_str(), error.off);
    console.out << "\n";
  }
  for (const std::string& name : report.unmatched) console.out << "not a name of ARKit's: " << name << '\n';
}

int run_bake(const Args& args, Console& console) {
  args.check_needs("--stiffness", "--modes");
  args.check_needs("--flash", "--sizes");
  if (args.has("--sizes"))
    args.refuse({"-o", "--embed", "--errors", "--size", "--bits"},
                "does not apply to --sizes, which compares sizes and writes no table");
  bake::BakeOptions options = bake_options(args);
  StageProgress progress(console);
  options.progress = [&](const char* stage, std::size_t done, std::size_t of) {
    progress.show(stage, done, of);
  };
  if (args.has("--sizes")) {
    const int flash_kib = args.integer("--flash", 512, 1, 1 << 20);
    print_sizes(options, sizes_of(args), std::size_t{1024} * static_cast<std::size_t>(flash_kib), console);
    return 0;
  }
  const std::string output = args.required("-o");
  std::vector<std::uint8_t> table;
  std::string error;
  bake::BakeReport report;
  if (!bake::bake(options, table, error, &report)) throw Failure(kBadInput, error);
  progress.finish();
  write_file(output, {reinterpret_cast<const char*>(table.data()), table.size()});
  if (const auto source = args.text("--embed"))
    write_file(*source, bake::embedded(table, bake::array_name(*source)));
  print_report(output, report, args.has("--errors"), console);
  return 0;
}

}  // namespace

Command bake_command() {
  return {
      "bake",
      "Makes a model table from a folder of text tables, such as fixtures/face, from an OBJ file, or from a "
      "folder of OBJ files.",
      "SOURCE -o face.plm [--embed face.cpp] [--size N] [--bits 16|8] [--unit MM] [--base-mesh N] [--pca N] "
      "[--modes N [--stiffness F]] [--stretch SD] [--texture PICTURE|none] [--relax-chart] "
      "[--identities N] [--expressions N|NAME,...] [--learnt FILE|none] [--errors] | SOURCE --sizes N,... "
      "[--flash KIB]",
      {{"-o", "PLM", "the model table to write", Takes::output},
       {"--embed", "CPP", "also write the table as an array in C11 and C++, for firmware", Takes::output},
       {"--size", "N", "samples on a side of a field over the whole chart, 16 to 512 (128)"},
       {"--bits", "N", "bits of a sample: 16 or 8 (16)"},
       {"--unit", "MM", "unit of the OBJ files, millimetres (1)"},
       {"--base-mesh", "N", "vertices of the base mesh, about, 60 to 5000 (480)"},
       {"--pca", "N", "treat all OBJ files as scans, and keep N principal components, 1 to 192"},
       {"--modes", "N",
        "add the N ways, 1 to 64, in which the surface of the OBJ file bends most easily, mode00, mode01, "
        "...; faces in a group \"fixed\" do not move"},
       {"--stiffness", "F",
        "of the bending modes: with 1 the first moves the surface by 5 % of its diagonal, root mean square, "
        "at one standard "
        "deviation, with 4 by half of it (1)"},
       {"--stretch", "SD",
        "add springs between points of the surface, with this standard deviation of their lengths, as a "
        "fraction of 0 to 1; 0: none (0.03 with --modes, else none)"},
       {"--texture", "PICTURE",
        "the albedo of the OBJ file's surface over its u,v, or none (the pictures of its materials, if it "
        "has some)",
        Takes::input},
       {"--relax-chart", nullptr,
        "even out the u,v of the OBJ files, so that no part of the surface gets too few samples"},
       {"--identities", "N", "keep the first N identities (all)"},
       {"--expressions", "N|NAMES",
        "keep the N most useful expressions, or those named, separated by commas (all)"},
       {"--learnt", "FILE",
        "put these learnt tables into the model, or none (learnt.bin of the source's folder, if it is "
        "there)",
        Takes::input},
       {"--errors", nullptr, "list the error of each parameter's shape"},
       {"--sizes", "N,N,...",
        "write no table; print bytes and errors for these sizes, and for a small profile"},
       {"--flash", "KIB", "flash for the small profile, KiB (512)"}},
      1,
      run_bake};
}

}  // namespace pliant::host
