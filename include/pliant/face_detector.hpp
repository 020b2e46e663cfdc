#pragma once
/// \file face_detector.hpp
/// Finds a face in a frame without a prior. Nothing in it is learnt: the templates are
/// rendered from the model itself.
///
/// Three steps (docs/algorithms.md, section 7.11). Small templates of the model in nine poses are compared with the
/// frame at all positions and sizes, by the directions of their gradients. At the most similar places the model is
/// rendered larger, its landmarks are searched around their rendered positions, and pose and parameters are fitted to
/// them, several times. The fitted model is compared with the frame once more: its similarity decides whether it is a
/// face.
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/camera.hpp"
#include "pliant/fit.hpp"
#include "pliant/frame.hpp"
#include "pliant/model.hpp"
#include "pliant/pyramid.hpp"
#include "pliant/status.hpp"

namespace pliant {

class RenderedTemplate;
class TemplateSearch;
class LandmarkSearch;
struct Candidate;

/// Capacities of a FaceDetector.
struct FaceDetectorLimits {
  std::uint16_t width = 320, height = 240;  ///< of the frames, px
  /// Larger side of the smallest inner face, as a fraction of the frame's height, 0.15 to 0.6. The inner face reaches from
  /// the brows to the lips. Memory and time grow with 1 / smallest_fraction^2.
  float smallest_fraction = 0.22f;
};

/// Options of a FaceDetector.
struct FaceDetectorOptions {
  float largest_fraction = 0.65f;  ///< the same of the largest inner face, smallest_fraction to 1
  /// Smallest similarity of a face, 0 to 1. Measured: none of 300 images of clutter and about
  /// 50 images of other objects and upside-down faces reaches 0.46. 98 % of rendered faces exceed 0.53. The one real face
  /// that was measured exceeds 0.5 in every third frame of its film.
  float min_similarity = 0.5f;
};

/// Result of FaceDetector::find.
struct FaceDetectorReport {
  bool is_found = false;  ///< whether similarity reaches the limit
  float similarity = 0;   ///< of the best place, found or not: cosine between gradient directions, -1 to 1
  Pose pose;              ///< of the face; meaningful if found
};

/// Detects faces within about 20 degrees of upright and frontal. Needs a model with an albedo, curves (lids, brows,
/// lips) and landmarks. Lives in an arena: about half a megabyte for 320 x 240 and the built-in face, which can be
/// reused after the detection, because its result is only the pose and the parameters.
class FaceDetector {
 public:
  FaceDetector() = default;
  FaceDetector(const FaceDetector&) = delete;
  FaceDetector& operator=(const FaceDetector&) = delete;

  /// Takes its memory from the arena; called by create_in and measured_bytes (arena.hpp).
  void lay_out(Arena& arena, const Model& model, const FaceDetectorLimits& limits);

  /// Renders the templates. Cost: as `find`.
  /// \return `not_found` if the model lacks what is needed, `bad_argument` for a camera or options out of range.
  Status begin(const Camera& camera, const FaceDetectorOptions& options);

  /// Searches one frame, independently of earlier ones.
  /// \return `not_started`, `bad_argument`, `size_mismatch`; then nothing has changed. Cost: a tenth of a second on a
  ///         PC for a frame of any size, most of it for sampling the fields of the fits.
  Status find(const FrameView& frame, FaceDetectorReport* report);
  /// The parameters of the last `find`, all of the model's; meaningful if it found a face.
  Span<const float> parameters() const { return {best_q_, parameter_count_}; }

  /// Computes how similar a frame is to the model with this pose and these parameters (all of them): a check of a
  /// track.
  /// \return as `find`; `bad_argument` also for a pose closer than 50 mm or farther than 100 m. Cost: a millisecond
  ///         on a PC.
  Status compare(const FrameView& frame, const Pose& pose, const float* q, float* similarity);

 private:
  struct Place {
    View view;
    float similarity;
  };
  Status load(const FrameView& frame);
  void align(Place& place, int round, const std::uint8_t* is_free);
  void align_pose(const Candidate& candidate, Place* place);
  void align_fully(Place& place);
  void measure(Place& place);

  Model model_;
  FaceDetectorLimits limits_;
  FaceDetectorOptions options_;
  Camera camera_;
  Pyramid pyramid_;
  Fitter fitter_;
  RenderedTemplate* rendered_ = nullptr;
  TemplateSearch* search_ = nullptr;
  LandmarkSearch* landmarks_ = nullptr;
  Place* places_ = nullptr;
  Correspondence* pairs_ = nullptr;
  float *q_ = nullptr, *best_q_ = nullptr;
  std::uint8_t* none_free_ = nullptr;
  std::size_t parameter_count_ = 0;
  bool started_ = false;
};

}  // namespace pliant
