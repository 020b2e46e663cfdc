#pragma once
/// \file self_start.hpp
/// Starts that a tracker makes by itself, and the verification of its tracks: what connects FaceStart with the tracker.
#include <cstddef>
#include <cstdint>

#include "track/face_start.hpp"
#include "track/markers.hpp"

namespace pliant {

struct TrackerParts;

/// What a tracker keeps for starts of its own. In the arena, if the limits name a detection and the model has learnt tables.
struct SelfStart {
  FaceStart faces;
  StartOptions start;                       // what is known of the camera
  Camera camera;                            // room for the one that `start` names
  TrackerOptions options;                   // of the last start
  Span<std::uint8_t> is_free;               // room for TrackerOptions::is_free
  const StartOptions* of_caller = nullptr;  // while the caller starts
  KnownPerson person;
  MarkerPlace* markers = nullptr;  // of the known person
  std::size_t marker_count = 0;
  bool is_own_start = false;  // while the tracker starts by itself
  float landmark_error = 0;   // of the last start, as the alignment estimates it; 0: unknown

  void lay_out(Arena& arena, const Model& model, const TrackerLimits& limits);
};

/// What is known of a start of the caller's.
struct RoughStart {
  const FaceBox* box;  // null: from points
  bool is_rough;       // it is to be moved to where the picture shows the face, if it is verified there
  const StartOptions& options;
};

/// The calls of a tracker. It makes them through this table only, so that a program whose limits name no table does not link
/// what is behind it.
struct FaceDetection {
  /// Takes a SelfStart from the arena. \param search_bytes  out: what a search takes of the memory of the tracking.
  /// \return null if the arena measures, is exhausted, or the model has no tables.
  SelfStart* (*lay_out)(Arena& arena, const Model& model, const TrackerLimits& limits,
                        std::size_t* search_bytes);
  /// Bytes that a check takes of unused memory. 0 without tables.
  std::size_t (*check_bytes)(const Model& model, const TrackerLimits& limits);
  /// Ends the track and forgets the person. Keeps the options for the starts that follow.
  void (*begin_search)(TrackerParts& tracker, const StartOptions& start, const TrackerOptions& options);
  /// A frame without a track: searches it for a face. The track of one that is found begins with this frame.
  Status (*search)(TrackerParts& tracker, const FrameView& frame);
  /// Gives the memory of the search back to the tracking.
  void (*end_search)(TrackerParts& tracker);
  /// Begins a start of the caller's, whose options last until begin_track, and refines it.
  void (*refine)(TrackerParts& tracker, const FrameView& frame, const RoughStart& rough, StartPose* start);
  /// Ends a start: verifies it, and keeps its options.
  void (*begin_track)(TrackerParts& tracker, const FrameView& frame, const TrackerOptions& options);
  /// Ends a frame of a track. Checks whether it is a face, and gives it up if it is not, or has been lost for some frames.
  void (*conclude)(TrackerParts& tracker, const FrameView& frame);
  const FaceModules* modules;
};

}  // namespace pliant
