#pragma once
/// \file face_detector.hpp
/// Finds a face in a picture without being given a point: how a device with a camera and no detector starts. Nothing in
/// it is learnt: templates are drawn from the model itself.
///
/// Three steps. Small drawings of the model in nine poses are compared with the picture at all places and sizes, by the
/// directions in which grey values rise. At the likeliest places the model is drawn larger, its landmarks are
/// looked for around where they are drawn, and pose and parameters are fitted to them, a few times over. In the end
/// the model as fitted is compared with the picture once more: that likeness tells a face from other things.
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

class ModelPicture;
class PictureSearch;
class PartSearch;
struct Candidate;

struct FaceDetectorLimits {
  std::uint16_t width = 320, height = 240;  ///< of the frames, px
  /// Smallest inner face, as a share of the frame's height: brows to lips and as wide as the brows, seven tenths of the
  /// built-in face. Memory and time go with 1 / its square. 0.15 to 0.6.
  float smallest_fraction = 0.22f;
};

struct FaceDetectorOptions {
  float largest_fraction = 0.65f;  ///< largest inner face, of the frame's height; smallest_fraction to 1
  /// Cosine between the directions of the fitted model and of the picture from which it counts as found. Measured: of
  /// 300 pictures of clutter and some fifty of other things, faces upside down among them, none reaches 0.46; of drawn
  /// faces 98 in a hundred exceed 0.53; the one real face there was to try, 0.5 in every third frame of a film.
  float min_similarity = 0.5f;
};

struct FaceDetectorReport {
  bool is_found = false;
  float similarity = 0;  ///< of the best place, found or not; -1 to 1
  Pose pose;           ///< there; meaningful when found
};

/// Needs a model with an albedo, curves (lids, brows, lips) and landmarks. Heads within about 20 degrees of upright
/// and frontal are found. Lives in an arena; 320 x 240 and the built-in face take about half a megabyte, which a
/// tracker may have afterwards: what was found is only the pose and the parameters.
class FaceDetector {
 public:
  FaceDetector() = default;
  FaceDetector(const FaceDetector&) = delete;
  FaceDetector& operator=(const FaceDetector&) = delete;

  void lay_out(Arena& arena, const Model& model, const FaceDetectorLimits& limits);

  /// Draws the templates. Cost: as `find`.
  /// \return not_found when the model lacks what is needed, bad_argument for a camera or options out of range.
  Status begin(const Camera& camera, const FaceDetectorOptions& options);

  /// Looks at one frame, without regard to any before.
  /// \return not_started, bad_argument, size_mismatch; nothing has changed then. Cost: a tenth of a second
  /// of a busy PC at any size of frame, most of it in sampling the fields for the fits.
  Status find(const FrameView& frame, FaceDetectorReport* report);
  /// Of the last `find`, all of the model's; meaningful when it found the model.
  Span<const float> parameters() const { return {best_q_, parameter_count_}; }

  /// How much a frame looks like the model with pose and parameters (all of them) that somebody else found: whether a
  /// tracker is where it says. Statuses as of `find`, bad_argument also for a pose that is nearer than 50 mm or farther
  /// than 100 m. Cost: a millisecond on a PC.
  Status compare(const FrameView& frame, const Pose& pose, const float* q, float* likeness);

 private:
  struct Place {
    View view;
    float likeness;
  };
  Status look_at(const FrameView& frame);
  void align(Place& place, int round, const std::uint8_t* is_free);
  void align_roughly(const Candidate& candidate, Place* place);
  void align_fully(Place& place);

  Model model_;
  FaceDetectorLimits limits_;
  FaceDetectorOptions options_;
  Camera camera_;
  Pyramid pyramid_;
  Fitter fitter_;
  ModelPicture* picture_ = nullptr;
  PictureSearch* search_ = nullptr;
  PartSearch* parts_ = nullptr;
  Place* places_ = nullptr;
  Correspondence* pairs_ = nullptr;
  float *q_ = nullptr, *best_q_ = nullptr;
  std::uint8_t* none_free_ = nullptr;
  std::size_t parameter_count_ = 0;
  bool started_ = false;
};

}  // namespace pliant
