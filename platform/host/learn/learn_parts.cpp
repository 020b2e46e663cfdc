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
  /// Pictures that are drawn, count. Round value, not tuned.
  int samples = 9000;
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
  // Glasses about as often as for the aligner: eyes are read through them. What hides the face is rarer. Not tuned.
  t.occluders.glasses_chance = 0.2f;
  t.occluders.mask_chance = 0.02f;
  t.occluders.hand_chance = 0.02f;
  t.occluders.hair_chance = 0.03f;
  t.occluders.bar_chance = 0.02f;
  t.occluders.moustache_chance = 0.04f;
  // Light, blur, noise and compression are weaker and rarer than for the aligner, most by a third to a half. Not tuned.
  t.variation.gamma_octaves = 0.7f;
  t.variation.side_light_chance = 0.5f;
  t.variation.darkest_side = 0.3f;
  t.variation.hard_shadow_chance = 0.08f;
  t.variation.gain_low = 0.5f;
  t.variation.gain_high = 1.4f;
  t.variation.low_contrast_chance = 0.05f;
  t.variation.blur_chance = 0.3f;
  t.variation.blur_px = 1.0f;
  t.variation.motion_chance = 0.08f;
  t.variation.motion_px = 4;
  t.variation.noise_chance = 0.5f;
  t.variation.noise_grey = 8;
  t.variation.noise_contrast = 0.25f;
  t.variation.blocks_chance = 0.3f;
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
