#pragma once
/// \file fault_run.hpp
/// A tracker that finds its face by itself, on a clip with a fault.
#include <vector>

#include "host/bench/annotated_faces.hpp"
#include "host/bench/film_faults.hpp"
#include "host/io/files.hpp"
#include "pliant/tracker_limits.hpp"

namespace pliant::host {

/// A clip, and the landmarks that the tracker finds in it without a fault.
struct JudgedClip {
  FilmClip clip;
  std::vector<NamedLandmarks> truth;
  TrackerLimits limits;  ///< of the tracker
};

/// Runs the tracker on the frames of a clip as they are, and notes landmarks, middle and width of the face.
/// \param limits  of the tracker, but for the size of the frames. \param frames  kClipFrames of one size.
/// \return false if it loses the face: then there is no truth.
bool judge(const ModelFile& file, TrackerLimits limits, std::vector<Image> frames, JudgedClip* out);

/// Counts of one fault over all clips.
struct FaultCounts {
  double clips = 0;
  double with_face = 0, tracking = 0;  ///< frames of the fault that show the face; those in state tracking
  double wrong = 0;          ///< frames in state tracking without a face, or with a landmark error above 0.1
  double wrong_most = 0;     ///< largest landmark error of these
  double never = 0;          ///< clips that are not right again in the 40 frames after the fault
  std::vector<double> back;  ///< frames after the fault until tracking with an error below kRightError
  double most_work = 0;      ///< of a frame, as a fraction of what the plan says it takes at most
  std::vector<double> milliseconds;  ///< of the frames with a track before and after
};

/// Plays a clip with a fault and adds what happens.
void play(const ModelFile& file, const JudgedClip& judged, const FilmFault& fault, FaultCounts* counts);

}  // namespace pliant::host
