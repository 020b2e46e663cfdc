#pragma once
/// \file initial_detection.hpp
/// `--init detect`: finds the face that a track starts from, and rejects a detection that the track does not confirm.
#include <optional>
#include <ostream>
#include <string>

#include "host/commands/args.hpp"
#include "host/commands/initial_state.hpp"
#include "host/io/files.hpp"
#include "host/io/owned.hpp"
#include "pliant/face_detector.hpp"
#include "pliant/tracker.hpp"

namespace pliant::host {

/// Tuning of starts by detection. Each constant: unit, reason, experiment.
struct InitialDetectionTuning {
  /// Frames after a detection in which it is compared with the image, count. Round value, not tuned: at 30 frames a
  /// second a third of a second, in which a tracker on clutter has lost it.
  int trial_frames = 10;
  /// Mean similarity that confirms a detection, as a fraction of the detector's threshold. Below 1, because a face that
  /// turns and talks is less similar to the fitted model than in the frame of the detection. Round value, not tuned.
  float confirming_fraction = 0.85f;
};
inline constexpr InitialDetectionTuning kInitialDetectionTuning{};

/// Detects a face in frame after frame until a detection is confirmed. Reports detections on `err`.
class InitialDetection {
 public:
  /// \param max_frames  frames without a confirmed face after which the search fails.
  /// Bad input: a model that lacks what the detector needs.
  InitialDetection(const ModelFile& file, const ImageSize& size, const Camera& camera,
                   const std::string& frames, int max_frames, std::ostream& err);

  /// The state of the face that one frame shows; nothing if none was found. Bad input: none was found in max_frames.
  std::optional<InitialState> find(const FrameView& frame, std::size_t number);
  /// To be called if the tracker could not start from the last detection. Bad input: as `find`.
  void reject(std::size_t number);
  /// To be called for each tracked frame. False once, at the end of the trial, if the model was not similar to the
  /// image: the detection was wrong, and `find` is to be called again.
  bool is_confirmed(const FrameView& frame, std::size_t number, Tracker& tracker);
  /// To be called after the last frame. Bad input: no detection, or the last one was rejected.
  void require_found() const;

 private:
  float similarity_in(const FrameView& frame, Tracker& tracker);
  [[noreturn]] void give_up() const;

  std::string frames_;
  int max_frames_;
  std::ostream& err_;
  Owned<FaceDetector> detector_;
  Camera camera_;
  int searched_frames_ = 0;
  int trial_frames_ = 0;       // since the last detection
  float similarity_sum_ = 0;   // over these
  float best_similarity_ = 0;  // of all searched frames
  std::size_t detection_frame_ = 0;
  bool is_found_ = false;  // and not rejected since
};

}  // namespace pliant::host
