// Bounds of the loops of Tracker::update, from its limits and options; the comments name the loop. Operations are
// estimates: multiply-adds of the innermost loops, nothing for what surrounds them.
#include "host/commands/plan.hpp"

#include <algorithm>

#include "track/template_tuning.hpp"
#include "vision/patch_tuning.hpp"

namespace pliant::host {

namespace {

constexpr double kRecordOperations = 24;  // one record of the cascade at one point, with its column
constexpr double kStepsAfterReadmission = 3, kLimitRounds = 12;

/// What the limits come to for a model.
struct Counts {
  Counts(const Model& model, const TrackerLimits& l) {
    std::size_t expressions = 0;
    for (const Parameter& p : model.parameters()) expressions += p.group == Group::expression;
    free = l.free_parameters > 0 ? std::min<std::size_t>(l.free_parameters, expressions) : expressions;
    const std::size_t all = model.cascade().count;
    records = static_cast<double>(l.samples_per_point > 0 ? std::min<std::size_t>(l.samples_per_point, all) : all);
    slots = l.patches + l.key_patches;
    unknowns = kPoseUnknowns + static_cast<double>(free);
    region_pixels = static_cast<double>(l.region_width > 0 ? std::min(l.region_width, l.width) : l.width) *
                    (l.region_height > 0 ? std::min(l.region_height, l.height) : l.height);
    frame_pixels = static_cast<double>(l.width) * l.height;
    window_pixels = static_cast<double>(l.patch_window) * l.patch_window;
    small_side = std::max(l.width, l.height) / std::max(1, (l.width + l.thumbnail_width - 1) / l.thumbnail_width);
  }
  std::size_t free;
  double records, slots, unknowns, region_pixels, frame_pixels, window_pixels;
  int small_side;
};

double shifts_within(int range) {
  return (2.0 * range + 1) * (2.0 * range + 1);
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
  const Counts c(model, limits);
  const int rounds = kTemplateMatchTuning.rounds;
  const EstimatorOptions estimator;
  plan.free_parameters = c.free;

  // A frame's first solve: Huber and Tukey; and where that leaves doubt the same once more by image forces, with a few
  // steps after readmission (FrameSolver::try_alternative). A later one: Tukey (FrameSolver::solve_robustly).
  const double first = 4.0 * estimator.iterations + kStepsAfterReadmission, later = estimator.iterations;
  // Scouts' solve before it (Estimator::approach): Huber and Tukey.
  const double approach = 2.0 * estimator.iterations;
  const double steps = approach + first + (rounds - 1) * later;
  plan.most_iterations = static_cast<int>(steps);
  // Each step is one factorisation and one pass; a refused one takes another pass back; each minimisation starts and may end
  // with one more (FrameProblem::minimise). Limits pin unknowns in at most twelve rounds.
  const double minimisations = 2.0 + 5.0 + (rounds - 1);
  const double passes = 2 * steps + 2 * minimisations + 1;
  // One search a patch and round, on each level; the last round may follow what was not found from the frame before, and back.
  const double follows = limits.keeps_previous ? 2 * c.slots : 0;
  // And what surprises after scouts is looked for once more.
  const double searches = (1.0 + rounds) * c.slots + 2 * follows;
  const double search_steps = limits.pyramid_levels * patch::kPatchTuning.max_align_steps + 2 * patch::kPatchTuning.max_refine_steps;
  const double row = c.records * kRecordOperations + c.unknowns * (c.unknowns + 1);
  const double shares = estimator.vertex_interval_frames > 0 ? estimator.vertex_interval_frames : 1;
  const double points = c.slots + limits.markers + limits.curve_points + limits.silhouette_points;

  plan.loads = {
      {"pixels of the small picture", c.frame_pixels, c.frame_pixels, 1},
      {"pixels of the pyramid, all levels", 1.33 * c.region_pixels, 1.34 * c.region_pixels, 10},
      {"shifts of the small picture compared", shifts_within(c.small_side / 16 + 1),
       shifts_within(c.small_side / 2), 600},
      {"rounds of predicting, looking, solving", 2, 1.0 + rounds, 0},
      {"points predicted", 2 * points, (1.0 + rounds) * points, c.records * kRecordOperations + 100},
      {"patch searches", 1.3 * c.slots, searches, 6 * c.window_pixels},
      {"steps of patch searches", 5 * 1.3 * c.slots, searches * search_steps, 6 * c.window_pixels},
      {"Gauss-Newton steps", 5, steps, 0},
      {"observations in passes over them", 9 * 0.8 * c.slots, passes * c.slots, row},
      {"factorisations", 8, (steps + minimisations) * kLimitRounds, c.unknowns * c.unknowns * c.unknowns / 6},
      {"tangents brought up", points / estimator.tangent_interval_frames, points / estimator.tangent_interval_frames + 1,
       3 * c.records * kRecordOperations},
      {"vertices brought up", limits.vertices / shares, limits.vertices * (1 + 1 / shares),
       c.records * kRecordOperations},
      {"vertices projected", 3.0 * limits.vertices, (rounds + 4.0) * limits.vertices, 20},
      {"patches captured for a key frame", 0.1, static_cast<double>(limits.key_patches),
       40 * c.window_pixels},
  };
  return plan;
}

}  // namespace pliant::host
