#include "host/learn/aligner_examples.hpp"

#include <cmath>

#include "face/box_view.hpp"
#include "host/io/ibug_names.hpp"

namespace pliant::host::learn {

std::vector<std::uint16_t> landmark_indices(const Model& model, const std::vector<int>& numbers) {
  std::vector<std::uint16_t> out;
  for (const int n : numbers) {
    const std::string name = ibug_name(n);
    const std::uint16_t k = model.find_landmark(name.c_str());
    if (k == kNone) fail_input("the model", "has no landmark " + name);
    out.push_back(k);
  }
  return out;
}

AlignerExamples::AlignerExamples(const Model& model, const FaceSamples& samples,
                                 const std::vector<int>& numbers, int folds, std::uint64_t seed,
                                 const AlignerStartTuning& tuning)
    : samples_(samples),
      indices_(landmark_indices(model, numbers)),
      folds_(folds),
      seed_(seed),
      tuning_(tuning),
      cascade_(model) {}

std::vector<AlignerExample> AlignerExamples::draw(std::uint64_t number, int starts) {
  FaceSample sample = samples_.draw(number);
  AlignerExample common;
  common.picture = std::make_shared<const Image>(std::move(sample.picture));
  for (const std::uint16_t k : indices_) {
    common.truth.push_back(sample.landmarks[k]);
    common.trust.push_back(sample.trust[k]);
  }
  const auto corners = landmark_indices(cascade_->model(), {36, 45});
  common.eye_distance = length(sample.landmarks[corners[0]] - sample.landmarks[corners[1]]);
  common.camera = sample.camera;
  common.fold = sample.person % folds_;
  std::vector<AlignerExample> out;
  for (int k = 0; k < starts; ++k) {
    SampleRandom random(seed_ ^ 0xa119, number * 16 + static_cast<std::uint64_t>(k));
    out.push_back(common);
    start(sample, random, &out.back());
  }
  return out;
}

void AlignerExamples::start(const FaceSample& sample, SampleRandom& random, AlignerExample* example) {
  example->q.assign(sample.q.size(), 0);
  example->is_refinement = random.chance(tuning_.pose_chance);
  if (!example->is_refinement) {
    FaceBox box = sample.box;
    box.center = box.center + (tuning_.box_shift * box.side) * Vec2{random.normal(), random.normal()};
    box.side *= std::exp(tuning_.box_log_side * random.normal());
    require(view_of_box(*cascade_, example->q.data(), box, 0, example->camera, Lens{}, &example->view),
            "landmarks");
    return;
  }
  const float turn = tuning_.pose_turn_rad, shift = tuning_.pose_shift_mm;
  const float step[kPoseUnknowns] = {turn * random.normal(),  turn * random.normal(),
                                     turn * random.normal(),  tuning_.pose_log_scale * random.normal(),
                                     shift * random.normal(), shift * random.normal()};
  example->view = moved(view_of(sample.pose, sample.camera), step, kPoseUnknowns);
  const Span<const Parameter> parameters = cascade_->model().parameters();
  const float known = random.unit();  // from the mean face to the person's own parameters
  for (std::size_t k = 0; k < parameters.count; ++k) {
    const Parameter& p = parameters[k];
    example->q[k] =
        clamp(known * sample.q[k] + tuning_.pose_parameters * random.unit() * p.sd * random.normal(),
              p.minimum, p.maximum);
  }
}

float mean_error(const AlignerExample& example, const std::vector<Vec2>& landmarks, std::uint8_t trust) {
  float sum = 0, count = 0;
  for (std::size_t k = 0; k < landmarks.size(); ++k)
    if (example.trust[k] >= trust) {
      sum += length(landmarks[k] - example.truth[k]);
      count += 1;
    }
  return count > 0 ? sum / count / example.eye_distance : -1;
}

}  // namespace pliant::host::learn
