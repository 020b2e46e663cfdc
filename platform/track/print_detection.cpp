// What connects the search for a print with the tracker.
#include <new>

#include "pliant/face_detector.hpp"
#include "print/print_finder.hpp"
#include "print/print_tuning.hpp"
#include "track/detection_state.hpp"
#include "track/landmark_fit.hpp"
#include "track/tracker_parts.hpp"
#include "track/tracker_sizes.hpp"

namespace pliant {

namespace {

/// Tuning of starts by print. Chosen on the poster of `fixtures/sheet` with `pliant bench print`, and judged
/// on two other prints (docs/evaluation.md, Start by print). What other values give was not recorded, except where it is told.
struct PrintStartTuning {
  /// Bad checks in a row after which a track is given up.
  int most_bad_checks = 2;
  /// A check is bad where so many blocks are visible and less than this fraction of them agrees.
  int least_visible = 10;
  float least_agreement = 0.15f;
  /// A frame is degraded where less than this fraction agrees. With 30 % of a sheet hidden 0.55 and more agreed (films A and
  /// occluded B, errors below 1 %); of frames with errors above 5 % behind a textured occluder at most 0.27.
  float least_sure_agreement = 0.4f;
  /// So is one where less than the first fraction agrees and the residual is larger, px at an image width of 320: the surface does
  /// what its shapes cannot. Of cloth that is stretched by a quarter 0.75 agrees, with 1.8 to 2.7 px (cloth A); right frames of the
  /// other films leave 1.4 px.
  float least_fitting_agreement = 0.85f, most_rms_px = 1.5f;
  /// A track that began by print is degraded until this fraction of the visible blocks has agreed, each in this frame or an
  /// earlier one: blur and what moves by hide other blocks in other frames (docs/experiments.md, Start by print). A search
  /// finds also a surface of which a part is folded away; the rest of it is then wrong until it is seen (cloth A: up to 0.81
  /// agreed at errors above 5 %).
  float least_confirming_agreement = 0.92f;
  /// The same of a flat rigid surface, of which nothing folds or turns away: 198 films of a square with a cover, 14 frames each,
  /// have 1,786 frames in state tracking, none off by more than 1.3 % of its height. A half mug, rigid, may be turned so that its
  /// covered side is hidden, with 0.89 agreeing.
  float least_flat_agreement = 0.6f;
  /// And until this fraction of the places has that the surface would show at rest (FoundPrint::expected). Of half mugs, a page and
  /// a packet, one side of which was covered at the start and folded away, 0.21 to 0.46 agreed; of right starts of the same films
  /// 0.65 and more (docs/experiments.md, Start by print).
  float least_shown = 0.55f;
  /// Frames after which a start by print that is not confirmed is given up: its hidden part has no templates, and a new search
  /// finds what has come to light since. Half a second, not tuned.
  int most_unconfirmed_frames = 15;
  /// Bad frames in a row after which a track is given up. The search is more certain than key frames.
  int most_bad_frames = 4;
};
constexpr PrintStartTuning kTuning;

extern const DetectionCalls kPrintCalls;

struct PrintDetectionState : DetectionState {
  PrintTable table;
  PrintFinder* finder = nullptr;  // in the block, while there is no track
  int frames_since_check = 0, bad_checks = 0, unconfirmed_frames = 0;
  float agreement = 1;   // of the last check
  PrintHistory history;  // of this track
  int expected = 0;      // FoundPrint::expected of the search that began it
  float least_confirming = kTuning.least_confirming_agreement;  // of this track
  bool is_confirmed = true;

  void lay_out(Arena& arena, const Model& model, const TrackerLimits& limits) {
    DetectionState::lay_out(arena, &kPrintCalls, model, limits);
    const bool has_albedo = model.albedo().pixels != nullptr;
    if (PrintTable::open(model.print(), &table) != Status::ok || !has_albedo) table = {};
  }
};

PrintDetectionState& self_of(TrackerParts& t) {
  return *static_cast<PrintDetectionState*>(t.detection);
}

DetectionState* lay_out(Arena& arena, const Model& model, const TrackerLimits& limits, std::size_t* bytes) {
  if (model.print().empty() || limits.width > kLargestFramePx || limits.height > kLargestFramePx)
    return nullptr;
  Arena trial;
  lay_out_part<PrintFinder>(trial, trial.make<PrintFinder>(), model, limits.width, limits.height);
  *bytes = trial.used_bytes();
  return create_part<PrintDetectionState>(arena, model, limits);
}

std::size_t check_bytes(const Model&, const TrackerLimits&) {
  return 0;
}

void begin_search(TrackerParts& t, const StartOptions& start, const TrackerOptions& options) {
  PrintDetectionState& self = self_of(t);
  self.finder = nullptr;
  self.marker_count = 0;
  t.offsets.clear();
  self.begin_search(t, start, options);
}

/// A key frame's templates, and those of a start by print, are captured where the picture shows the print: not on what is in front
/// of it. A start of the caller's may be too rough for that.
bool accepts_template(void* tracker, const FrameRegion& region, Vec2 uv, const Prediction& seen) {
  TrackerParts& t = *static_cast<TrackerParts*>(tracker);
  const PrintDetectionState& self = self_of(t);
  if (!self.table.is_open() || !(t.is_started || self.is_own_start())) return true;
  const float block_px = print_block_px(t.estimator.view().s * self.table.extent_mm());
  return shows_print(frame_of(region.pyramid().level(0)), t.table,
                     {uv, seen.x - region.origin(), seen.jacobian}, block_px);
}

/// Lays the search out in the memory of the tracking, if that has it now.
PrintFinder& finder_of(TrackerParts& t) {
  PrintDetectionState& self = self_of(t);
  if (t.block.is_of_search && self.finder != nullptr) return *self.finder;
  new (&t.estimator) Estimator();
  Arena arena(t.block.bytes.data, t.block.bytes.count);
  self.finder = create_part<PrintFinder>(arena, t.table, t.limits.width, t.limits.height);
  t.block.is_of_search = true;
  return *self.finder;
}

Status search(TrackerParts& t, const FrameView& view) {
  PrintDetectionState& self = self_of(t);
  PrintFinder& finder = finder_of(t);
  const StartOptions& o = self.kept.start;
  const Camera camera = start_camera(o.camera, o.focal_px, view.width, view.height);
  FoundPrint found;
  Status status = finder.search(view, t.limits.search_work, camera, t.start_q.data, &found);
  if (status != Status::ok) return status == Status::not_found ? Status::ok : status;
  self.expected = found.expected;
  self.least_confirming = found.shows_all ? kTuning.least_flat_agreement : kTuning.least_confirming_agreement;
  t.templates.set_check({&t, accepts_template});
  return answer_of(self.start(t, view, {camera, pose_of(found.view)}, self.kept.options));
}

void end_search(TrackerParts& t) {
  self_of(t).finder = nullptr;
  t.lay_out_tracking();
}

void refine(TrackerParts& t, const FrameView&, const RoughStart& rough, StartPose*) {
  self_of(t).of_caller = &rough.options;
  self_of(t).marker_count = 0;  // also if this start fails
  t.templates.set_check({&t, accepts_template});
}

bool project(void* state, Vec2 uv, Vec2* x) {
  return static_cast<Estimator*>(state)->project({clamp(uv.x, 0, 1), clamp(uv.y, 0, 1)}, x);
}

/// Whether the surface that the camera sees at x is near (u,v).
bool shows(void* state, Vec2 uv, Vec2 x) {
  Vec2 seen;
  return static_cast<Estimator*>(state)->surface_at(x, &seen) == 0 &&
         length(seen - uv) <= kPrintTuning.same_place;
}

/// A fraction of the visible blocks; 1 where too few are visible to tell.
float fraction_of(int blocks, const PrintAgreement& a) {
  return a.visible < kTuning.least_visible ? 1 : static_cast<float>(blocks) / static_cast<float>(a.visible);
}

/// Whether the places that the surface would show at rest have come to sight, unless they are outside the frame. Those that a
/// found shape folds away are not among the visible blocks.
bool has_shown_most(const PrintDetectionState& self, const PrintAgreement& a) {
  return static_cast<float>(self.history.first_round_count()) >=
         kTuning.least_shown * static_cast<float>(self.expected - a.outside);
}

void check(TrackerParts& t, const FrameView& view) {
  PrintDetectionState& self = self_of(t);
  self.frames_since_check = 0;
  const float block_px = print_block_px(t.estimator.view().s * self.table.extent_mm());
  const PrintAgreement a =
      compare_print(view, t.table, self.table, {&t.estimator, project, shows}, block_px, &self.history);
  self.agreement = fraction_of(a.agreed, a);
  self.bad_checks = self.agreement < kTuning.least_agreement ? self.bad_checks + 1 : 0;
  self.is_confirmed = self.is_confirmed ||
                      (fraction_of(a.agreed_once, a) >= self.least_confirming && has_shown_most(self, a));
}

/// Makes a frame degraded whose surface is not where the picture shows the print.
void doubt(TrackerParts& t) {
  const PrintDetectionState& self = self_of(t);
  const bool fits = self.agreement >= kTuning.least_fitting_agreement ||
                    t.result.rms_px <= scaled_px(t.limits, kTuning.most_rms_px);
  if (!self.is_confirmed || self.agreement < kTuning.least_sure_agreement || !fits)
    t.result.state = TrackState::degraded;
}

void give_up(TrackerParts& t) {
  PrintDetectionState& self = self_of(t);
  self.marker_count = t.markers.save(t.estimator, self.markers);
  StartOptions known = self.kept.start;
  known.camera = &t.estimator.camera();  // with the focal length that the start has found
  self.kept.keep(known);
  DetectionState::give_up(t);
}

void conclude(TrackerParts& t, const FrameView& view) {
  PrintDetectionState& self = self_of(t);
  if (!self.table.is_open()) return;
  if (t.progress.bad_frames > 0) {
    if (t.progress.bad_frames >= kTuning.most_bad_frames) give_up(t);
    return;
  }
  if (++self.frames_since_check >= kPrintTuning.check_interval_frames) check(t, view);
  if (!self.is_confirmed) ++self.unconfirmed_frames;
  if (self.bad_checks >= kTuning.most_bad_checks ||
      self.unconfirmed_frames >= kTuning.most_unconfirmed_frames)
    return give_up(t);
  doubt(t);
}

void begin_track(TrackerParts& t, const FrameView& view, const TrackerOptions& options) {
  PrintDetectionState& self = self_of(t);
  if (self.keep_start_of_caller(options)) self.marker_count = 0;
  self.frames_since_check = self.bad_checks = self.unconfirmed_frames = 0;
  self.agreement = 1;
  self.history.clear();
  self.is_confirmed = !self.is_own_start();
  if (!self.table.is_open() || !self.is_own_start()) return;
  check(t, view);
  doubt(t);
}

const DetectionCalls kPrintCalls{begin_search, search,   end_search, refine,
                                 begin_track,  conclude, nullptr,    nullptr};

}  // namespace

const Detection kPrintDetection{lay_out, check_bytes, nullptr, nullptr};

}  // namespace pliant
