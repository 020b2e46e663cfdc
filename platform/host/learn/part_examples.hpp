#pragma once
/// \file part_examples.hpp
/// What the reading of a part learns from: crops of it, and where its points are in them.
#include <cstdint>
#include <memory>
#include <vector>

#include "face/part_reader.hpp"
#include "host/io/owned.hpp"
#include "host/learn/part_learning.hpp"
#include "host/learn/sample_random.hpp"
#include "pliant/cascade.hpp"

namespace pliant::host::learn {

/// One crop of a part; of the left side, the mirror image.
struct PartExample {
  std::shared_ptr<const Image> picture;
  CropMap map;
  bool is_mirrored = false;
  std::vector<Vec2> truth;          ///< mm from the crop's middle, as it is read
  std::vector<std::uint8_t> trust;  ///< LandmarkTrust
  int fold = 0;                     ///< the same for the same person
  std::vector<Vec2> at;             ///< where the stages so far see the points, mm
};

/// Cuts samples. Not for several threads at once.
class PartExamples {
 public:
  PartExamples(const Model& model, const PartRecord& part, const PartLearningTuning& tuning);
  /// The crops of a sample: one, or one a side.
  std::vector<PartExample> draw(FaceSample sample, SampleRandom& random);

 private:
  PartExample describe(const FaceSample& sample, bool is_left, SampleRandom& random);

  PartRecord part_;
  PartLearningTuning tuning_;
  Owned<Cascade> cascade_;
  struct Side {
    std::vector<std::uint16_t> anchors;
    std::vector<int> numbers;
    std::vector<std::uint16_t> landmarks;  // of the numbers; a pupil has any
  };
  std::vector<Side> sides_;
};

}  // namespace pliant::host::learn
