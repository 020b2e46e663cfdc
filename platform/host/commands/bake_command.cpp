// `pliant bake`: a readable source becomes a model table.
#include <memory>

#include "host/bake/bake.hpp"
#include "host/commands/bake_sizes.hpp"
#include "host/commands/command.hpp"
#include "host/io/failure.hpp"
#include "host/io/files.hpp"
#include "host/io/numbers.hpp"
#include "host/io/words.hpp"

namespace pliant::host {

namespace {

/// A C++ name for the table, from the file's.
std::string array_name(const std::string& path) {
  const std::size_t slash = path.find_last_of('/');
  std::string name = path.substr(slash == std::string::npos ? 0 : slash + 1);
  name = name.substr(0, name.find('.'));
  for (char& c : name)
    if (!((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'))) c = '_';
  return name.empty() || (name[0] >= '0' && name[0] <= '9') ? "model_" + name : name;
}

bake::ParameterChoice choice_of(const Args& args) {
  bake::ParameterChoice choice;
  choice.identities = args.integer("--identities", choice.identities, 0, 192);
  const auto expressions = args.text("--expressions");
  if (!expressions) return choice;
  if (parse_number(*expressions))
    choice.expressions = args.integer("--expressions", 0, 0, 192);
  else
    choice.named = split_at_commas(*expressions);
  return choice;
}

std::vector<int> sizes_of(const std::string& list) {
  std::vector<int> sizes;
  for (const std::string& word : split_at_commas(list)) {
    const auto number = parse_number(word);
    if (!number || *number < 16 || *number > 512 || *number != static_cast<int>(*number))
      fail_usage("--sizes takes whole numbers from 16 to 512 with commas between, not '" + list + "'");
    sizes.push_back(static_cast<int>(*number));
  }
  return sizes;
}

bake::BakeOptions options_of(const Args& args) {
  bake::BakeOptions options;
  options.source = args.operand(0);
  options.size = args.integer("--size", options.size, 16, 512);
  options.bits = args.integer("--bits", options.bits, 8, 16);
  if (options.bits != 8 && options.bits != 16) fail_usage("--bits must be 8 or 16");
  options.unit_mm = static_cast<float>(args.number("--unit", 1, 1e-6, 1e6));
  options.base_vertices = args.integer("--base-mesh", options.base_vertices, 60, 5000);
  options.components = args.integer("--pca", 0, 1, 192);
  options.relaxes_chart = args.has("--relax-chart");
  options.choice = choice_of(args);
  return options;
}

void print_report(const std::string& output, const bake::BakeReport& report, bool all, Console& console) {
  const auto print = [&](const char* what, const bake::Distances& d) {
    console.out << what << " to " << d.mean_mm << " mm mean, " << d.p95_mm << " at 95 %, " << d.max_mm
                << " worst";
  };
  console.out << output << ": " << report.table_bytes << " bytes, " << report.field_count << " fields; ";
  print("rest shape", report.errors.rest);
  print("; identities", report.errors.identity);
  print("; expressions", report.errors.expression);
  console.out << "; base mesh of " << report.base_vertices << " vertices\n";
  for (const bake::ParameterError& error : report.errors.parameters) {
    if (!all) break;
    print(error.name.c_str(), error.off);
    console.out << "\n";
  }
  for (const std::string& name : report.unmatched) console.out << "not a name of ARKit's: " << name << '\n';
}

int run_bake(const Args& args, Console& console) {
  bake::BakeOptions options = options_of(args);
  std::unique_ptr<Progress> progress;
  std::string stage;
  options.progress = [&](const char* now, std::size_t done, std::size_t) {
    if (stage != now) progress = std::make_unique<Progress>(console, now);
    stage = now;
    progress->show(done);
  };
  if (const auto sizes = args.text("--sizes")) {
    const int flash_kib = args.integer("--flash", 512, 1, 1 << 20);
    print_sizes(options, sizes_of(*sizes), std::size_t{1024} * static_cast<std::size_t>(flash_kib), console);
    return 0;
  }
  const std::string output = args.required("-o");
  std::vector<std::uint8_t> table;
  std::string error;
  bake::BakeReport report;
  if (!bake::bake(options, table, error, &report)) throw Failure(kBadInput, error);
  progress.reset();
  write_file(output, {reinterpret_cast<const char*>(table.data()), table.size()});
  if (const auto source = args.text("--embed"))
    write_file(*source, bake::embedded(table, array_name(*source)));
  print_report(output, report, args.has("--errors"), console);
  return 0;
}

}  // namespace

Command bake_command() {
  return {
      "bake",
      "Makes a model table from a folder of readable tables, such as fixtures/face, or of OBJ files.",
      "SOURCE -o face.plm [--embed face.cpp] [--size N] [--bits 16|8] [--unit MM] [--base-mesh N] [--pca N] "
      "[--relax-chart] "
      "[--identities N] [--expressions N|NAME,...] [--errors] | SOURCE --sizes N,... [--flash KIB]",
      {{"-o", "FILE", "the model table to write"},
       {"--embed", "FILE", "write it as a C++ array as well, for firmware"},
       {"--size", "N", "samples a side of a field over the whole chart (128)"},
       {"--bits", "N", "of a sample: 16 or 8 (16)"},
       {"--unit", "MM", "of the OBJ files' coordinates, in millimetres (1)"},
       {"--base-mesh", "N", "vertices of the base mesh, about (480)"},
       {"--pca", "N", "take all OBJ files as scans, and keep so many principal components"},
       {"--relax-chart", nullptr,
        "move the OBJ files' u,v so that no part of the surface is crushed in the chart"},
       {"--identities", "N", "keep the first so many (all)"},
       {"--expressions", "N|NAMES", "keep the so many most useful, or those named with commas between (all)"},
       {"--errors", nullptr, "list how far each parameter's shape is from the source"},
       {"--sizes", "N,N,...", "write nothing: bytes and errors at these sizes, and of a small profile"},
       {"--flash", "KIB", "that the small profile has to fit (512)"}},
      1,
      run_bake};
}

}  // namespace pliant::host
