#pragma once
/// \file template_store.hpp
/// Templates of surface points: captured in a key frame, matched, released.
#include <cstddef>
#include <cstdint>

#include "pliant/estimator.hpp"
#include "pliant/patch_tracker.hpp"
#include "pliant/tracker_limits.hpp"
#include "track/frame_region.hpp"
#include "track/key_frames.hpp"

namespace pliant {

constexpr std::uint16_t kNoSlot = 0xFFFF;
constexpr float kBendUnits = 32;  ///< of Template::bend, a mm: up to 4 mm

/// One template. The first template of a surface point also holds where the point was found in the last frame.
struct Template {
  std::uint16_t id = 0;            ///< of the surface point
  std::uint16_t first = 0;         ///< slot of the point's first template: its own, or it is a second one
  std::uint16_t second = kNoSlot;  ///< of a first template: slot of the second one
  std::uint8_t frames_apart = 0;   ///< frames since a template of the point was matched
  bool is_used = false, was_found = false;
  /// How far the surface in the window lies behind the tangent plane, mm / kBendUnits along the camera's axis: the
  /// means over a square window of its parts xx, xy and yy.
  std::int8_t bend[3] = {};
  Mat2 reference;         ///< dx/d(u,v) in the frame of capture
  Vec2 found_at;          ///< px, in the last frame
  Vec2 residual;          ///< px, measured minus projected after the last solve
  float correlation = 1;  ///< with the template, in the last frame
};

/// Decides whether a template may be captured. Without a function, every one may.
struct TemplateCheck {
  void* state = nullptr;
  /// \param seen  of the surface point (u,v), in the frame whose image the region has.
  bool (*accepts)(void* state, const FrameRegion& region, Vec2 uv, const Prediction& seen) = nullptr;
};

/// Slots of templates. A slot holds one template; which key frame it belongs to is the caller's choice. All
/// memory is in the arena.
class TemplateStore {
 public:
  void lay_out(Arena& arena, const TrackerLimits& limits);
  /// Asks `check` before each capture from now on. What its state points to must stay.
  void set_check(TemplateCheck check) { check_ = check; }
  /// Empties all slots.
  void clear();

  std::size_t count() const { return count_; }
  Template& operator[](std::size_t slot) { return templates_[slot]; }
  const Template& operator[](std::size_t slot) const { return templates_[slot]; }
  /// Whether the slot holds the first template of a point.
  bool is_first(std::size_t slot) const { return templates_[slot].is_used && templates_[slot].first == slot; }

  /// Templates in use in the first slots without a gap, count: all that a start has captured. \param most  slots that are counted.
  std::size_t count_first(std::size_t most) const {
    std::size_t used = 0;
    while (used < most && templates_[used].is_used) ++used;
    return used;
  }

  /// The key frame that a slot belongs to.
  std::size_t key_of(std::size_t slot) const;

  /// Adds the visible surface point at image position x (px) to the estimator, and captures its template in a
  /// free slot.
  /// \param uv  of the mesh under x.
  /// \return false, and nothing has changed, where the surface turns away, or without texture.
  bool capture(std::size_t slot, Estimator& estimator, const FrameRegion& region, Vec2 x, Vec2 uv);
  /// Captures second templates, at the places found, of points in the slots below `points` that were found in
  /// this frame but look different from their template. Fills the free slots [first, end).
  /// \return the first slot that is still free.
  std::size_t capture_second(std::size_t points, std::size_t first, std::size_t end, Estimator& estimator,
                             const FrameRegion& region);
  /// Empties a slot. With the first template of a point its second one and the point itself go as well.
  void release(std::size_t slot, Estimator& estimator);

  /// Searches the region for the point whose first template is in `slot`, from `start` (px), by the template
  /// that has to be warped less. The result is where the point is: of the window's place in the frame, what the
  /// surface's bend moves it by is taken off. \param depths  of this frame. Positions of the result are those of
  /// the region's pyramid.
  PatchResult match(std::size_t slot, const FrameRegion& region, Vec2 start, const Mat2& jacobian,
                    const KeyDepths& depths, PatchOptions options);
  /// Searches the region for what the previous region shows at x (px).
  PatchResult match_from_previous(Vec2 x, const FrameRegion& region, Vec2 start, const PatchOptions& options);

 private:
  Template captured(std::uint16_t id, std::size_t first, const Prediction& seen, Estimator& estimator) const;
  float depth(const Template& t, const Mat2& to_template) const;

  PatchTracker patches_;
  TemplateCheck check_;
  Template* templates_ = nullptr;
  // Of limits: at most 16384 slots, windows of 21 px and margins of 16.
  std::uint16_t count_ = 0, of_frame_0_ = 0, of_key_ = 1;  // slots
  std::uint8_t window_px_ = 0, side_px_ = 0;               // of a template; with its margin
};

/// Largest entry of W - I, where W is the warp from `reference` to `now`.
float strain(const Mat2& now, const Mat2& reference);

}  // namespace pliant
