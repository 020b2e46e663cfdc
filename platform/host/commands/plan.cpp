// Bounds of the loops of Tracker::update. They come from the limits, the options and the tuning of the parts that run the
// loops. Operations are estimates: multiply-adds of the innermost loops.
#include "host/commands/plan.hpp"

#include <algorithm>

#include "estimate/frame_solver.hpp"
#include "face/aligner_table.hpp"
#include "face/search_place.hpp"
#include "optim/normal_equations_tuning.hpp"
#include "track/face_start.hpp"
#include "track/key_frames.hpp"
#include "track/template_tuning.hpp"
#include "track/tracker_sizes.hpp"
#include "vision/coarse_translation_tuning.hpp"
#include "vision/patch_tuning.hpp"
#include "vision/thumbnail.hpp"

namespace pliant::host {

namespace {

/// Multiply-adds of one execution of each innermost loop, counted in the code.
struct Operations {
  double record = 24;          ///< one record of the cascade at one point, with its column of the Jacobian
  double prediction = 100;     ///< projection and covariance of a point
  double pyramid_pixel = 10;   ///< filter of a pixel
  double search_pixel = 6;     ///< one pixel of a template in one step
  double captured_pixel = 40;  ///< one pixel of a captured template, all levels
  double projected_vertex = 20;
  double crop_pixel = 40;  ///< crop, gradient and blocks of a pixel, in a check
};
constexpr Operations kOperations{};

/// Usual counts of a tracked frame, rounded. They scale the usual work; no bound depends on them.
struct UsualCounts {
  double rounds = 2, searches_a_template = 1.3, steps_a_search = 5, solver_steps = 5, factorisations = 8;
  double passes = 9, fraction_found = 0.8, captures = 0.1, projections_a_vertex = 3;
};
constexpr UsualCounts kUsual{};

/// Sizes that follow from the limits and the model.
struct Sizes {
  Sizes(const Model& model, const TrackerLimits& l) {
    std::size_t expressions = 0;
    for (const Parameter& p : model.parameters()) expressions += p.group == Group::expression;
    free = l.free_parameters > 0 ? std::min<std::size_t>(l.free_parameters, expressions) : expressions;
    const std::size_t all = model.cascade().count;
    records =
        static_cast<double>(l.samples_per_point > 0 ? std::min<std::size_t>(l.samples_per_point, all) : all);
    slots = l.patches + l.key_patches;
    points = slots + l.markers + static_cast<double>(edge_points(l));
    unknowns = kPoseUnknowns + static_cast<double>(free);
    region_pixels = static_cast<double>(l.region_width > 0 ? std::min(l.region_width, l.width) : l.width) *
                    (l.region_height > 0 ? std::min(l.region_height, l.height) : l.height);
    frame_pixels = static_cast<double>(l.width) * l.height;
    window_pixels = static_cast<double>(l.patch_window) * l.patch_window;
    thumbnail_side = std::max(l.width, l.height) / thumbnail_factor(l.width, l.thumbnail_width);
  }
  std::size_t free;
  double records, slots, points, unknowns, region_pixels, frame_pixels, window_pixels;
  int thumbnail_side;
};

/// Work on pixels: thumbnail, pyramid, templates.
void add_pixel_loads(const Sizes& s, const TrackerLimits& limits, std::vector<Load>& loads) {
  const int rounds = kTemplateMatchTuning.rounds;
  // In the last round a template that was not found is matched against the previous frame, and back.
  const double from_previous = limits.keeps_previous ? 2 * s.slots : 0;
  // One round more after a first pass that left too many rows.
  const double searches = (1.0 + rounds) * s.slots + 2 * from_previous;
  const double search_steps =
      limits.pyramid_levels * patch::kPatchTuning.max_align_steps + 2 * patch::kPatchTuning.max_refine_steps;
  const double usual_searches = kUsual.searches_a_template * s.slots;
  const double template_operations = kOperations.search_pixel * s.window_pixels;
  const int usual_range = s.thumbnail_side / kKeyFrameTuning.range_divisor + 1;
  const int most_range = s.thumbnail_side / kKeyFrameTuning.range_divisor_of_key;
  loads.push_back({"pixels of the thumbnail", s.frame_pixels, s.frame_pixels, 1});
  loads.push_back({"pixels of the pyramid, all levels", 4.0 / 3 * s.region_pixels, 1.34 * s.region_pixels,
                   kOperations.pyramid_pixel});
  loads.push_back({"shifts of the thumbnail compared", static_cast<double>(most_shifts(usual_range)),
                   static_cast<double>(std::max(most_shifts(usual_range), most_shifts(most_range))),
                   static_cast<double>(kCoarseTranslationTuning.max_pixels)});
  loads.push_back({"template searches", usual_searches, searches, template_operations});
  loads.push_back({"steps of template searches", kUsual.steps_a_search * usual_searches,
                   searches * search_steps, template_operations});
  loads.push_back({"templates captured for a key frame", kUsual.captures,
                   static_cast<double>(limits.key_patches), kOperations.captured_pixel * s.window_pixels});
}

/// Work on points and vertices: prediction, tangents, projection.
void add_surface_loads(const Sizes& s, const TrackerLimits& limits, const EstimatorOptions& options,
                       std::vector<Load>& loads) {
  const double rounds = kTemplateMatchTuning.rounds, record = s.records * kOperations.record;
  const double interval = std::max<double>(1, options.vertex_interval_frames);
  const double tangents = s.points / options.tangent_interval_frames;
  loads.push_back({"rounds of predict, match, solve", kUsual.rounds, 1 + rounds, 0});
  loads.push_back({"points predicted", kUsual.rounds * s.points, (1 + rounds) * s.points,
                   record + kOperations.prediction});
  loads.push_back({"tangents updated", tangents, tangents + 1, 3 * record});
  // On fast motion all vertices are updated, in addition to the regular ones.
  loads.push_back(
      {"vertices updated", limits.vertices / interval, limits.vertices * (1 + 1 / interval), record});
  loads.push_back({"vertices projected", kUsual.projections_a_vertex * limits.vertices,
                   (rounds + 4) * limits.vertices, kOperations.projected_vertex});
}

void add_solver_loads(const Sizes& s, const SolveWork& work, std::vector<Load>& loads) {
  // A step makes one pass over the rows, or two if it is refused. A minimisation makes one at its start and may make one at
  // its end.
  const double passes = 2.0 * work.steps + 2.0 * work.minimisations + 1;
  const double row = s.records * kOperations.record + s.unknowns * (s.unknowns + 1);
  loads.push_back({"Gauss-Newton steps", kUsual.solver_steps, static_cast<double>(work.steps), 0});
  loads.push_back({"observations in passes over them", kUsual.passes * kUsual.fraction_found * s.slots,
                   passes * s.slots, row});
  loads.push_back({"factorisations", kUsual.factorisations,
                   static_cast<double>(work.steps + work.minimisations) * kNormalEquationsTuning.limit_rounds,
                   s.unknowns * s.unknowns * s.unknowns / 6});
}

/// What checks add to a tracked frame.
void add_check_loads(const AlignerTable& table, std::vector<Load>& loads) {
  const double side = table.stage(table.stage_count() - 1).crop_px;
  loads.push_back({"pixels of the crop of a check", side * side / kFaceStartTuning.check_interval_frames,
                   side * side, kOperations.crop_pixel});
}

SearchPlan search_plan(const AlignerTable& table, const TrackerLimits& limits) {
  SearchPlan plan;
  SearchPlace place;
  const std::uint32_t work = std::max(limits.search_work, std::uint32_t{1});
  std::uint32_t widest = 0, done = work;
  for (place.begin(limits.width, limits.height, limits.smallest_face_px); !place.is_complete();
       place.advance()) {
    const auto columns = static_cast<std::uint32_t>(place.columns());
    if (done >= work) {  // a new frame
      ++plan.search_frames;
      done = 0;
    }
    done += columns;
    plan.all_cells += columns;
    widest = std::max(widest, columns);
  }
  plan.cells = std::min(plan.all_cells, work - 1 + widest);
  plan.does_both = limits.search_work >= kFaceStartTuning.cells_for_both;
  plan.steps = std::max(1, static_cast<int>(limits.search_work / kFaceStartTuning.cells_a_step));
  plan.alignment_steps = static_cast<int>(table.stage_count()) + 1;
  for (int left = plan.alignment_steps; left > 0; ++plan.alignment_frames) {
    const int taken = std::min(plan.steps, left);
    left -= !plan.does_both && taken == left && taken > 1 ? taken - 1 : taken;
  }
  return plan;
}

}  // namespace

double Plan::usual_operations() const {
  double sum = 0;
  for (const Load& load : loads) sum += load.usual * load.operations;
  return sum;
}

double Plan::most_operations() const {
  double sum = 0;
  for (const Load& load : loads) sum += load.most * load.operations;
  return sum;
}

Plan make_plan(const Model& model, const TrackerLimits& limits) {
  Plan plan;
  {
    Arena measuring(plan.bytes);
    Tracker tracker;
    tracker.lay_out(measuring, model, limits);
    plan.arena_bytes = measuring.used_bytes();
  }
  const Sizes sizes(model, limits);
  const EstimatorOptions options;
  const SolveWork work = most_solve_work(options.iterations, kTemplateMatchTuning.rounds);
  plan.free_parameters = sizes.free;
  plan.most_iterations = work.steps;
  add_pixel_loads(sizes, limits, plan.loads);
  add_surface_loads(sizes, limits, options, plan.loads);
  add_solver_loads(sizes, work, plan.loads);
  AlignerTable table;
  if (limits.detection != nullptr && !model.detector().empty() &&
      AlignerTable::open(model.aligner(), &table) == Status::ok) {
    add_check_loads(table, plan.loads);
    plan.search = search_plan(table, limits);
  }
  return plan;
}

}  // namespace pliant::host
