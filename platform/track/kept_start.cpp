#include "track/kept_start.hpp"

#include "base/arrays.hpp"

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
  copy(from.is_free, is_free_.count, is_free_.data);
  options.is_free = is_free_.data;
}

}  // namespace pliant
