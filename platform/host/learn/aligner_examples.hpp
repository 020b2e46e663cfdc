#pragma once
/// \file aligner_examples.hpp
/// What alignment learns from: pictures of faces, the truth, and where the alignment starts.
#include <cstdint>
#include <memory>
#include <vector>

#include "face/aligner_pass.hpp"
#include "host/io/image.hpp"
#include "host/io/owned.hpp"
#include "host/learn/face_samples.hpp"
#include "host/learn/sample_random.hpp"

namespace pliant::host::learn {

/// Errors of starts. Chosen to cover what a detector's boxes, fits of five points and poses of earlier frames err by.
struct AlignerStartTuning {
  float box_shift = 0.08f;       ///< standard deviation of a box's centre, fraction of its side
  float box_log_side = 0.10f;    ///< standard deviation of the logarithm of a box's side
  float pose_chance = 0.3f;      ///< starts from a pose near the truth
  float pose_turn_rad = 0.10f;   ///< standard deviation about each axis
  float pose_log_scale = 0.05f;  ///< standard deviation of the logarithm of the scale
  float pose_shift_mm = 4;       ///< standard deviation along each axis of the picture, mm
  float pose_parameters = 0.5f;  ///< of each parameter, in its own deviations
};

/// One face and a start.
struct AlignerExample {
  std::shared_ptr<const Image> picture;
  std::vector<Vec2> truth;          ///< px, a landmark of the table
  std::vector<std::uint8_t> trust;  ///< LandmarkTrust
  float eye_distance = 0;           ///< px: of the outer eye corners
  Camera camera;
  int fold = 0;                ///< the same for the same person
  bool is_refinement = false;  ///< starts from a pose
  View view;                   ///< now
  std::vector<float> q;        ///< now
};

/// A pass with its memory.
using OwnedPass = Owned<AlignerPass>;

/// Names ibugNN of these numbers that the model has; the index in the model of each.
std::vector<std::uint16_t> landmark_indices(const Model& model, const std::vector<int>& numbers);

/// Example `index`: sample `index / starts`, start `index % starts`. `starts` examples of one sample share its picture.
class AlignerExamples {
 public:
  AlignerExamples(const Model& model, const FaceSamples& samples, const std::vector<int>& numbers, int folds,
                  std::uint64_t seed, const AlignerStartTuning& tuning = {});
  /// The `starts` examples of a sample. Not for several threads at once.
  std::vector<AlignerExample> draw(std::uint64_t sample, int starts);

 private:
  void start(const FaceSample& sample, SampleRandom& random, AlignerExample* example);

  const FaceSamples& samples_;
  std::vector<std::uint16_t> indices_;
  int folds_;
  std::uint64_t seed_;
  AlignerStartTuning tuning_;
  Owned<Cascade> cascade_;
};

/// Mean distance of landmarks from the truth over the eyes' distance; of those with at least this trust. Negative: none.
float mean_error(const AlignerExample& example, const std::vector<Vec2>& landmarks, std::uint8_t trust);

}  // namespace pliant::host::learn
