// Bounds of the loops of Tracker::update. They come from the limits, the options and the tuning of the parts that run the
// loops. What a turn of each loop costs is measured.
#include "host/commands/plan.hpp"

#include <algorithm>

#include "estimate/frame_solver.hpp"
#include "estimate/visible_surface.hpp"
#include "face/aligner_table.hpp"
#include "face/part_fit.hpp"
#include "model/parameters.hpp"
#include "optim/normal_equations_tuning.hpp"
#include "print/print_motion.hpp"
#include "print/print_table.hpp"
#include "print/print_tuning.hpp"
#include "track/face_checks.hpp"
#include "track/frame_budget.hpp"
#include "track/key_frames.hpp"
#include "track/noise_smoothing.hpp"
#include "track/person_refinement.hpp"
#include "track/second_look.hpp"
#include "track/template_tuning.hpp"
#include "track/tracker_sizes.hpp"
#include "vision/coarse_translation_tuning.hpp"
#include "vision/noise_tuning.hpp"
#include "vision/thumbnail.hpp"

namespace pliant::host {

namespace {

/// Instructions of x86-64 of one turn of each loop, counted by callgrind on the recorded face with the default limits, with 500
/// templates and with profile S (docs/evaluation.md, Work of a frame). `WorkCosts` has those of searches and solves.
struct Instructions {
  double noise_place = 30, smoothed_pixel = 3.5;
  double thumbnail_pixel = 0.9, pyramid_pixel = 1.9;
  double predicted_record = 21;                ///< of a predicted point
  double tangent_record = 215;                 ///< of a point, where the person has changed
  double vertex_record = 50;                   ///< of a vertex with samples, at a start
  double moved_record = 15, near_record = 76;  ///< of one that moves: with samples, or from the tables
  double table_record = 193;                   ///< of a vertex from the tables, to the last digit
  double sampled_record = 235;                 ///< of a vertex that is sampled again
  double projected_vertex = 60, drawn_vertex = 425;
  double drawing = 90000;  ///< of a depth buffer, besides
  double edge_point = 3800;
  double parts = 1.4e6;         ///< the readers of a face
  double cell = 1540;           ///< of the search
  double cell_area = 43;        ///< of a cell at full size that a cell of the search is reduced from
  double strip_column = 23000;  ///< of the frame: rows above the one where the search goes on
  double turned_pixel = 50;
  double alignment_step = 1.8e6, alignment_end = 1.1e6;
  double face_motion =
      1e6;  ///< since the frame before, where an alignment is spread over frames; 0.95 were counted
  double personal_sample = 9.5;  ///< of one field at one sample of the person's
  double adapted_vertex = 60000;
  double captured_record = 400;  ///< of a template of frame 0
  double curve_point = 60000;    ///< a new one
  /// Of prints, counted on sheets with 4, 6 and 12 shapes: a block compared, and its place from the tables; the same again where
  /// the surface may be curved, reckoned from these (five places instead of three, half of the samples); a place that turns away,
  /// reckoned, too; a cell of the search; a fit.
  double print_block = 42000, print_block_record = 1200, print_curved_block = 26000,
         print_curved_record = 2000;
  double print_place = 1500;  ///< besides print_block_record
  double print_cell = 7500, print_fit = 4.5e6, print_fit_record = 5.6e5;
  double print_patch = 16000;  ///< of a small picture, found in another
};
constexpr Instructions kCost{};

/// Usual counts of a tracked frame, measured likewise. They scale the usual work; no bound depends on them.
struct UsualCounts {
  double rounds = 2, steps_a_template = 4.5, passes = 1.5, factorisations = 7.3;
  double projections_a_vertex = 1.3, drawings = 0.5, fraction_found = 0.7;
  double print_fits = 16;  ///< of a search that takes one frame
};
constexpr UsualCounts kUsual{};

/// Sizes that follow from the limits and the model.
struct Sizes {
  Sizes(const Model& model, const TrackerLimits& l) {
    const std::size_t expressions = count_of(Group::expression, model);
    identities = static_cast<double>(model.parameters().count - expressions);
    free = l.free_parameters > 0 ? std::min<std::size_t>(l.free_parameters, expressions) : expressions;
    all_records = static_cast<double>(model.cascade().count);
    // The identity is personalised, that is sampled into one field, where there is room for it.
    const bool has_person = l.personal_field.width > 0;
    const double sampled = has_person ? static_cast<double>(expressions) + 2 : all_records;
    records = l.samples_per_point > 0 ? std::min<double>(l.samples_per_point, sampled) : sampled;
    slots = static_cast<double>(all_slots(l));
    edges = static_cast<double>(edge_points(l));
    springs = spring_rows(model, l);
    observations = static_cast<double>(all_observations(l) + springs);
    points = static_cast<double>(all_points(l));
    has_rejection = l.rejection != nullptr;
    unknowns = kPoseUnknowns + static_cast<double>(free);
    region_pixels = static_cast<double>(region_width(l)) * region_height(l);
    frame_pixels = static_cast<double>(l.width) * l.height;
    thumbnail_side = std::max(l.width, l.height) / thumbnail_factor(l.width, l.thumbnail_width);
    costs = WorkCosts::of(static_cast<float>(l.patch_window), static_cast<float>(unknowns),
                          static_cast<float>(records));
    budget = static_cast<double>(most_frame_work(l, costs, springs));
    person_step = static_cast<double>(person_step_work(model, l));
  }
  std::size_t free, springs;  // springs as observations of a pass
  bool has_rejection;
  double identities, all_records, records, slots, edges, observations, points, unknowns, region_pixels,
      frame_pixels;
  int thumbnail_side;
  WorkCosts costs;
  double budget, person_step;  // of a frame, and of a change of the person; instructions
};

using Loads = std::vector<Load>;

/// Adds work whose bound is the budget of a frame, together with all else that shares it.
void add_shared(const Sizes& s, const char* what, double usual, double most, double cost, Loads& loads) {
  most = std::min(most, s.budget / cost);
  loads.push_back({what, std::min(usual, most), most, cost, Bound::shared});
}

/// Thumbnail, pyramid and coarse search.
void add_picture_loads(const Sizes& s, Loads& loads) {
  const int usual_range = s.thumbnail_side / kKeyFrameTuning.range_divisor + 1;
  const int most_range = s.thumbnail_side / kKeyFrameTuning.range_divisor_of_key;
  loads.push_back({"pixels of the thumbnail", s.frame_pixels, s.frame_pixels, kCost.thumbnail_pixel});
  loads.push_back({"pixels of the pyramid, all levels", 4.0 / 3 * s.region_pixels, 1.34 * s.region_pixels,
                   kCost.pyramid_pixel});
  // First in a frame, so that the budget does not end it.
  const double pixels = kCoarseTranslationTuning.max_pixels;
  loads.push_back({"pixels of thumbnails compared", pixels * most_shifts(usual_range),
                   pixels * std::max(most_shifts(most_range), most_shifts(usual_range) + kMostExpectedShifts),
                   static_cast<double>(s.costs.coarse_pixel), Bound::shared});
}

/// Every frame, where frames are smoothed.
void add_noise_loads(const Sizes& s, Loads& loads) {
  const double places = kNoiseTuning.most_places;
  loads.push_back({"places where noise is measured", places, places, kCost.noise_place});
  loads.push_back({"pixels smoothed", 0, s.frame_pixels, kCost.smoothed_pixel});
}

/// Searches and solves, which end when the budget is spent.
void add_limited_loads(const Sizes& s, const TrackerLimits& limits, const EstimatorOptions& options,
                       Loads& loads) {
  const auto limited = [&](const char* what, double usual, double cost) {
    add_shared(s, what, usual, s.budget / cost, cost, loads);
  };
  const double step = static_cast<double>(s.costs.search_step), row = static_cast<double>(s.costs.row),
               measured = static_cast<double>(s.costs.measured_row),
               factorisation = static_cast<double>(s.costs.factorisation);
  limited("steps of template searches", kUsual.steps_a_template * s.slots, step);
  limited("observations in passes over them", kUsual.passes * s.observations, row);
  limited("observations measured for a step", kUsual.passes * s.observations, measured);
  limited("factorisations", kUsual.factorisations, factorisation);
  if (s.has_rejection) limited("image forces compared", 0, static_cast<double>(s.costs.force));
  // Every solve makes a pass, and its last minimisation may meet more limits of parameters than expected.
  const double more =
      kNormalEquationsTuning.limit_rounds - static_cast<double>(kFrameSolverTuning.factorisations_a_step);
  loads.push_back({"observations in the last pass of a solve", 0,
                   static_cast<double>(last_passes_work(limits, s.costs, s.springs)) / row, row,
                   Bound::beside});
  loads.push_back(
      {"factorisations at limits of parameters", 0, more * options.iterations, factorisation, Bound::beside});
}

/// Of a vertex that is moved with the parameters, to a millimetre.
double moved_vertex(const TrackerLimits& limits, const Sizes& s) {
  return (limits.samples_vertices ? kCost.moved_record : kCost.near_record) * s.records;
}

/// Points and vertices: prediction, tangents, projection.
void add_surface_loads(const Sizes& s, const TrackerLimits& limits, const EstimatorOptions& options,
                       Loads& loads) {
  const double rounds = kTemplateMatchTuning.rounds, vertices = limits.vertices;
  const double interval = std::max<double>(1, options.vertex_interval_frames);
  const double tangents = s.points / options.tangent_interval_frames;
  const double first_pass = static_cast<double>(kTemplateMatchTuning.first_pass_points);
  loads.push_back({"points predicted", kUsual.rounds * s.points, rounds * s.points + first_pass,
                   kCost.predicted_record * s.records});
  loads.push_back({"tangents updated", tangents, tangents + 1, kCost.tangent_record * s.all_records});
  // On fast motion all vertices are updated.
  loads.push_back({"vertices updated", vertices / interval, vertices, moved_vertex(limits, s)});
  loads.push_back({"vertices projected", kUsual.projections_a_vertex * vertices, (rounds + 3) * vertices,
                   kCost.projected_vertex});
  loads.push_back({"vertices drawn into the depth buffer", kUsual.drawings * vertices,
                   (rounds + 2) * vertices, kCost.drawn_vertex});
  loads.push_back({"depth buffers drawn", kUsual.drawings, rounds + 2, kCost.drawing});
  if (s.edges > 0) loads.push_back({"edge points matched", s.edges, 2 * s.edges, kCost.edge_point});
}

void add_key_frame_loads(const Sizes& s, const TrackerLimits& limits, Loads& loads) {
  const double slots = static_cast<double>(first_slot(limits, 2) - first_slot(limits, 1));
  add_shared(s, "pixels searched for corners of a key frame", 0, s.region_pixels,
             static_cast<double>(kTrackerTuning.corner_pixel), loads);
  add_shared(s, "vertices projected under these corners", 0, static_cast<double>(limits.vertices),
             static_cast<double>(kTrackerTuning.corner_vertex), loads);
  add_shared(s, "places tried for a key frame's templates", 0,
             static_cast<double>(kTrackerTuning.tries_a_slot) * slots, static_cast<double>(s.costs.capture),
             loads);
}

/// The estimation of the person.
void add_person_loads(const Model& model, const TrackerLimits& limits, const Sizes& s, Loads& loads) {
  const PersonRefinementTuning& t = kPersonRefinementTuning;
  const double most = std::min(s.observations, static_cast<double>(t.most_observations) - 1);
  const auto add = [&](const char* what, double usual, double count, float work) {
    add_shared(s, what, usual, count, static_cast<double>(work) * s.all_records, loads);
  };
  add("observations in the estimate of the person", kUsual.fraction_found * most / t.interval_frames, most,
      t.observation_work);
  const double landmarks = static_cast<double>(model.landmarks().count);
  add("landmarks in the estimate of the person", 0, landmarks, t.observation_work);
  add("templates prepared for a change of the person", 0,
      std::min(s.slots, static_cast<double>(t.prepared_templates)), t.prepared_work);
  add("points moved with the person", 0, s.points, t.point_work);
  add("landmarks moved with the person", 0, landmarks, t.landmark_work);
  if (limits.samples_vertices)
    loads.push_back({"vertices sampled again", 0, static_cast<double>(renewed_vertices(limits.vertices)),
                     kCost.sampled_record * s.all_records});
}

/// Of the vertices that a frame samples again after a change of the person, at most; instructions.
double renewal_work(const TrackerLimits& limits, const Sizes& s) {
  if (!limits.samples_vertices) return 0;
  return static_cast<double>(renewed_vertices(limits.vertices)) * kCost.sampled_record * s.all_records;
}

/// Work that has waited is done even if its frame could not reserve as much. A change of the person waits until all vertices are
/// sampled again after the change before, so that it takes the place of that work.
void add_overdue_load(const TrackerLimits& limits, const Sizes& s, Loads& loads) {
  const double reserved = static_cast<double>(kFrameBudgetTuning.most_reserved) * s.budget;
  double more =
      static_cast<double>(key_frame_work(limits, s.costs, kTrackerTuning.tries_if_overdue)) - reserved;
  if (limits.detection != nullptr)
    more = std::max(more, static_cast<double>(kFaceChecksTuning.check_work) - reserved);
  if (limits.second_look != nullptr)
    more = std::max(more, static_cast<double>(kSecondLookTuning.step_work) - reserved);
  if (limits.person != nullptr) more = std::max(more, s.person_step - reserved - renewal_work(limits, s));
  if (more > 0) loads.push_back({"overdue work beyond what is reserved", 0, more, 1, Bound::beside});
}

/// What readers of parts, checks and second looks add to a tracked frame.
void add_face_loads(const Model& model, const AlignerTable& aligner, const TrackerLimits& limits,
                    const Sizes& s, Loads& loads) {
  if (!model.parts().empty()) loads.push_back({"readings of the parts of a face", 1, 1, kCost.parts});
  add_shared(s, "checks of the track", 1.0 / kFaceChecksTuning.known_interval_frames, 1,
             static_cast<double>(kFaceChecksTuning.check_work), loads);
  if (limits.second_look == nullptr) return;
  const double steps = static_cast<double>(aligner.stage_count()) + 1;
  add_shared(s, "steps of second alignments", steps / kSecondLookTuning.longest_wait, 1,
             static_cast<double>(kSecondLookTuning.step_work), loads);
}

/// A frame whose templates fail is aligned, by the stages of the table that refine; where the limits name second looks, the mean
/// face is aligned, too, if the result is doubtful, and thumbnails tell whether the picture is another one.
void add_alignment_loads(const AlignerTable& aligner, const TrackerLimits& limits, const Sizes& s,
                         Loads& loads) {
  double steps = 0;
  for (std::size_t k = 0; k < aligner.stage_count(); ++k) steps += aligner.stage(k).refines != 0;
  const bool looks = limits.second_look != nullptr;
  const double of_mean_face = looks ? static_cast<double>(aligner.stage_count()) : 0;
  loads.push_back({"steps of alignments", steps, steps + of_mean_face, kCost.alignment_step});
  loads.push_back({"ends of alignments", 1, looks ? 2.0 : 1.0, kCost.alignment_end});
  // On fast motion they are moved twice.
  loads.push_back(
      {"vertices at its result", 1.0 * limits.vertices, 2.0 * limits.vertices, moved_vertex(limits, s)});
  if (!looks) return;
  const int twice = 2 * most_shifts(0) *
                    kCoarseTranslationTuning.max_pixels;  // with the last frame, with the last good one
  loads.push_back({"pixels of whole thumbnails compared", 0, static_cast<double>(twice),
                   static_cast<double>(s.costs.coarse_pixel)});
}

/// What a search of several frames adds to each of them.
void add_scene_loads(const Sizes& s, const TrackerLimits& limits, Loads& loads) {
  const auto patches = static_cast<double>(SceneMotion::patches(limits.width, limits.height));
  loads.push_back({"pixels of its thumbnail", s.frame_pixels, s.frame_pixels, kCost.thumbnail_pixel});
  loads.push_back({"patches of the scene followed", patches, patches, kCost.print_patch});
}

/// A frame in which what was found in an earlier one is found, beside fits.
void add_carry_loads(const Sizes& s, Loads& loads) {
  const double places = SceneMotion::kPictures * static_cast<double>(kPrintTuning.blocks);
  loads.push_back(
      {"pixels of its pyramid", 4.0 / 3 * s.frame_pixels, 4.0 / 3 * s.frame_pixels, kCost.pyramid_pixel});
  loads.push_back({"places found in small pictures", places, places, kCost.print_patch});
}

/// What checks of a print add to a tracked frame, and the frames that search for it and start with it.
void add_print_loads(const Sizes& s, const TrackerLimits& limits, const PrintSearchPlan& search, Plan& plan) {
  const double blocks = static_cast<double>(kPrintTuning.blocks),
               interval = kPrintTuning.check_interval_frames;
  const double tries =
      static_cast<double>(kTrackerTuning.tries_a_slot * (first_slot(limits, 2) - first_slot(limits, 1)));
  const double check = kCost.print_block + kCost.print_block_record * s.all_records;
  plan.loads.push_back({"blocks of the print compared", blocks / interval, blocks, check});
  const double curved = kCost.print_curved_block + kCost.print_curved_record * s.all_records;
  plan.loads.push_back({"blocks of the print compared again", 0, blocks, curved});
  // Of a closed surface further places are tried: none of a flat one.
  const double further = static_cast<double>(kPrintTuning.block_rounds - 1);
  const double place = kCost.print_place + kCost.print_block_record * s.all_records;
  const char* const kTurned = "places of the print that turn away";
  plan.loads.push_back({kTurned, 0, further * blocks, place});
  plan.loads.push_back({"blocks where a key frame wants templates", 0, tries, kCost.print_block});
  const double cells = static_cast<double>(search.cells), fits = static_cast<double>(search.fits);
  const double fit = kCost.print_fit + kCost.print_fit_record * s.all_records;
  const double carrying_fits = 1 + SceneMotion::kPictures + kPrintTuning.block_passes;
  const bool is_spread = search.frames > 1;
  const double usual_cells = std::min<double>(limits.search_work, cells);
  plan.search_loads.push_back({"cells of the search", usual_cells, cells, kCost.print_cell});
  plan.start_loads.push_back({"cells of the search", is_spread ? 0 : usual_cells, cells, kCost.print_cell});
  plan.search_loads.push_back({"fits of the print", 0, fits, fit});
  plan.start_loads.push_back({"fits of the print", is_spread ? carrying_fits : kUsual.print_fits,
                              is_spread ? std::max(carrying_fits, fits) : fits, fit});
  if (is_spread) {
    add_scene_loads(s, limits, plan.search_loads);
    add_scene_loads(s, limits, plan.start_loads);
    add_carry_loads(s, plan.start_loads);
  }
  // Places that are tried in vain: of fits, of each verification, and of the start.
  const auto turned = [&](double comparisons) {
    return further * (fits * static_cast<double>(kPrintTuning.fitted_points) + comparisons * blocks);
  };
  plan.search_loads.push_back({kTurned, 0, turned(fits), place});
  plan.start_loads.push_back({kTurned, 0, turned(fits + 1), place});
  plan.start_loads.push_back({"blocks of the print compared", blocks, blocks, check});
  plan.start_loads.push_back({"blocks of the print compared again", 0, blocks, curved});
  plan.start_loads.push_back(
      {"blocks where templates are wanted", 2.0 * limits.patches, 3.0 * limits.patches, kCost.print_block});
}

/// A frame that searches for a face, and aligns what it has found; or does one of the two, whatever takes more.
void add_search_loads(const SearchPlan& plan, double width, Loads& loads) {
  const double steps = plan.steps;
  Loads search, alignment;
  search.push_back({"cells of the search", plan.cells * 1.0, plan.cells * 1.0, kCost.cell});
  search.push_back({"the same at the size of the frame", plan.cell_area, plan.cell_area, kCost.cell_area});
  search.push_back({"columns of pixels, where it goes on", width, width, kCost.strip_column});
  if (plan.near_cells > 0) {
    const double usual = plan.does_both ? 0 : 1;
    const auto cells = static_cast<double>(plan.near_cells);
    alignment.push_back({"cells near its candidates", usual * cells, cells, kCost.cell});
    alignment.push_back(
        {"the same at the size of the frame", usual * plan.near_area, plan.near_area, kCost.cell_area});
  }
  alignment.push_back({"steps of alignments", steps, steps, kCost.alignment_step});
  if (plan.does_both || most_instructions(search) >= most_instructions(alignment))
    loads.insert(loads.end(), search.begin(), search.end());
  if (plan.does_both || most_instructions(search) < most_instructions(alignment))
    loads.insert(loads.end(), alignment.begin(), alignment.end());
  if (plan.turned_pixels > 0)
    loads.push_back(
        {"pixels of the turned frame", 0, static_cast<double>(plan.turned_pixels), kCost.turned_pixel});
}

constexpr const char* kPointsOfCurves = "points of curves";

void add_templates(const Sizes& s, double templates, Loads& loads) {
  loads.push_back({"pixels searched for corners", s.region_pixels, s.region_pixels,
                   static_cast<double>(kTrackerTuning.corner_pixel)});
  loads.push_back(
      {"templates captured", 2 * templates, 3 * templates, kCost.captured_record * s.all_records});
}

void add_personal_field(const Sizes& s, const TrackerLimits& limits, Loads& loads) {
  const double samples = static_cast<double>(limits.personal_field.width) * limits.personal_field.height;
  if (samples > 0)
    loads.push_back(
        {"samples of the person's field", samples, samples, kCost.personal_sample * s.identities});
}

/// A start that is spread over frames (docs/algorithms.md, section 9.2). Its vertices are those of a frame.
void add_anew_loads(const Model& model, const Sizes& s, const TrackerLimits& limits, Loads (&loads)[2]) {
  const int first = first_templates(limits);
  add_personal_field(s, limits, loads[0]);
  add_templates(s, first, loads[0]);
  if (renewal_work(limits, s) > 0)
    loads[0].push_back({"vertices sampled again", static_cast<double>(renewed_vertices(limits.vertices)),
                        static_cast<double>(renewed_vertices(limits.vertices)),
                        kCost.sampled_record * s.all_records});
  add_templates(s, limits.patches - first, loads[1]);
  const double readings = kPartFitTuning.start_centrings + 1;
  if (!model.parts().empty())
    loads[1].push_back({"readings of the parts of a face", readings, readings, kCost.parts});
}

/// The start of a track, besides.
void add_start_loads(const Sizes& s, const TrackerLimits& limits, bool adapts, Loads& loads) {
  const double from_tables =
      s.all_records * (limits.samples_vertices ? kCost.vertex_record : kCost.table_record);
  add_personal_field(s, limits, loads);
  loads.push_back({"vertices of the mesh", 0.7 * limits.vertices, static_cast<double>(limits.vertices),
                   adapts ? kCost.adapted_vertex : 2 * from_tables});
  add_templates(s, limits.patches, loads);
  // With a few templates a start needs its edges at once.
  loads.push_back({kPointsOfCurves, limits.keeps_previous ? 0 : s.edges, s.edges, kCost.curve_point});
}

/// What the detection of faces adds: checks and looks while there is a track, searches and starts while there is none.
void add_detection_loads(const Model& model, const AlignerTable& table, const TrackerLimits& limits,
                         const Sizes& sizes, Plan& plan) {
  add_face_loads(model, table, limits, sizes, plan.loads);
  add_alignment_loads(table, limits, sizes, plan.alignment_loads);
  if (limits.second_look != nullptr && limits.keeps_previous)
    add_anew_loads(model, sizes, limits, plan.anew_loads);
  plan.search = search_plan(table, limits);
  add_search_loads(plan.search, limits.width, plan.search_loads);
  plan.start_loads =
      plan.search.does_both ? plan.search_loads : Loads{{"steps of alignments", 1, 1, kCost.alignment_step}};
  if (!plan.search.does_both)
    plan.start_loads.push_back({"motions of the face since the frame before", 1, 1, kCost.face_motion});
  plan.start_loads.push_back({"ends of alignments", 1, 1, kCost.alignment_end});
  const double readings = kPartFitTuning.start_centrings + 1;
  if (!model.parts().empty())
    plan.start_loads.push_back({"readings of the parts of a face", readings, readings, kCost.parts});
}

}  // namespace

double usual_instructions(const std::vector<Load>& loads) {
  double sum = 0;
  for (const Load& load : loads) sum += load.usual * load.instructions;
  return sum;
}

double most_counted_instructions(const std::vector<Load>& loads) {
  double shared = 0, beside = 0;
  for (const Load& load : loads) {
    const double most = load.most * load.instructions;
    if (load.bound == Bound::shared) shared = std::max(shared, most);
    if (load.bound == Bound::beside) beside += most;
  }
  return shared + beside;
}

double most_instructions(const std::vector<Load>& loads) {
  double sum = most_counted_instructions(loads);
  for (const Load& load : loads)
    if (load.bound == Bound::always) sum += load.most * load.instructions;
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
  plan.free_parameters = sizes.free;
  plan.most_iterations = most_solve_steps(options.iterations, kTemplateMatchTuning.rounds);
  add_picture_loads(sizes, plan.loads);
  add_limited_loads(sizes, limits, options, plan.loads);
  add_surface_loads(sizes, limits, options, plan.loads);
  add_key_frame_loads(sizes, limits, plan.loads);
  if (limits.person != nullptr && sizes.identities > 0) add_person_loads(model, limits, sizes, plan.loads);
  add_overdue_load(limits, sizes, plan.loads);
  AlignerTable table;
  if (limits.detection != nullptr && !model.detector().empty() &&
      AlignerTable::open(model.aligner(), &table) == Status::ok)
    add_detection_loads(model, table, limits, sizes, plan);
  if (limits.detection != nullptr && !model.print().empty() && plan.search.all_cells == 0) {
    PrintTable print;
    const bool is_open = PrintTable::open(model.print(), &print) == Status::ok;
    const PrintSearchPlan search = print_search_plan(limits, print.keypoints().count, model.cascade().count);
    add_print_loads(sizes, limits, search, plan);
    if (is_open) plan.print_search_frames = search.frames;
  }
  add_start_loads(sizes, limits, plan.search.does_both || plan.search.all_cells == 0, plan.start_loads);
  if (limits.keeps_previous && sizes.edges > 0)
    plan.edge_loads.push_back({kPointsOfCurves, sizes.edges, sizes.edges, kCost.curve_point});
  if (limits.noise != nullptr && is_smoothed(model))
    for (Loads* loads : {&plan.loads, &plan.search_loads, &plan.start_loads})
      if (!loads->empty()) add_noise_loads(sizes, *loads);
  return plan;
}

}  // namespace pliant::host
