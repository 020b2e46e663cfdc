#include "face/box_selection.hpp"

#include "face/face_detector_tuning.hpp"
#include "pliant/geometry.hpp"

namespace pliant {

namespace {

float shared_area(const FaceBox& a, const FaceBox& b) {
  const auto shared = [](float a_middle, float a_side, float b_middle, float b_side) {
    const float low = max(a_middle - 0.5f * a_side, b_middle - 0.5f * b_side),
                high = min(a_middle + 0.5f * a_side, b_middle + 0.5f * b_side);
    return max(high - low, 0);
  };
  return shared(a.center.x, a.side, b.center.x, b.side) * shared(a.center.y, a.side, b.center.y, b.side);
}

// The area that two boxes share as a fraction of the smaller one: 1 for an eye within a face.
float shared_fraction(const FaceBox& a, const FaceBox& b) {
  const float side = min(a.side, b.side);
  return side > 0 ? shared_area(a, b) / (side * side) : 0;
}

}  // namespace

float overlap(const FaceBox& a, const FaceBox& b) {
  const float both = shared_area(a, b), all = a.side * a.side + b.side * b.side - both;
  return all > 0 ? both / all : 0;
}

void BoxHits::lay_out(Arena& arena, int capacity) {
  hits_ = arena.take<BoxHit>(static_cast<std::size_t>(capacity));
  capacity_ = capacity;
  count_ = 0;
}

void BoxHits::add(const BoxHit& hit) {
  if (count_ < capacity_) {
    hits_[count_++] = hit;
    return;
  }
  int lowest = 0;
  for (int k = 1; k < count_; ++k)
    if (hits_[k].sum < hits_[lowest].sum) lowest = k;
  if (hits_[lowest].sum < hit.sum) hits_[lowest] = hit;
}

BoxHit BoxHits::take_best(int least_sum) {
  PLIANT_ASSERT(count_ > 0);
  int best = 0;
  for (int k = 1; k < count_; ++k)
    if (hits_[k].sum > hits_[best].sum) best = k;
  const BoxHit first = hits_[best];
  Vec2 center;
  float side = 0, weights = 0;
  int kept = 0;
  for (int k = 0; k < count_; ++k) {
    const BoxHit hit = hits_[k];
    if (overlap(first.box, hit.box) >= kFaceDetectorTuning.averaged_overlap) {
      // Smaller boxes have more windows. By the side, not by the area: on the held-out portraits that gives the least bias.
      const float weight = hit.box.side / first.box.side *
                           (static_cast<float>(hit.sum > least_sum ? hit.sum - least_sum : 0) + 1);
      center = center + weight * hit.box.center;
      side += weight * hit.box.side;
      weights += weight;
    }
    if (shared_fraction(first.box, hit.box) < kFaceDetectorTuning.same_face_fraction) hits_[kept++] = hit;
  }
  count_ = kept;
  const float by = 1 / weights;
  return {{by * center, by * side}, first.sum};
}

}  // namespace pliant
