#include "vision/patch_slots.hpp"

#include <cstring>

#include "base/integers.hpp"

namespace pliant::patch {

void PatchSlots::lay_out(Arena& arena, const PatchLimits& limits) {
  constexpr std::size_t kReadAhead = 64;  // bytes past the last square that kernels may read and do not use
  limits_ = limits;
  const auto count = static_cast<std::size_t>(limits.slots);
  const auto squares = count * static_cast<std::size_t>(limits.levels);
  const std::size_t bytes = squares * square_bytes() + kReadAhead;
  levels_ = arena.take<int>(count);
  stored_ = arena.take<StoredTemplate>(squares);
  pixels_ = arena.take<std::uint8_t>(bytes);
  cached_ = limits.keeps_templates ? arena.take<CachedTemplate>(count) : nullptr;
  for (std::size_t s = 0; limits.keeps_templates && s < count; ++s) {
    const CachedTemplate cached{
        take_template(arena, limits.window), take_warp_system(arena), {}, 0, false, false};
    if (cached_ != nullptr) cached_[s] = cached;
  }
  if (pixels_ == nullptr) return;
  std::memset(pixels_, 0, bytes);
  for (std::size_t s = 0; s < count; ++s) levels_[s] = 0;
}

void PatchSlots::store(int slot, const Pyramid& pyramid, Vec2 x) {
  const int levels = smaller(limits_.levels, pyramid.levels());
  for (int l = 0; l < levels; ++l) {
    const int k = square(slot, l);
    const float scale = 1.0f / static_cast<float>(1 << l);
    store_template(pyramid.level(l), scale * x, side(), stored_[k],
                   pixels_ + static_cast<std::size_t>(k) * square_bytes());
  }
  levels_[slot] = levels;
  if (cached_ != nullptr) cached_[slot].is_made = false;
}

}  // namespace pliant::patch
