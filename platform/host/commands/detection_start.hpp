#pragma once
/// \file detection_start.hpp
/// `--init detect`: a track that starts by itself, and is told when its start does not hold.
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "host/commands/args.hpp"
#include "host/io/files.hpp"
#include "host/io/owned.hpp"
#include "pliant/fit.hpp"
#include "pliant/face_detector.hpp"
#include "pliant/tracker.hpp"

namespace pliant::host {

/// Where a track starts.
struct Beginning {
  Camera camera;
  Pose pose;
  std::vector<float> q;                        ///< all parameters
  std::vector<Correspondence> landmarks = {};  ///< where the person has them, not the model
};

class DetectionStart {
 public:
  /// \param most_frames  how many are looked at before it gives up.
  /// Bad input when the model has not got what it takes.
  DetectionStart(const ModelFile& file, const ImageSize& size, const Camera& camera, const std::string& frames,
            int most_frames, std::ostream& err);

  /// Looks for the model in one frame. Bad input when nothing was found in `most_frames` one after the other.
  std::optional<Beginning> find(const FrameView& frame, std::size_t number);
  /// The tracker could not start where the model was found.
  void refuse(std::size_t number);
  /// To be asked for each frame tracked. False when ten frames after the start the tracker is not on a face: then
  /// the start was wrong.
  bool holds(const FrameView& frame, std::size_t number, Tracker& tracker);
  /// To be asked in the end. Bad input when there is no start.
  void conclude() const;

 private:
  [[noreturn]] void give_up() const;

  std::string frames_;
  int most_frames_;
  std::ostream& err_;
  Owned<FaceDetector> finder_;
  Camera camera_;
  int looked_ = 0, followed_ = 0;  // frames looked for a start in, and since the last start
  std::size_t started_at_ = 0;
  float most_ = 0, sum_ = 0;  // likeness
  bool is_on_ = false;        // a start has not failed since
};

}  // namespace pliant::host
