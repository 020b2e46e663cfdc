#include "track/kept_start.hpp"

namespace pliant {

void KeptStart::lay_out(Arena& arena, const Model& model) {
  is_free_ = arena.take_span<std::uint8_t>(model.parameters().count);
}

void KeptStart::keep(const StartOptions& from) {
  start = from;
  if (from.camera == nullptr) return;
  camera_ = *from.camera;
  start.camera = &camera_;
}

void KeptStart::keep(const TrackerOptions& from) {
  options = from;
  if (from.is_free == nullptr) return;
  for (std::size_t k = 0; k < is_free_.count; ++k) is_free_[k] = from.is_free[k];
  options.is_free = is_free_.data;
}

}  // namespace pliant
