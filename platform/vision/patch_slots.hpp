#pragma once
// The templates that a patch tracker has captured.
#include "pliant/patch_tracker.hpp"
#include "vision/patch_template.hpp"

namespace pliant::patch {

/// A slot's template at full size with its equations, kept from search to search while it serves.
struct CachedTemplate {
  Template images;
  WarpSystem* system;
  Mat2 warp;  ///< that it was resampled by
  float ramp_sd;  ///< that its equations allow for
  bool accepts_edges, is_made;
};

/// Slots of stored templates, a square of pixels for each slot and level.
class PatchSlots {
 public:
  void lay_out(Arena& arena, const PatchLimits& limits);

  bool is_slot(int slot) const { return slot >= 0 && slot < limits_.slots; }
  bool is_captured(int slot) const { return is_slot(slot) && levels_[slot] > 0; }
  /// Stored levels, 0 for an empty slot. Precondition: is_slot.
  int levels(int slot) const {
    PLIANT_ASSERT(is_slot(slot));
    return levels_[slot];
  }

  /// Stores the surroundings of x (px of level 0) on each level.
  void store(int slot, const Pyramid& pyramid, Vec2 x);
  /// Empties the slot. Precondition: is_slot.
  void release(int slot) {
    PLIANT_ASSERT(is_slot(slot));
    levels_[slot] = 0;
  }

  /// A stored level. Precondition: level < levels(slot).
  const StoredTemplate& stored(int slot, int level) const { return stored_[square(slot, level)]; }
  const std::uint8_t* pixels(int slot, int level) const {
    return pixels_ + static_cast<std::size_t>(square(slot, level)) * square_bytes();
  }
  int side() const { return stored_side(limits_); }
  /// Null if the limits keep no templates.
  CachedTemplate* cached(int slot) const { return cached_ != nullptr ? cached_ + slot : nullptr; }

 private:
  int square(int slot, int level) const {
    PLIANT_ASSERT(is_slot(slot) && level >= 0 && level < limits_.levels);
    return slot * limits_.levels + level;
  }
  std::size_t square_bytes() const {
    return static_cast<std::size_t>(side()) * static_cast<std::size_t>(side());
  }

  PatchLimits limits_{0, 0, 0, 0};
  int* levels_ = nullptr;  // stored, of each slot; 0: empty
  CachedTemplate* cached_ = nullptr;
  StoredTemplate* stored_ = nullptr;  // of each slot and level
  std::uint8_t* pixels_ = nullptr;    // of the stored templates, in the same order
};

}  // namespace pliant::patch
