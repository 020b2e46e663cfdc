#include "host/learn/learn_parts.hpp"

#include <algorithm>

#include "host/learn/part_learning.hpp"

namespace pliant::host::learn {

namespace {

/// The parts: millimetres a pixel, the crop's middle below the anchors' (mm), side of the crop, whether it is paired, numbers of
/// stages and points, anchors; cells and their side, a stage; points.
const PartRecord kParts[] = {
    // An eye: corners, lids and pupil. Two stages: a third one read people left out no better.
    {1.0f, 0, 52, 1, 2, 7, {36, 39}, 0, {{5, 4}, {5, 3}}, {36, 37, 38, 39, 40, 41, kPupilRight}, 0},
};

/// Tuning of the training of parts. Each constant: reason, experiment.
struct PartsTuning {
  int samples = 9000;  ///< pictures, count
};
constexpr PartsTuning kTuning{};

/// Larger faces than those for the aligner, eyes that close and turn more often, and less before the face: a part is read
/// where a track is good, and reads the more exactly the less it has to bear.
FaceSampleTuning sample_tuning() {
  FaceSampleTuning t;
  t.side_px = 200;
  t.box_low_px = 60;
  t.box_high_px = 140;
  t.yaw_degrees = 40;
  t.gaze_chance = 0.8f;
  t.expressions.blink_chance = 0.45f;
  t.occluders = {0.2f, 0.02f, 0.02f, 0.03f, 0.02f, 0.04f};
  t.variation = {0.7f, 0.5f, 0.3f, 0.08f, 0.5f, 1.4f, 0.05f, 0.3f, 1.0f, 0.08f, 4, 0.5f, 8, 0.25f, 0.3f};
  return t;
}

}  // namespace

std::vector<std::uint8_t> learn_parts(const Model& model, const std::vector<Photograph>& photographs,
                                      const OtherPictures& others, const LearnOptions& options,
                                      const LearnProgress& progress) {
  const FaceSamples faces(model, photographs, others, options.seed, sample_tuning());
  const auto samples = static_cast<std::size_t>(std::max(16.0, options.effort * kTuning.samples));
  std::vector<LearntPart> parts;
  for (const PartRecord& record : kParts)
    parts.push_back(learn_part(model, faces, record, options, samples, progress));
  return encode_parts(parts);
}

}  // namespace pliant::host::learn
