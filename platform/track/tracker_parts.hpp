#pragma once
/// \file tracker_parts.hpp
/// The parts of a tracker and the state that they share. tracker.cpp has the memory and the frame,
/// tracker_start.cpp the starts.
#include "pliant/tracker.hpp"
#include "track/detection_state.hpp"
#include "track/edge_tracker.hpp"
#include "track/frame_budget.hpp"
#include "track/frame_order.hpp"
#include "track/frame_region.hpp"
#include "track/key_frames.hpp"
#include "track/landmark_offsets.hpp"
#include "track/markers.hpp"
#include "track/noise_smoothing.hpp"
#include "track/person_refinement.hpp"
#include "track/start_fit.hpp"
#include "track/surface_texture.hpp"
#include "track/template_matcher.hpp"
#include "track/template_placement.hpp"
#include "track/template_store.hpp"

namespace pliant {

/// The parts that work on images.
struct ImageParts {
  FrameRegion region;
  TemplateStore templates;
  TemplateMatcher matcher;
  TemplatePlacement placement;
  EdgeTracker* edges = nullptr;  // null: the limits name no matching of edges
  KeyFrames key_frames;
  SurfaceTexture* texture = nullptr;  // null: the limits name none
  Markers markers;
  Span<Observation> observations;
  std::uint16_t* prediction_index = nullptr;  // by id of a surface point
  // For what is done at one time: corners, a check, mesh adaptation if limits share its memory.
  Span<unsigned char> scratch;
  Span<unsigned char> of_solves;              // unused where no solve of the frame follows
  Span<unsigned char> unused_between_frames;  // with both in it

  void lay_out(Arena& arena, const Model& model, const TrackerLimits& limits);

 private:
  void lay_out_unused_between_frames(Arena& arena, const Model& model, const TrackerLimits& limits);
};

/// What the caller has said of the person: it stays.
struct GivenByCaller {
  bool identity = false;   // with a pose
  bool landmarks = false;  // by place_landmarks
};

struct TrackerParts;

/// How far a track is.
struct TrackProgress {
  std::uint32_t frame = 0;      // 0 at the start
  std::uint32_t last_kept = 0;  // frame that became a key frame
  int bad_frames = 0;           // in a row
  bool uses_edges = false;
  SearchFrom search_from = SearchFrom::prediction;  // in this frame
  /// What a start has left to the next frame, which does it first, in the picture of the frame before. May end the track, and
  /// sets what is left then. Null: nothing.
  void (*rest)(TrackerParts& tracker, const FrameView& frame) = nullptr;
};

/// As of Tracker.
struct TrackNumbers {
  std::uint32_t track = 0, person = 0;
};

/// Memory of search, fit and tracking, one at a time.
struct SharedBlock {
  Span<unsigned char> bytes;
  bool is_of_search = false;  // else of the tracking, which is laid out in it
};

/// The estimator and the parts that work on images share their memory with what runs while there is no track:
/// the search for a face, and the fit of a start.
struct TrackerParts : ImageParts {
  // Set by lay_out. The default limits would link all that is optional into every program.
  TrackerLimits limits = without_noise_smoothing(
      without_second_look(without_person(without_edges(without_detection(without_stretch(
          without_rejection(without_personal_field(without_mesh_following(TrackerLimits{})))))))));
  Model table;
  Span<float> start_q;
  LandmarkOffsets offsets;
  SharedBlock block;
  // Null: the limits name no detection, or the model has no learnt tables.
  DetectionState* detection = nullptr;
  NoiseFilter* noise = nullptr;   // null: the limits name no smoothing, or the model is no face
  PersonState* person = nullptr;  // null: the limits name no estimation, or the model has no identity

  Estimator estimator;
  std::size_t observation_count = 0;
  FrameResult result;
  FrameBudget budget;
  FrameOrder order;
  TrackNumbers numbers;
  TrackProgress progress;
  /// Templates of a start in the picture that the region has already; the others are left to the next frames. 0: all, in a new
  /// picture.
  std::uint16_t first_templates = 0;
  bool is_started = false, smooths = false;
  GivenByCaller given;
  bool keeps_landmark_offsets = true;  // as TrackerOptions

  const Model& model() const { return table; }
  MatchFrame match_frame() { return {templates, region, observations, {&key_frames, &estimator.view()}}; }

  /// The tracking's parts. Null: measures.
  static void lay_out_tracking(Arena& arena, TrackerParts* parts, const Model& model,
                               const TrackerLimits& limits);
  void lay_out_tracking();

  /// The frame, smoothed if it is noisy.
  const FrameView& quiet(const FrameView& view);

  Status check_start(const FrameView& frame, const TrackerOptions& options, Span<const Vec2> markers) const;
  Status check_landmarks(Span<const NamedPoint> points) const;
  bool fits_model(const SavedState& state) const;
  /// Ends the track, if there is one. The result becomes that of a frame without one.
  void end_track();
  /// The next frame may be of another stream: times, noise and work of the frames before it have no effect.
  void begin_stream();
  template <class Fit>
  Status fit_before_tracking(Fit&& fit);
  void refine(const FrameView& frame, const RoughStart& rough, StartPose* from);
  Status start_at_fit(Status fitted, const FrameView& frame_0, const RoughStart& rough, StartPose* from,
                      const TrackerOptions& with, Span<const Vec2> marker_places);
  Status start(const FrameView& frame, const StartPose& from, const TrackerOptions& with,
               Span<const Vec2> marker_places);
  Status capture_frame_0(const FrameView& view, Span<const Vec2> marker_places, float marker_exclusion_px);

  void limit_searches();
  void limit_solves();
  void note_work();
  Status track(const FrameView& view);
  Status predict(const FrameView& view);
  void match_and_solve(const FrameView& view);
  std::size_t run_round(int round);
  void conclude();
  void keep_key_frame();
};

struct Tracker::Impl : TrackerParts {};

}  // namespace pliant
