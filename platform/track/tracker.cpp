// The tracker: a composition of its parts. `update` is the pipeline: predict, match, solve, conclude.
#include "pliant/tracker.hpp"

#include "track/edge_tracker.hpp"
#include "track/frame_region.hpp"
#include "track/key_frames.hpp"
#include "track/landmark_fit.hpp"
#include "track/landmark_offsets.hpp"
#include "track/markers.hpp"
#include "track/start_fit.hpp"
#include "track/surface_texture.hpp"
#include "track/template_matcher.hpp"
#include "track/template_placement.hpp"
#include "track/template_store.hpp"
#include "track/template_tuning.hpp"
#include "track/tracker_sizes.hpp"

namespace pliant {

namespace {

EstimatorLimits estimator_limits(const TrackerLimits& limits) {
  EstimatorLimits e = without_rejection(EstimatorLimits{});
  e.points = static_cast<std::uint16_t>(all_points(limits));
  e.silhouette_points = limits.silhouette_points;
  e.vertices = limits.vertices;
  e.free_parameters = limits.free_parameters;
  e.samples_per_point = limits.samples_per_point;
  e.samples_vertices = limits.samples_vertices;
  e.rejection_sample = limits.rejection_sample;
  e.rejection = limits.rejection;
  e.personal_field = limits.personal_field;
  return e;
}

/// The parts that work on images.
struct ImageParts {
  FrameRegion region;
  TemplateStore templates;
  TemplateMatcher matcher;
  TemplatePlacement placement;
  EdgeTracker edges;
  KeyFrames key_frames;
  SurfaceTexture texture;
  Markers markers;
  Span<Observation> observations;
  std::uint16_t* prediction_index = nullptr;  // by id of a surface point

  void lay_out(Arena& arena, const TrackerLimits& limits);
};

void ImageParts::lay_out(Arena& arena, const TrackerLimits& limits) {
  region.lay_out(arena, limits);
  templates.lay_out(arena, limits);
  matcher.lay_out(arena, limits);
  placement.lay_out(arena, limits);
  edges.lay_out(arena, limits);
  key_frames.lay_out(arena, limits);
  texture.lay_out(arena, limits.texture_cells);
  markers.lay_out(arena, limits.markers);
  arena.count_as(Purpose::points);
  observations =
      arena.take_span<Observation>(all_slots(limits) + EdgeTracker::kAlternatives * edge_points(limits));
  prediction_index = arena.take<std::uint16_t>(all_points(limits));
}

}  // namespace

/// The estimator and the parts that work on images share their memory with the fit of a start, which runs before them.
struct Tracker::Impl : ImageParts {
  // Set by lay_out. The default limits would link the rejection into every program.
  TrackerLimits limits = without_rejection(TrackerLimits{});
  bool uses_edges = false;
  Span<float> start_q;
  LandmarkOffsets offsets;
  Span<unsigned char> block;  // of fit and tracking

  Estimator estimator;
  std::size_t observation_count = 0;
  FrameResult result;
  std::uint32_t frame = 0, last_sequence = 0;
  std::int64_t last_time_ns = 0;
  int bad_frames = 0;  // in a row
  bool is_started = false;

  const Model& model() const { return estimator.model(); }
  MatchFrame match_frame() { return {templates, region, observations}; }

  /// The tracking's parts, whose memory a start's fit may have used. Null: measures.
  static void lay_out_tracking(Arena& arena, Impl* impl, const Model& model, const TrackerLimits& limits);

  Status check_start(const FrameView& frame, Span<const Vec2> markers) const;
  Status check_landmarks(Span<const NamedPoint> points) const;
  bool fits_model(const SavedState& state) const;
  template <class Fit>
  Status fit_before_tracking(Fit&& fit);
  Status start(const FrameView& frame, const StartPose& from, const float* q, const TrackerOptions& with,
               Span<const Vec2> marker_places);
  Status capture_frame_0(const FrameView& view, Span<const Vec2> marker_places, float marker_exclusion_px);

  bool is_stale(const FrameView& view) const;
  Status predict(const FrameView& view);
  void match_and_solve();
  std::size_t run_round(int round);
  void conclude();
  void keep_key_frame();
};

// --- Memory ---

void Tracker::Impl::lay_out_tracking(Arena& arena, Impl* impl, const Model& model,
                                     const TrackerLimits& limits) {
  lay_out_part(arena, impl == nullptr ? nullptr : &impl->estimator, model, estimator_limits(limits));
  lay_out_part(arena, static_cast<ImageParts*>(impl), limits);
}

void Tracker::lay_out(Arena& arena, const Model& model, const TrackerLimits& limits) {
  TrackerLimits own = limits;
  if (own.key_frames > TrackerLimits::kMostKeyFrames) own.key_frames = TrackerLimits::kMostKeyFrames;
  arena.count_as(Purpose::state);
  impl_ = arena.make<Impl>();
  const auto q = arena.take_span<float>(model.parameters().count);
  lay_out_part(arena, impl_ == nullptr ? nullptr : &impl_->offsets, model);
  unsigned char* const block = arena.take<unsigned char>(0);
  const std::size_t before = arena.used_bytes(), fit = start_fit_bytes(model, own.start_points);
  Impl::lay_out_tracking(arena, impl_, model, own);
  const std::size_t tracking = arena.used_bytes() - before;
  arena.count_as(Purpose::solver);
  if (fit > tracking) arena.take<unsigned char>(fit - tracking);
  if (impl_ == nullptr) return;
  impl_->limits = own;
  impl_->start_q = q;
  impl_->block = {block, fit > tracking ? fit : tracking};
}

// --- Starts ---

Status Tracker::Impl::check_start(const FrameView& view, Span<const Vec2> marker_places) const {
  const Status status = region.check_frame(view);
  if (status != Status::ok) return status;
  return marker_places.count <= limits.markers ? Status::ok : Status::capacity;
}

Status Tracker::Impl::check_landmarks(Span<const NamedPoint> points) const {
  if (points.count > 0 && points.data == nullptr) return Status::bad_argument;
  for (const NamedPoint& p : points) {
    if (p.name == nullptr || model().find_landmark(p.name) == kNone) return Status::not_found;
    if (!is_finite(p.x)) return Status::bad_argument;
  }
  return Status::ok;
}

bool Tracker::Impl::fits_model(const SavedState& state) const {
  const std::size_t count = state.landmark_offsets.count;
  if (state.parameters.data == nullptr || state.parameters.count != start_q.count) return false;
  return count == 0 || (count == offsets.values().count && state.landmark_offsets.data != nullptr);
}

/// Runs `fit(arena, model)` in the memory of the tracking, which is laid out anew afterwards.
template <class Fit>
Status Tracker::Impl::fit_before_tracking(Fit&& fit) {
  is_started = false;
  const Model of_table = model();  // the estimator's own lies in memory that is about to change
  Arena before(block.data, block.count);
  const Status status = fit(before, of_table);
  Arena after(block.data, block.count);
  lay_out_tracking(after, this, of_table, limits);
  return status;
}

/// Frame 0, of checked arguments.
Status Tracker::Impl::start(const FrameView& view, const StartPose& from, const float* q,
                            const TrackerOptions& with, Span<const Vec2> marker_places) {
  is_started = false;
  TrackerOptions options = with;
  texture.start(&options.estimator);
  Status status =
      estimator.start(from.camera, view.width, view.height, from.pose, q, options.is_free, options.estimator);
  if (status == Status::ok) status = capture_frame_0(view, marker_places, options.marker_exclusion_px);
  if (status != Status::ok) return status;
  uses_edges = options.estimator.uses(Cue::edge);
  last_time_ns = view.time_ns;
  last_sequence = view.sequence;
  frame = 0;
  bad_frames = 0;
  matcher.start(limits.keeps_previous && options.estimator.uses(Cue::flow));
  is_started = true;
  return Status::ok;
}

/// Templates, edges and thumbnail of frame 0.
Status Tracker::Impl::capture_frame_0(const FrameView& view, Span<const Vec2> marker_places,
                                      float marker_exclusion_px) {
  Status status = region.build(view, region.is_whole_frame() ? Vec2{} : key_frames.middle_of(estimator));
  if (status != Status::ok) return status;
  key_frames.take(view);
  texture.note_all(estimator, region);
  estimator.begin(view.time_ns);
  status = markers.place(estimator, marker_places, marker_exclusion_px);
  if (status != Status::ok) return status;
  templates.clear();
  key_frames.clear();
  placement.place(templates, estimator, region, markers, 0, limits.patches);
  std::uint16_t captured = 0;
  for (std::size_t k = 0; k < limits.patches; ++k)
    captured = static_cast<std::uint16_t>(captured + templates[k].is_used);
  if (captured < kTrackerTuning.least_templates) return Status::too_few_points;
  result = {TrackState::tracking,
            pose_of(estimator.view()),
            captured,
            captured,
            0,
            0,
            static_cast<std::uint16_t>(estimator.mesh().vertex_count())};
  edges.start(estimator, region);
  key_frames.trust(estimator);
  key_frames.keep(0, estimator.view(), 0);
  return Status::ok;
}

Status Tracker::start_from_pose(const FrameView& frame, const Camera& camera, const Pose& pose,
                                const float* q, const TrackerOptions& options, Span<const Vec2> markers) {
  if (impl_ == nullptr) return Status::not_started;
  const Status status = impl_->check_start(frame, markers);
  if (status != Status::ok) return status;
  impl_->offsets.clear();
  for (std::size_t k = 0; k < impl_->start_q.count; ++k) impl_->start_q[k] = q == nullptr ? 0 : q[k];
  return impl_->start(frame, {camera, pose}, impl_->start_q.data, options, markers);
}

Status Tracker::start_from_landmarks(const FrameView& frame, Span<const NamedPoint> points,
                                     const StartOptions& start, const TrackerOptions& options,
                                     Span<const Vec2> markers) {
  if (impl_ == nullptr) return Status::not_started;
  Impl& t = *impl_;
  Status status = t.check_start(frame, markers);
  if (status == Status::ok && points.count > t.limits.start_points) status = Status::capacity;
  if (status == Status::ok && points.count < kLandmarkFitTuning.least_points) status = Status::too_few_points;
  if (status == Status::ok) status = t.check_landmarks(points);
  if (status == Status::ok && !(start.focal_px >= 0)) status = Status::bad_argument;
  if (status != Status::ok) return status;
  FitOptions fit;
  fit.width = frame.width;
  fit.height = frame.height;
  fit.focal_px = start.focal_px;
  fit.camera = start.camera;
  StartPose found;
  t.offsets.clear();
  status = t.fit_before_tracking([&](Arena& arena, const Model& model) {
    return fit_to_landmarks(arena, model, points, fit, t.start_q.data, &found,
                            start.keeps_landmark_offsets ? &t.offsets : nullptr);
  });
  if (status == Status::ok) status = t.start(frame, found, t.start_q.data, options, markers);
  if (status == Status::ok) t.offsets.place_pending(t.estimator);
  return status;
}

Status Tracker::start_from_box(const FrameView& frame, Vec2 corner, Vec2 size, const StartOptions& start,
                               const TrackerOptions& options, Span<const Vec2> markers) {
  if (impl_ == nullptr) return Status::not_started;
  Impl& t = *impl_;
  Status status = t.check_start(frame, markers);
  if (status == Status::ok && !(start.focal_px >= 0 && size.x > 0 && size.y > 0))
    status = Status::bad_argument;
  if (status != Status::ok) return status;
  t.offsets.clear();
  for (float& value : t.start_q) value = 0;
  StartPose found{start_camera(start.camera, start.focal_px, frame.width, frame.height), {}};
  status = t.fit_before_tracking([&](Arena& arena, const Model& model) {
    return fit_to_box(arena, model, corner, size, t.start_q.data, &found);
  });
  return status == Status::ok ? t.start(frame, found, t.start_q.data, options, markers) : status;
}

Status Tracker::start_from_state(const FrameView& frame, const SavedState& state,
                                 const TrackerOptions& options, Span<const Vec2> markers) {
  if (impl_ == nullptr) return Status::not_started;
  if (!impl_->fits_model(state)) return Status::bad_argument;
  for (const Vec3& offset : state.landmark_offsets)
    if (!is_finite(offset)) return Status::bad_argument;
  const Status status =
      start_from_pose(frame, state.camera, state.pose, state.parameters.data, options, markers);
  if (status == Status::ok && !state.landmark_offsets.empty()) impl_->offsets.set(state.landmark_offsets);
  return status;
}

Status Tracker::save(SavedState* state) const {
  if (!is_started()) return Status::not_started;
  if (state == nullptr || !impl_->fits_model(*state)) return Status::bad_argument;
  state->camera = camera();
  state->pose = impl_->result.pose;
  for (std::size_t k = 0; k < state->parameters.count; ++k) state->parameters[k] = parameters()[k];
  for (std::size_t k = 0; k < state->landmark_offsets.count; ++k)
    state->landmark_offsets[k] = impl_->offsets.values()[k];
  return Status::ok;
}

// --- A frame ---

/// A clock may be set back and a sequence number may be left out, but not both.
bool Tracker::Impl::is_stale(const FrameView& view) const {
  const bool is_next = view.sequence != last_sequence && view.sequence - last_sequence < 0x80000000u;
  return view.time_ns <= last_time_ns && !is_next;
}

Status Tracker::update(const FrameView& frame, FrameResult* result) {
  if (!is_started()) return Status::not_started;
  if (result == nullptr) return Status::bad_argument;
  Status status = impl_->region.check_frame(frame);
  if (status == Status::ok && impl_->is_stale(frame)) status = Status::stale_frame;
  if (status == Status::ok) status = impl_->predict(frame);
  if (status != Status::ok) return status;
  impl_->match_and_solve();
  impl_->conclude();
  *result = impl_->result;
  return Status::ok;
}

/// Where the model is expected, and the image there.
Status Tracker::Impl::predict(const FrameView& view) {
  last_time_ns = view.time_ns;
  last_sequence = view.sequence;
  ++frame;
  key_frames.take(view);
  estimator.begin(view.time_ns);
  const CoarseMotion motion = key_frames.find_motion(bad_frames);
  if (motion.from != nullptr) estimator.propose(*motion.from);
  if (motion.is_found) estimator.translate(motion.by_px);
  const bool is_trusted = bad_frames == 0;
  matcher.begin_frame(frame, is_trusted, motion.is_found && is_trusted ? length(motion.by_px) : kUnknownPx);
  region.advance();
  return region.build(view,
                      region.is_whole_frame() ? Vec2{} : key_frames.middle_of(estimator) + motion.by_px);
}

void Tracker::Impl::match_and_solve() {
  const int rounds = kTemplateMatchTuning.rounds;
  const bool has_first_pass = matcher.run_first_pass(match_frame(), estimator);
  for (int round = has_first_pass ? 1 : 0; round < rounds; ++round)
    if (run_round(round) == 0) break;
  if (estimator.needs_another_round()) run_round(rounds - 1);
}

/// Predicts, matches and solves once. \return how many points were searched for.
std::size_t Tracker::Impl::run_round(int round) {
  const PredictionTable predictions{estimator.predict(), prediction_index};
  for (std::size_t i = 0; i < predictions.all.count; ++i)
    prediction_index[predictions.all[i].id] = static_cast<std::uint16_t>(i);
  std::size_t searched = matcher.match(match_frame(), predictions, round);
  observation_count = matcher.observation_count();
  if (round + 1 == kTemplateMatchTuning.rounds && uses_edges) {
    const std::size_t n =
        edges.match(predictions, region, estimator.view().s,
                    {observations.data + observation_count, observations.count - observation_count});
    observation_count += n;
    searched += n;
  }
  if (searched > 0) estimator.solve({observations.data, observation_count});
  return searched;
}

void Tracker::Impl::conclude() {
  result = estimator.end();
  const bool is_good = result.state == TrackState::tracking;
  matcher.end_frame(match_frame(), is_good);
  bad_frames = is_good ? 0 : bad_frames + 1;
  if (!is_good) return;
  const std::size_t of_templates = matcher.observation_count();
  edges.end_frame({observations.data + of_templates, observation_count - of_templates});
  key_frames.trust(estimator);
  texture.note_frame(estimator, region, frame);
  keep_key_frame();
}

/// Keeps this frame as a key frame, if it shows the head from a new side: second templates for points that look different
/// by now, and new points where the surface was hidden before.
void Tracker::Impl::keep_key_frame() {
  const std::size_t key = key_frames.choose(estimator.view(), result, frame);
  if (key == 0) return;
  const std::size_t begin = first_slot(limits, key), end = first_slot(limits, key + 1);
  for (std::size_t slot = begin; slot < end; ++slot) templates.release(slot, estimator);
  key_frames.keep(key, estimator.view(), frame);
  const std::size_t free = templates.capture_second(
      limits.patches, begin, begin + (end - begin) / kTemplateStoreTuning.second_template_divisor, estimator,
      region);
  placement.place(templates, estimator, region, markers, free, end);
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

const FrameResult& Tracker::result() const {
  PLIANT_ASSERT(impl_ != nullptr);
  return impl_->result;
}

const Camera& Tracker::camera() const {
  PLIANT_ASSERT(impl_ != nullptr);
  return impl_->estimator.camera();
}

Estimator& Tracker::estimator() {
  PLIANT_ASSERT(impl_ != nullptr);
  return impl_->estimator;
}

Span<const float> Tracker::parameters() const {
  PLIANT_ASSERT(impl_ != nullptr);
  return impl_->estimator.parameters();
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
    impl_->offsets.place({l.u, l.v}, p.x, impl_->estimator);
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
