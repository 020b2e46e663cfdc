#pragma once
/// \file detection_state.hpp
/// Starts that a tracker makes by itself, and the verification of its tracks: what connects detection with the tracker.
#include <cstddef>

#include "pliant/face_box.hpp"
#include "track/kept_start.hpp"
#include "track/markers.hpp"
#include "track/start_fit.hpp"

namespace pliant {

struct DetectionCalls;
struct FaceModules;
struct SecondLookState;
struct TrackerParts;

/// What a tracker keeps for starts of its own: the common part. In the arena, if the limits name a detection
/// that the model has tables for.
struct DetectionState {
  const DetectionCalls* calls = nullptr;
  KeptStart kept;
  const StartOptions* of_caller = nullptr;  // while the caller starts
  MarkerPlace* markers = nullptr;           // of a track that ended, for the next one of the same surface
  std::size_t marker_count = 0;
  SecondLookState* look = nullptr;  // of faces; null: the limits name no second looks
  void (*restore_markers)(TrackerParts& tracker) = nullptr;  // while the tracker starts by itself; else null

  bool is_own_start() const { return restore_markers != nullptr; }
  void lay_out(Arena& arena, const DetectionCalls* of, const Model& model, const TrackerLimits& limits);
  /// Ends the track, and keeps the options for the starts that follow.
  void begin_search(TrackerParts& tracker, const StartOptions& start, const TrackerOptions& options);
  /// Starts the track of what a search found, with the parameters of TrackerParts::start_q and the markers that are kept.
  Status start(TrackerParts& tracker, const FrameView& frame, const StartPose& found,
               const TrackerOptions& options);
  /// Keeps the options of a start that the caller made. \return false, and nothing kept, if the tracker made it itself.
  bool keep_start_of_caller(const TrackerOptions& options);
  /// Copies the parameters of the track to TrackerParts::start_q.
  static void keep_parameters(TrackerParts& tracker);
  /// Ends a track that is wrong or lost. TrackerParts::start_q keeps its parameters; the next frames are searched.
  static void give_up(TrackerParts& tracker);
};

/// What a search answers with after a start: a track that does not fit the limits will never begin.
inline Status answer_of(Status start) {
  return start == Status::capacity ? start : Status::ok;
}

/// What is known of a start of the caller's.
struct RoughStart {
  static constexpr std::size_t kExact = ~std::size_t{0};
  const FaceBox* box;  // null: from points or a pose
  std::size_t points;  // their number; kExact: a pose
  const StartOptions& options;
};

/// What TrackerLimits::detection names. A tracker reaches detection through it alone, so that a program whose limits name none
/// does not link what is behind it.
struct Detection {
  /// Takes a DetectionState from the arena. \param search_bytes  out: what a search takes of the memory of the tracking.
  /// \return null if the arena measures, is exhausted, or the model has no tables.
  DetectionState* (*lay_out)(Arena& arena, const Model& model, const TrackerLimits& limits,
                             std::size_t* search_bytes);
  /// Bytes that a check, or an alignment of a frame, takes of memory that is unused between frames. 0 without tables.
  std::size_t (*check_bytes)(const Model& model, const TrackerLimits& limits);
  /// Bytes of scratch that DetectionCalls::read_parts takes. Null: none.
  std::size_t (*read_bytes)(const Model& model, const TrackerLimits& limits);
  const FaceModules* modules;  ///< of faces; null elsewhere
};

/// The calls of a tracker to what has laid its DetectionState out.
struct DetectionCalls {
  /// Ends the track and forgets the person. Keeps the options for the starts that follow.
  void (*begin_search)(TrackerParts& tracker, const StartOptions& start, const TrackerOptions& options);
  /// A frame without a track: searches it. The track of what is found begins with this frame.
  Status (*search)(TrackerParts& tracker, const FrameView& frame);
  /// Gives the memory of the search back to the tracking.
  void (*end_search)(TrackerParts& tracker);
  /// Begins a start of the caller's, whose options last until begin_track. A rough one is moved to where the
  /// picture shows the surface, if it is verified there.
  void (*refine)(TrackerParts& tracker, const FrameView& frame, const RoughStart& rough, StartPose* start);
  /// Ends a start: verifies it, and keeps its options.
  void (*begin_track)(TrackerParts& tracker, const FrameView& frame, const TrackerOptions& options);
  /// Ends a frame of a track. Verifies it, and gives it up if it is wrong, or has been lost for some frames.
  void (*conclude)(TrackerParts& tracker, const FrameView& frame);
  /// In a frame of a track, before its last solve: tells the estimator what learnt readers see of parts of
  /// the surface. Null: there are none.
  void (*read_parts)(TrackerParts& tracker, const FrameView& frame);
  /// The person has changed: the readings of the parts differ from the model by more, as each landmark's offset does.
  /// \param moved  of each landmark, mm, model's axes. Null: there are none.
  void (*keep_parts)(TrackerParts& tracker, const Vec3* moved);
};

}  // namespace pliant
