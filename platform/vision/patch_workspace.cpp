#include "vision/patch_workspace.hpp"

#include <cstring>

#include "vision/patch_warp_system.hpp"

namespace pliant::patch {

namespace {

i16* take_cleared(Arena& arena, int elements) {
  const auto n = static_cast<std::size_t>(elements);
  i16* array = arena.take<i16>(n);
  if (array != nullptr) std::memset(array, 0, n * sizeof(i16));
  return array;
}

}  // namespace

Template take_template(Arena& arena, int window) {
  const auto cleared = [&] { return take_cleared(arena, padded(window)); };
  return {cleared(), cleared(), cleared(), cleared()};
}

WarpSystem* take_warp_system(Arena& arena) {
  void* const room = arena.take<WarpSystem>(1);
  return room == nullptr ? nullptr : new (room) WarpSystem();
}

void Workspace::lay_out(Arena& arena, int window_side) {
  PLIANT_ASSERT(is_window(window_side));
  window = window_side;
  count = padded(window);
  const auto cleared = [&](int elements) { return take_cleared(arena, elements); };
  own_template = active = take_template(arena, window);
  x = cleared(count);
  y = cleared(count);
  for (auto& array : ramp) array = cleared(count);
  for (auto& array : stretch) array = cleared(count);
  for (auto& array : masked) array = cleared(count);
  unclipped = cleared(count);
  image = cleared(count);
  all = cleared(count);
  part = cleared(count);
  block = cleared(block_size(window));
  scratch = cleared(scratch_size(window));
  bytes = arena.take<std::uint8_t>(static_cast<std::size_t>(block_size(window)));
  own_system = system = take_warp_system(arena);
  unclipped_system = take_warp_system(arena);
  has_system = false;
  ramp_sd = 0;
  residual_warp = {0, 0, 0, 0};
  if (all == nullptr) return;
  for (int k = 0; k < window * window; ++k) {
    all[k] = 1;
    x[k] = narrow(k % window - window / 2);
    y[k] = narrow(k / window - window / 2);
  }
}

}  // namespace pliant::patch
