// `pliant bake`: a readable source becomes a model table.
#include "bake/bake.hpp"
#include "cli/command.hpp"
#include "cli/failure.hpp"
#include "cli/files.hpp"

namespace pliant::cli {

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

int run_bake(const Args& args, Console& console) {
  const std::string output = args.required("-o");
  bake::BakeOptions options;
  options.source = args.operand(0);
  options.size = args.integer("--size", options.size, 16, 512);
  options.bits = args.integer("--bits", options.bits, 8, 16);
  if (options.bits != 8 && options.bits != 16) fail_usage("--bits must be 8 or 16");
  options.unit_mm = static_cast<float>(args.number("--unit", 1, 1e-6, 1e6));
  options.base_vertices = args.integer("--base-mesh", options.base_vertices, 60, 5000);
  options.components = args.integer("--pca", 0, 1, 192);
  Progress progress(console, "files");
  options.progress = [&progress](std::size_t done, std::size_t) { progress.show(done); };

  std::vector<std::uint8_t> table;
  std::string error;
  bake::BakeReport report;
  if (!bake::bake(options, table, error, &report)) throw Failure(kBadInput, error);
  write_file(output, {reinterpret_cast<const char*>(table.data()), table.size()});
  if (const auto source = args.text("--embed"))
    write_file(*source, bake::embedded(table, array_name(*source)));

  console.out << output << ": " << report.table_bytes << " bytes, " << report.field_count
              << " fields; rest shape to " << report.neutral_mean_mm << " mm mean, " << report.neutral_max_mm
              << " mm worst; shapes to " << report.shape_mean_mm << " mm mean, " << report.shape_max_mm
              << " mm worst" << (report.worst_shape.empty() ? "" : " (" + report.worst_shape + ")")
              << "; base mesh of " << report.base_vertices << " vertices\n";
  if (args.has("--errors"))
    for (const bake::ShapeReport& shape : report.shapes)
      console.out << shape.name << ": " << shape.mean_mm << " mm mean, " << shape.max_mm << " mm worst\n";
  for (const std::string& name : report.unmatched) console.out << "not a name of ARKit's: " << name << '\n';
  return 0;
}

}  // namespace

Command bake_command() {
  return {
      "bake",
      "Makes a model table from a folder of readable tables, such as fixtures/face, or of OBJ files.",
      "SOURCE -o face.plm [--embed face.cpp] [--size N] [--bits 16|8] [--unit MM] [--base-mesh N] [--pca N] "
      "[--errors]",
      {{"-o", "FILE", "the model table to write"},
       {"--embed", "FILE", "write it as a C++ array as well, for firmware"},
       {"--size", "N", "samples a side of a field over the whole chart (128)"},
       {"--bits", "N", "of a sample: 16 or 8 (16)"},
       {"--unit", "MM", "of the OBJ files' coordinates, in millimetres (1)"},
       {"--base-mesh", "N", "vertices of the base mesh, about (480)"},
       {"--pca", "N", "take all OBJ files as scans, and keep so many principal components"},
       {"--errors", nullptr, "list how far each parameter's shape is from the source"}},
      1,
      run_bake};
}

}  // namespace pliant::cli
