// The tracker: a composition of its parts. `update` is the pipeline: detect or predict, match, solve, conclude.
#include "base/integers.hpp"
#include "track/second_look.hpp"
#include "track/template_tuning.hpp"
#include "track/tracker_parts.hpp"
#include "track/tracker_sizes.hpp"

namespace pliant {

namespace {

EstimatorLimits estimator_limits(const TrackerLimits& limits) {
  EstimatorLimits e =
      without_mesh_following(without_personal_field(without_stretch(without_rejection(EstimatorLimits{}))));
  e.points = static_cast<std::uint16_t>(all_points(limits));
  e.silhouette_points = limits.edges == nullptr ? std::uint16_t{0} : limits.silhouette_points;
  e.vertices = limits.vertices;
  e.free_parameters = limits.free_parameters;
  e.samples_per_point = limits.samples_per_point;
  e.samples_vertices = limits.samples_vertices;
  e.rejection_sample = limits.rejection_sample;
  e.rejection = limits.rejection;
  e.stretch = limits.stretch;
  e.mesh_following = limits.mesh_following;
  e.personal_field = limits.personal_field;
  e.personalise = limits.personalise;
  return e;
}

}  // namespace

// --- Memory ---

void TrackerParts::lay_out_tracking(Arena& arena, TrackerParts* parts, const Model& model,
                                    const TrackerLimits& limits) {
  lay_out_part(arena, static_cast<ImageParts*>(parts), model, limits);
  EstimatorLimits of_estimator = estimator_limits(limits);
  if (limits.mesh_following == nullptr)
    of_estimator.adaptation_memory = {parts == nullptr ? nullptr : parts->scratch.data,
                                      adaptation_bytes(limits.vertices)};
  of_estimator.solve_memory = {parts == nullptr ? nullptr : parts->of_solves.data,
                               solve_bytes(model, of_estimator)};
  lay_out_part(arena, parts == nullptr ? nullptr : &parts->estimator, model, of_estimator);
}

/// The same in the block, whatever has used it.
void TrackerParts::lay_out_tracking() {
  Arena arena(block.bytes.data, block.bytes.count);
  lay_out_tracking(arena, this, table, limits);
  block.is_of_search = false;
}

void Tracker::lay_out(Arena& arena, const Model& model, const TrackerLimits& limits) {
  arena.count_as(Purpose::state);
  impl_ = arena.make<Impl>();
  const auto q = arena.take_span<float>(model.parameters().count);
  lay_out_part(arena, impl_ == nullptr ? nullptr : &impl_->offsets, model);
  std::size_t search = 0;
  DetectionState* const detection =
      limits.detection == nullptr ? nullptr : limits.detection->lay_out(arena, model, limits, &search);
  NoiseFilter* const noise = limits.noise == nullptr ? nullptr : limits.noise->lay_out(arena, model, limits);
  PersonState* const person =
      limits.person == nullptr ? nullptr : limits.person->lay_out(arena, model, limits);
  unsigned char* const block = arena.take<unsigned char>(0);
  const std::size_t before = arena.used_bytes(),
                    fit = start_fit_bytes(model, limits.start_points, limits.samples_vertices);
  const std::size_t needed = larger(search, fit);
  TrackerParts::lay_out_tracking(arena, impl_, model, limits);
  const std::size_t tracking = arena.used_bytes() - before;
  arena.count_as(Purpose::solver);
  if (needed > tracking) arena.take<unsigned char>(needed - tracking);
  if (impl_ == nullptr) return;
  impl_->limits = limits;
  impl_->table = model;
  impl_->start_q = q;
  for (float& value : q) value = 0;
  impl_->offsets.clear();
  impl_->block.bytes = {block, larger(needed, tracking)};
  impl_->detection = detection;
  impl_->noise = noise;
  impl_->person = person;
  impl_->end_track();
}

void ImageParts::lay_out(Arena& arena, const Model& model, const TrackerLimits& limits) {
  lay_out_unused_between_frames(arena, model, limits);
  templates.lay_out(arena, limits);
  edges = limits.edges == nullptr ? nullptr : limits.edges->lay_out(arena, limits);
  key_frames.lay_out(arena, limits);
  texture = limits.surface_texture == nullptr ? nullptr
                                              : limits.surface_texture->lay_out(arena, limits.texture_cells);
  markers.lay_out(arena, limits.markers);
}

/// What is of one frame: the image of the region, which only frame-to-frame tracking needs in the next, searches, observations
/// and solves.
void ImageParts::lay_out_unused_between_frames(Arena& arena, const Model& model,
                                               const TrackerLimits& limits) {
  if (limits.keeps_previous) region.lay_out(arena, limits);
  unsigned char* const first = arena.take<unsigned char>(0);
  const std::size_t before = arena.used_bytes();
  if (!limits.keeps_previous) region.lay_out(arena, limits);
  matcher.lay_out(arena, limits);
  placement.lay_out(arena, limits);
  arena.count_as(Purpose::points);
  observations =
      arena.take_span<Observation>(all_slots(limits) + EdgeTracker::kAlternatives * edge_points(limits));
  prediction_index = arena.take<std::uint16_t>(all_points(limits));
  arena.count_as(Purpose::corners);
  std::size_t bytes = TemplatePlacement::scratch_bytes(limits);
  if (limits.mesh_following == nullptr) bytes = larger(bytes, adaptation_bytes(limits.vertices));
  if (limits.detection != nullptr && limits.detection->read_bytes != nullptr)
    bytes = larger(bytes, limits.detection->read_bytes(model, limits));
  if (limits.person != nullptr) bytes = larger(bytes, limits.person->scratch_bytes(model, limits));
  scratch = arena.take_span<unsigned char>(bytes);
  placement.set_scratch(scratch);
  arena.count_as(Purpose::solver);
  of_solves = arena.take_span<unsigned char>(solve_bytes(model, estimator_limits(limits)));
  if (limits.detection != nullptr) {  // a check or an alignment takes all of it
    const std::size_t all = arena.used_bytes() - before,
                      needed = limits.detection->check_bytes(model, limits);
    arena.count_as(Purpose::corners);
    if (needed > all) arena.take<unsigned char>(needed - all);
  }
  unused_between_frames = {first, arena.used_bytes() - before};
}

// --- A frame ---

Status Tracker::update(const FrameView& frame, FrameResult* result) {
  if (impl_ == nullptr || !(impl_->is_started || impl_->detection != nullptr)) return Status::not_started;
  if (result == nullptr) return Status::bad_argument;
  Impl& t = *impl_;
  Status status = t.region.check_frame(frame);
  if (status != Status::ok) return status;
  if (t.order.is_stale(frame)) return Status::stale_frame;
  const FrameView& quiet = t.quiet(frame);
  t.budget.begin(t.progress.bad_frames == 0);
  if (t.progress.rest != nullptr) t.progress.rest(t, quiet);
  status = t.is_started ? t.track(quiet) : t.detection->calls->search(t, quiet);
  if (status != Status::ok) return status;
  t.order.note(frame);
  *result = t.result;
  return status;
}

const FrameView& TrackerParts::quiet(const FrameView& view) {
  return noise == nullptr ? view : limits.noise->smoothed(*noise, view);
}

Status TrackerParts::track(const FrameView& view) {
  const Status status = predict(view);
  if (status != Status::ok) return status;
  if (progress.search_from != SearchFrom::nowhere) match_and_solve(view);
  conclude();
  if (person != nullptr && progress.bad_frames == 0) limits.person->conclude(*this);
  if (detection != nullptr) detection->calls->conclude(*this, view);
  return status;
}

void TrackerParts::limit_searches() {
  matcher.limit_steps(static_cast<std::uint32_t>(budget.left_for_searches() / budget.costs.search_step));
}

/// Leaves to the solves what the searches have not taken.
void TrackerParts::limit_solves() {
  note_work();
  estimator.limit_work(budget.costs, budget.left() + budget.costs.of_solves(budget.work));
}

void TrackerParts::note_work() {
  FrameWork& work = budget.work;
  const FrameWork of_estimator = estimator.work(), &of_matcher = matcher.work();
  work.searches = of_matcher.searches;
  work.search_steps = of_matcher.search_steps;
  work.rows = of_estimator.rows;
  work.measured_rows = of_estimator.measured_rows;
  work.factorisations = of_estimator.factorisations;
  work.forces = of_estimator.forces;
}

/// Where the model is expected, and the image there.
Status TrackerParts::predict(const FrameView& view) {
  const bool looks = detection != nullptr && detection->look != nullptr;
  SearchFrom& from = progress.search_from;
  from = looks ? limits.second_look->begin_frame(*this, view) : SearchFrom::prediction;
  ++progress.frame;
  key_frames.take(view);
  estimator.begin(view.time_ns);
  CoarseMotion motion;
  if (from == SearchFrom::prediction) motion = key_frames.find_motion(progress.bad_frames);
  budget.work.coarse_pixels = motion.compared_pixels;
  if (from == SearchFrom::alignment) limits.second_look->move_to_alignment(*this);
  if (from == SearchFrom::prediction && !motion.is_found && looks && limits.second_look->is_after_cut(*this))
    from = SearchFrom::nowhere;  // templates would match by chance
  if (motion.from != nullptr) estimator.propose(*motion.from);
  if (motion.is_found) estimator.translate(motion.by_px);
  const bool is_trusted = progress.bad_frames == 0;
  matcher.begin_frame(progress.frame, is_trusted,
                      motion.is_found && is_trusted ? length(motion.by_px) : kUnknownPx, from);
  limit_searches();
  limit_solves();
  region.advance();
  return region.build(view,
                      region.is_whole_frame() ? Vec2{} : key_frames.middle_of(estimator) + motion.by_px);
}

void TrackerParts::match_and_solve(const FrameView& view) {
  const int rounds = kTemplateMatchTuning.rounds;
  const bool has_first_pass = matcher.run_first_pass(match_frame(), estimator);
  const int first = progress.search_from == SearchFrom::alignment ? rounds - 1 : has_first_pass ? 1 : 0;
  for (int round = first; round < rounds; ++round) {
    // What parts of the surface do is read where the pose is known best.
    if (round + 1 == rounds && detection != nullptr && detection->calls->read_parts != nullptr)
      detection->calls->read_parts(*this, view);
    if (run_round(round) == 0) break;
  }
  note_work();
  if (estimator.needs_another_round() && budget.left() > 0) run_round(rounds - 1);
}

/// Predicts, matches and solves once. \return how many points were searched for.
std::size_t TrackerParts::run_round(int round) {
  const PredictionTable predictions{estimator.predict(), prediction_index};
  for (std::size_t i = 0; i < predictions.all.count; ++i)
    prediction_index[predictions.all[i].id] = static_cast<std::uint16_t>(i);
  std::size_t searched = matcher.match(match_frame(), predictions, round);
  observation_count = matcher.observation_count();
  if (round + 1 == kTemplateMatchTuning.rounds && progress.uses_edges) {
    const std::size_t n = (edges->*limits.edges->match)(
        predictions, region, estimator.view().s,
        {observations.data + observation_count, observations.count - observation_count});
    observation_count += n;
    searched += n;
  }
  limit_solves();
  if (searched > 0) estimator.solve({observations.data, observation_count});
  return searched;
}

void TrackerParts::conclude() {
  result = estimator.end();
  note_work();
  const bool is_good = result.state == TrackState::tracking;
  matcher.end_frame(match_frame(), is_good);
  constexpr int kMostBadFrames = 1000000;  // nothing counts that far
  progress.bad_frames = is_good ? 0 : smaller(progress.bad_frames + 1, kMostBadFrames);
  if (!is_good) return;
  const std::size_t of_templates = matcher.observation_count();
  if (progress.uses_edges)
    (edges->*limits.edges->end_frame)({observations.data + of_templates, observation_count - of_templates});
  key_frames.trust(estimator);
  if (texture != nullptr) (texture->*limits.surface_texture->note)(estimator, region, progress.frame);
  keep_key_frame();
}

/// Keeps this frame as a key frame, if it shows the head from a new side: second templates for points that look different
/// by now, and new points where the surface was hidden before. Waits for a frame with room.
void TrackerParts::keep_key_frame() {
  const std::size_t key = key_frames.choose(estimator.view(), result, progress.frame);
  if (key == 0) {
    budget.key_frame = {};
    return;
  }
  const std::size_t few = kTrackerTuning.tries_if_overdue,
                    tries = budget.key_frame.is_reserved ? few : kTrackerTuning.tries_a_slot;
  const auto work_of = [this](std::size_t places) { return key_frame_work(limits, budget.costs, places); };
  if (!budget.take(budget.key_frame, work_of(tries), work_of(few))) return;
  const std::size_t begin = first_slot(limits, key), end = first_slot(limits, key + 1);
  for (std::size_t slot = begin; slot < end; ++slot) templates.release(slot, estimator);
  key_frames.keep(key, estimator.view(), result.rms_px, progress.frame);
  progress.last_kept = progress.frame;
  const std::size_t free = templates.capture_second(
      limits.patches, begin, begin + (end - begin) / kTemplateStoreTuning.second_template_divisor, estimator,
      region);
  budget.work.captures = static_cast<std::uint32_t>(
      placement.place(templates, estimator, region, markers, free, end, tries * (end - free)));
}

// --- What it tells ---

const TrackerLimits& Tracker::limits() const {
  PLIANT_ASSERT(impl_ != nullptr);
  return impl_->limits;
}

const Model& Tracker::model() const {
  PLIANT_ASSERT(impl_ != nullptr);
  return impl_->model();
}

bool Tracker::is_started() const {
  return impl_ != nullptr && impl_->is_started;
}

std::uint32_t Tracker::track_number() const {
  return impl_ == nullptr ? 0 : impl_->numbers.track;
}

std::uint32_t Tracker::person_number() const {
  return impl_ == nullptr ? 0 : impl_->numbers.person;
}

const FrameWork& Tracker::work() const {
  PLIANT_ASSERT(impl_ != nullptr);
  return impl_->budget.work;
}

const FrameResult& Tracker::result() const {
  PLIANT_ASSERT(impl_ != nullptr);
  return impl_->result;
}

const Camera& Tracker::camera() const {
  PLIANT_ASSERT(impl_ != nullptr);
  static constexpr Camera kNoCamera{};
  return impl_->is_started ? impl_->estimator.camera() : kNoCamera;
}

Estimator& Tracker::estimator() {
  PLIANT_ASSERT(impl_ != nullptr);
  return impl_->estimator;
}

Span<const float> Tracker::parameters() const {
  PLIANT_ASSERT(impl_ != nullptr);
  return impl_->is_started ? impl_->estimator.parameters() : impl_->start_q;
}

Status Tracker::parameter(const char* name, float* value) const {
  if (!is_started()) return Status::not_started;
  const std::uint16_t k = name == nullptr ? kNone : model().find_parameter(name);
  if (k == kNone) return Status::not_found;
  *value = parameters()[k];
  return Status::ok;
}

Status Tracker::landmark(const char* name, Vec2* x) {
  if (!is_started()) return Status::not_started;
  const std::uint16_t k = name == nullptr ? kNone : model().find_landmark(name);
  return k == kNone ? Status::not_found : landmark(k, x);
}

Status Tracker::landmark(std::size_t index, Vec2* x) {
  if (!is_started()) return Status::not_started;
  if (index >= model().landmarks().count) return Status::not_found;
  return impl_->offsets.project(index, impl_->estimator, x) ? Status::ok : Status::underdetermined;
}

Status Tracker::place_landmarks(Span<const NamedPoint> points) {
  if (!is_started()) return Status::not_started;
  const Status status = impl_->check_landmarks(points);
  if (status != Status::ok) return status;
  for (const NamedPoint& p : points) {
    const Landmark& l = model().landmarks()[model().find_landmark(p.name)];
    impl_->offsets.place(l.uv(), p.x, impl_->estimator);
    impl_->given.landmarks = impl_->keeps_landmark_offsets = true;
  }
  return Status::ok;
}

bool Tracker::marker(std::size_t k, Vec2* x) {
  return is_started() && impl_->markers.position(k, impl_->estimator, x);
}

std::size_t Tracker::patch_count() const {
  PLIANT_ASSERT(impl_ != nullptr);
  return impl_->templates.count();
}

bool Tracker::patch(std::size_t k, Vec2* x) const {
  if (!is_started() || k >= impl_->templates.count()) return false;
  const Template& t = impl_->templates[k];
  if (!t.is_used || !t.was_found) return false;
  *x = t.found_at;
  return true;
}

std::size_t Tracker::key_frame_count() const {
  return is_started() ? impl_->key_frames.count() : 0;
}

PixelBox Tracker::region() const {
  PLIANT_ASSERT(impl_ != nullptr);
  return impl_->region.box();
}

}  // namespace pliant
