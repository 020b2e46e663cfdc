#include "host/learn/part_examples.hpp"

#include "host/learn/aligner_examples.hpp"

namespace pliant::host::learn {

PartExamples::PartExamples(const Model& model, const PartRecord& part, const PartLearningTuning& tuning)
    : part_(part), tuning_(tuning), cascade_(model) {
  for (int left = 0; left <= part.is_paired; ++left) {
    const auto of_side = [&](int number) { return left != 0 ? mirrored_part_point(number) : number; };
    Side side;
    side.anchors = landmark_indices(model, {of_side(part.anchor[0]), of_side(part.anchor[1])});
    for (std::size_t k = 0; k < part.point_count; ++k) {
      const int number = of_side(part.number[k]);
      side.numbers.push_back(number);
      side.landmarks.push_back(landmark_indices(model, {number < kPupilRight ? number : 0})[0]);
    }
    sides_.push_back(std::move(side));
  }
}

std::vector<PartExample> PartExamples::draw(FaceSample sample, SampleRandom& random) {
  std::vector<PartExample> out;
  for (std::size_t side = 0; side < sides_.size(); ++side) out.push_back(describe(sample, side == 1, random));
  const auto picture = std::make_shared<const Image>(std::move(sample.picture));
  for (PartExample& example : out) example.picture = picture;
  return out;
}

PartExample PartExamples::describe(const FaceSample& sample, bool is_left, SampleRandom& random) {
  const Side& side = sides_[is_left ? 1 : 0];
  const float turn = tuning_.turn_rad, shift = tuning_.shift_mm;
  const float step[kPoseUnknowns] = {turn * random.normal(),  turn * random.normal(),
                                     turn * random.normal(),  tuning_.log_scale * random.normal(),
                                     shift * random.normal(), shift * random.normal()};
  const View view = moved(view_of(sample.pose, sample.camera), step, kPoseUnknowns);
  Vec2 middle;
  for (const std::uint16_t k : side.anchors) {
    const Landmark& l = cascade_->model().landmarks()[k];
    Vec2 x = view.c;
    Projector(view, true).project(cascade_->surface_point(l.uv(), sample.q.data()), &x);
    middle = middle + 0.5f * x;
  }
  PartExample out;
  out.map = crop_of_part(part_, view, middle);
  out.is_mirrored = is_left;
  out.fold = sample.person % tuning_.folds;
  const float half = 0.5f * static_cast<float>(part_.crop_px - 1);
  for (std::size_t k = 0; k < side.numbers.size(); ++k) {
    const int pupil = side.numbers[k] - kPupilRight;
    const std::uint16_t landmark = side.landmarks[k];
    const Vec2 x = pupil >= 0 ? sample.pupils.x[pupil] : sample.landmarks[landmark];
    const Vec2 mm = part_.mm_per_px * (out.map.to_crop(x) - Vec2{half, half});
    out.truth.push_back({is_left ? -mm.x : mm.x, mm.y});
    out.trust.push_back(pupil >= 0 ? sample.pupils.trust[pupil] : sample.trust[landmark]);
  }
  return out;
}

}  // namespace pliant::host::learn
