// `pliant plan`: prints a tracker's memory and the work of a frame. The bytes are those of the tracker's own sizing pass,
// counted by purpose.
#include <cstdio>
#include <memory>
#include <optional>

#include "host/bake/opened_table.hpp"
#include "host/bake/table_writer.hpp"
#include "host/commands/command.hpp"
#include "host/commands/plan.hpp"
#include "host/commands/tracker_limits.hpp"
#include "host/io/failure.hpp"
#include "host/io/files.hpp"
#include "host/io/sources.hpp"
#include "model/table_reader.hpp"

namespace pliant::host {

namespace {

constexpr const char* kPurposeNames[kPurposeCount] = {
    "other",      "model evaluation", "mesh",           "mesh adaptation",  "visibility",
    "solver",     "surface points",   "sampled points", "sampled vertices", "outlier rejection",
    "parameters", "picture pyramid",  "templates",      "corners",          "thumbnails"};

/// A model table for which only the counts matter: a rest shape and one record for each parameter.
std::vector<std::uint8_t> stand_in_table(int parameters) {
  bake::TableWriter writer;
  bake::FieldGrid grid;
  grid.width = grid.height = 3;
  grid.components = 3;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) {
      const float x = 60 * static_cast<float>(i - 1), y = -80 * static_cast<float>(j - 1);
      grid.samples.insert(grid.samples.end(), {x, y, 10.0f * static_cast<float>(i == 1)});
    }
  CascadeRecord record = bake::empty_record(Operation::constant);
  record.field = writer.add_field(grid, 16);
  std::uint16_t last = writer.add_record(record);
  for (int k = 0; k < parameters; ++k) {
    CascadeRecord next = bake::empty_record(Operation::add_vector);
    next.field = record.field;
    next.source[0] = last;
    next.parameter[0] = writer.add_parameter({"p" + std::to_string(k), Group::expression, -1, 1, 1});
    last = writer.add_record(next);
  }
  writer.set_base_mesh({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {2, 0, 1, 0, 2, 3});
  writer.set_mask({1, 1, {1}});
  return writer.bytes();
}

TrackerLimits limits_from(const Args& args) {
  const TrackerLimits of_profile = tracker_limits(args, std::nullopt);
  const ImageSize size{args.integer("--width", of_profile.width, 64, kMaxFrameSide),
                       args.integer("--height", of_profile.height, 64, kMaxFrameSide)};
  TrackerLimits l = tracker_limits(args, size);
  l.markers = static_cast<std::uint16_t>(args.integer("--markers", l.markers, 0, 4096));
  if (args.has("--parameters"))
    l.free_parameters =
        static_cast<std::uint16_t>(args.integer("--parameters", 0, 1, int{table::kMaxParameters}));
  return l;
}

void print_bytes(std::ostream& out, const Plan& plan, std::size_t table_bytes) {
  char line[128];
  out << "bytes of the arena, by purpose\n";
  for (std::size_t p = 0; p < kPurposeCount; ++p) {
    if (plan.bytes[p] == 0) continue;
    std::snprintf(line, sizeof line, "  %-22s %10zu\n", kPurposeNames[p], plan.bytes[p]);
    out << line;
  }
  std::snprintf(line, sizeof line, "  %-22s %10zu\n", "arena", plan.arena_bytes);
  out << line;
  std::snprintf(line, sizeof line, "the Tracker object       %10zu\n", sizeof(Tracker));
  out << line;
  if (table_bytes == 0) return;
  std::snprintf(line, sizeof line, "the model's table, flash %10zu\n", table_bytes);
  out << line;
}

void print_loads(std::ostream& out, const char* title, const std::vector<Load>& loads) {
  char line[160];
  if (loads.empty()) return;
  std::snprintf(line, sizeof line, "\n%-44s %10s %10s %12s\n", title, "usually", "at most", "instructions");
  out << line;
  bool any_shares = false;
  for (const Load& load : loads) {
    std::snprintf(line, sizeof line, "  %-42s %10.0f %9.0f%c %12.0f\n", load.what, load.usual, load.most,
                  load.bound == Bound::shared ? '*' : ' ', load.instructions);
    out << line;
    any_shares = any_shares || load.bound == Bound::shared;
  }
  if (any_shares) out << "  * if nothing else marked so is done\n";
}

/// One kind of frame: instructions, and on a processor of `mhz` that does one a cycle, ms.
void print_sum(std::ostream& out, const char* what, const std::vector<Load>& loads, double mhz) {
  if (loads.empty()) return;
  char line[160];
  const double usual = 1e-6 * usual_instructions(loads), most = 1e-6 * most_instructions(loads);
  std::snprintf(line, sizeof line, "  %-28s %8.1f %8.1f %10.1f %8.1f", what, usual, most,
                kCortexM7Factor * usual, kCortexM7Factor * most);
  out << line;
  if (mhz > 0) {
    std::snprintf(line, sizeof line, " %10.1f %8.1f", 1e3 * kCortexM7Factor * usual / mhz,
                  1e3 * kCortexM7Factor * most / mhz);
    out << line;
  }
  out << "\n";
}

void print_sums(std::ostream& out, const Plan& plan, double mhz) {
  char line[240];
  std::snprintf(line, sizeof line, "\n%-30s %17s %19s%s\n%-30s %8s %8s %10s %8s%s\n", "million instructions",
                "x86-64", "Cortex-M7", mhz > 0 ? "       ms, Cortex-M7" : "", "", "usually", "at most",
                "usually", "at most", mhz > 0 ? "    usually  at most" : "");
  out << line;
  print_sum(out, "a frame with a track", plan.loads, mhz);
  const auto print_with = [&](const char* what, const std::vector<Load>& more) {
    if (more.empty()) return;
    std::vector<Load> both = plan.loads;
    both.insert(both.end(), more.begin(), more.end());
    print_sum(out, what, both, mhz);
  };
  print_with("whose templates fail", plan.alignment_loads);
  print_with("the first after a start", plan.edge_loads);
  print_with("if another track begins", plan.anew_loads[0]);
  print_with("the one after that", plan.anew_loads[1]);
  print_sum(out, "a frame without", plan.search_loads, mhz);
  print_sum(out, "a frame that starts a track", plan.start_loads, mhz);
}

void print_search(std::ostream& out, const SearchPlan& plan, int print_frames) {
  char line[320];
  if (print_frames > 0) {
    std::snprintf(line, sizeof line, "\na search for the print\n  frames of a search, at most %8d\n",
                  print_frames);
    out << line;
  }
  if (plan.all_cells == 0) return;
  std::snprintf(line, sizeof line,
                "\na frame without a track: at most %u cells of the search %s %d steps of alignments\n"
                "  cells of the whole frame    %8u\n"
                "  frames of a search, at most %8d\n"
                "  steps of an alignment       %8d\n"
                "  frames of an alignment      %8d\n",
                plan.cells, plan.does_both ? "and" : "or", plan.steps, plan.all_cells, plan.search_frames,
                plan.alignment_steps, plan.alignment_frames);
  out << line;
}

int run_plan(const Args& args, Console& console) {
  TrackerLimits limits = limits_from(args);
  const double mhz = args.number("--mhz", 0, 1e-3, 1e6);
  const bool has_model = args.operand_count() > 0;
  std::unique_ptr<ModelFile> file;
  std::optional<bake::OpenedTable> stand_in;
  Model model;
  std::size_t table_bytes = 0;
  if (has_model) {
    file = std::make_unique<ModelFile>(args.operand(0));
    model = file->model();
    table_bytes = model.table_bytes();
  } else {
    stand_in.emplace(stand_in_table(args.integer("--parameters", 60, 1, int{table::kMaxParameters})));
    require(stand_in->status(), "stand-in model");
    model = stand_in->model();
  }
  if (!args.has(kVerticesOption.name)) limits = with_base_mesh(limits, model);
  if (!are_usable(model, limits))
    fail_usage("--vertices: at least the " + std::to_string(model.base_uv().count) +
               " of the model's base mesh");
  std::vector<std::uint8_t> is_free;
  for (const Parameter& p : model.parameters()) is_free.push_back(p.group == Group::expression);
  const bool chooses = !has_model || args.has("--parameters");
  const std::string lack = chooses ? "" : lack_of(model, limits, is_free);
  if (!lack.empty()) console.err << args.operand(0) << ": " << lack << "\n";
  const Plan plan = make_plan(model, limits);
  char line[200];
  std::snprintf(line, sizeof line, "%d x %d pixels, %d patches, %d vertices, %zu parameters of %zu%s\n\n",
                limits.width, limits.height, limits.patches + limits.key_patches, limits.vertices,
                plan.free_parameters, model.parameters().count,
                has_model ? "" : " (no model: one record for each parameter)");
  console.out << line;
  print_bytes(console.out, plan, table_bytes);
  print_loads(console.out, "a frame", plan.loads);
  print_loads(console.out, "besides, if its templates fail", plan.alignment_loads);
  print_loads(console.out, "besides, in the first after a start", plan.edge_loads);
  print_loads(console.out, "besides, if another track begins", plan.anew_loads[0]);
  print_loads(console.out, "besides, in the one after that", plan.anew_loads[1]);
  print_loads(console.out, "a frame without a track", plan.search_loads);
  print_loads(console.out, "a frame that starts a track", plan.start_loads);
  print_sums(console.out, plan, mhz);
  print_search(console.out, plan.search, plan.print_search_frames);
  return 0;
}

}  // namespace

Command plan_command() {
  return {
      "plan",
      "Prints a tracker's memory to the byte, and the work of a frame.",
      "[face.plm] [--profile s|m|l] [--width W] [--height H] [--vertices V] [--points N] [--parameters P] "
      "[--markers M] [--mhz F]",
      {kProfileOption,
       {"--width", "W", "of the frames, pixels"},
       {"--height", "H", "of the frames, pixels"},
       kVerticesOption,
       kPointsOption,
       {"--parameters", "P", "free parameters, at most"},
       {"--markers", "M", "surface points that are predicted, without templates"},
       {"--mhz", "F", "clock of a Cortex-M7: says ms, at one instruction a cycle"}},
      0,
      run_plan,
      1};
}

}  // namespace pliant::host
