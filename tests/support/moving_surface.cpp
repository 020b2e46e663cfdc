#include "moving_surface.hpp"

#include <algorithm>
#include <utility>

using namespace pliant;

namespace {

/// Samples for more parameters would take more memory and time than they save.
constexpr std::ptrdiff_t kMostChanging = 24;

}  // namespace

MovingSurface::MovingSurface(Cascade& cascade, std::vector<Vec2> uv)
    : cascade_(cascade),
      uv_(std::move(uv)),
      block_(measured_bytes<Cascade>(cascade.model())),
      changes_(cascade.parameter_count(), 0),
      positions_(uv_.size()) {
  Arena arena(block_.data(), block_.size());
  if (create_in(arena, own_, cascade.model()) != Status::ok) changes_.assign(kMostChanging + 1, 1);
}

/// Whether this is the first call, or a parameter has changed that had not until now.
bool MovingSurface::has_new_changes(const float* q) {
  const bool is_first = last_.empty();
  const std::vector<float> now(q, q + cascade_.parameter_count());
  bool is_new = is_first;
  for (std::size_t k = 0; !is_first && k < now.size(); ++k) {
    if (changes_[k] != 0 || now[k] == last_[k]) continue;
    changes_[k] = 1;
    is_new = true;
  }
  last_ = now;
  return is_new;
}

bool MovingSurface::can_sample() const {
  return std::count(changes_.begin(), changes_.end(), 1) <= kMostChanging && !cascade_.is_personalised() &&
         cascade_.interpolation() == Interpolation::bilinear;
}

void MovingSurface::sample(const float* q) {
  own_.set_free(changes_.data());
  const std::size_t stride = own_.samples_per_point();
  samples_.resize(uv_.size() * stride);
  for (std::size_t i = 0; i < uv_.size(); ++i) own_.sample_point(uv_[i], q, samples_.data() + i * stride);
  is_sampled_ = true;
}

const std::vector<Vec3>& MovingSurface::at(const float* q) {
  if (has_new_changes(q) || !can_sample()) {
    is_sampled_ = false;
    cascade_.select(q);
    for (std::size_t i = 0; i < uv_.size(); ++i) positions_[i] = cascade_.selected_point(uv_[i]);
    return positions_;
  }
  if (!is_sampled_) sample(q);
  const std::size_t stride = own_.samples_per_point();
  for (std::size_t i = 0; i < uv_.size(); ++i) positions_[i] = own_.evaluate(samples_.data() + i * stride, q);
  return positions_;
}
