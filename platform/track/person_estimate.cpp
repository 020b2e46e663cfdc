#include "track/person_estimate.hpp"

namespace pliant {

namespace {
constexpr const PersonEstimateTuning& kTuning = kPersonEstimateTuning;
}

void PersonEstimate::lay_out(Arena& arena, std::size_t unknowns) {
  unknowns_ = unknowns;
  means_ = arena.take<float>(kViews * stride());
}

void PersonEstimate::clear() {
  for (std::size_t& frames : frames_) frames = 0;
  for (std::size_t k = 0; k < kViews * stride(); ++k) means_[k] = 0;
}

std::size_t PersonEstimate::view_towards(Vec3 camera) {
  const float across = square_root(camera.x * camera.x + camera.z * camera.z);
  std::size_t beside = 0;
  while (beside < 4 && magnitude(camera.x) > kTuning.yaw_sines[beside] * across) ++beside;
  return camera.x < 0 ? 4 - beside : 4 + beside;
}

void PersonEstimate::add(std::size_t view, PersonEquations& frame, const float* now) {
  PLIANT_ASSERT(view < kViews && frame.count() >= unknowns_);
  const std::size_t first = frame.count() - unknowns_;
  frame.count_from_zero(first, now);
  if (frames_[view] < kTuning.most_frames) ++frames_[view];
  const float rate = 1.0f / static_cast<float>(frames_[view]);
  float* to = means_ + view * stride();
  for (std::size_t i = 0; i < unknowns_; ++i)
    for (std::size_t j = i; j < unknowns_; ++j, ++to) *to += rate * (frame.h(first + i, first + j) - *to);
  for (std::size_t i = 0; i < unknowns_; ++i, ++to) *to += rate * (frame.g(first + i) - *to);
}

bool PersonEstimate::is_usable() const {
  int views = 0;
  for (const std::size_t frames : frames_) views += frames > 0;
  return views >= kTuning.least_views;
}

bool PersonEstimate::solve(const float* start, const float* sd, PersonEquations& equations, float* x) const {
  PLIANT_ASSERT(equations.count() >= unknowns_);
  const std::size_t first = equations.count() - unknowns_;
  for (std::size_t v = 0; v < kViews; ++v) {
    if (frames_[v] == 0) continue;
    const float* from = means_ + v * stride();
    for (std::size_t i = 0; i < unknowns_; ++i)
      for (std::size_t j = i; j < unknowns_; ++j) equations.h(first + i, first + j) += *from++;
    for (std::size_t i = 0; i < unknowns_; ++i) equations.g(first + i) += *from++;
  }
  for (std::size_t i = 0; i < unknowns_; ++i) {
    const float deviation = i < 3 ? kTuning.turn_sd : sd[i - 3];
    equations.add_prior(first + i, i < 3 ? 0.0f : start[i - 3], 1.0f / (deviation * deviation));
  }
  return equations.solve(first, x);
}

}  // namespace pliant
