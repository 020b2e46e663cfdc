#pragma once
/// \file patch_tracker.hpp
/// The patch tracker: stores patches of an image as templates and finds them again in another image.
///
/// The search is pyramidal and inverse compositional (Baker and Matthews 2004; docs/algorithms.md, section 7.2). It
/// solves for a translation. Gain and bias of the light are projected out. Rotation, scale and shear are given, as a
/// warp of 2 x 2 entries. Pixel arithmetic is in integers: the bits are the same on every target. Matching one frame
/// with the next (`track_between`) is optical flow at a point: of rank two at a corner and, if edges are accepted, of
/// rank one at an edge (section 7.5).
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/geometry.hpp"
#include "pliant/pyramid.hpp"
#include "pliant/status.hpp"

namespace pliant {

namespace patch {
struct SearchState;
}

/// Whether a template was found, or why not.
enum class PatchStatus : std::uint8_t {
  ok = 0,
  bad_argument = 1,     ///< NaN, no such slot, or a pyramid that was never built
  empty_slot = 2,       ///< the slot holds no template
  outside_image = 3,    ///< part of the window lies, or went, outside the image
  flat = 4,             ///< too little texture in one direction, or too few pixels that are not clipped
  diverged = 5,         ///< no convergence, or a result farther than max_move_px from the start
  low_correlation = 6,  ///< the correlation with the template is below min_correlation
  bad_light = 7,        ///< gain outside 0.2 to 5, or a bias beyond 80 grey levels
  inconsistent = 8,     ///< tracking back does not return to the start
};

/// A short English text without a final stop. Never null.
const char* text(PatchStatus status);

/// Capacities. Bytes: slots * patch_slot_bytes, and 10 kB (window 11) to 29 kB (window 21) of work space.
struct PatchLimits {
  int slots = 64;   ///< templates, 0 to 16384; `track_between` needs none
  int window = 13;  ///< side of the compared square, odd, 7 to 21 px
  int levels = 3;   ///< 1 to Pyramid::kMaxLevels
  /// Template margin: pixels stored around the window, 0 to 16, so that a rotated or stretched window still finds its
  /// corners. Pixels that leave it are not compared.
  int margin = 4;
  /// True: each slot keeps its warped template at full size and its equations until the predicted warp has moved the
  /// window's edge by another half pixel. A search then takes a third less time where the warp changes slowly, for
  /// 1.7 kB more a slot (window 11). Results differ by less than their own deviation.
  bool keeps_templates = false;
};

/// Bytes of one slot that keeps no template: 1,639 with the default limits. 486 with a window of 11, two levels and a
/// margin of 1, which is enough where a window turns by less than 15 degrees between capture and search.
constexpr int patch_slot_bytes(const PatchLimits& l) {
  const int side = l.window + 2 + 2 * l.margin;
  return l.levels * (side * side + 16) + 4;
}

struct NormalFlow;
/// Normal flow: the motion of an edge across itself. A program that does not name it does not link it.
extern const NormalFlow kNormalFlow;

/// How to search, and which results to accept.
struct PatchOptions {
  int first_level = -1;  ///< level that the search starts on, 0 is full size; -1: chosen by start_sd_px
  /// Standard deviation of the start, px along either axis. Coarse levels that such a start does not need are
  /// skipped; up to half a pixel, only the refinement at full size is done. 0: unknown, all levels are searched.
  float start_sd_px = 0;
  float max_move_px = 0;  ///< largest distance of the result from the start; 0: no limit
  /// Smallest normalised cross-correlation with the template, -1 to 1. Round value, not tuned. The tracker
  /// sets its own.
  float min_correlation = 0.8f;
  /// Standard deviation of a ramp of light over the window, grey levels a px: the light changed more on one side than on
  /// the other, as where a curved surface turns. The last steps, at full size, allow for it. 0: it changed alike.
  float ramp_sd = 0;
  /// &kNormalFlow: a patch with texture in one direction only is tracked along it (rank one). Null: it is `flat`.
  const NormalFlow* normal_flow = nullptr;
  float max_return_px = 0;  ///< largest forward-backward distance of `track_between`; 0: not checked
};

/// One match. Unless the search converged at full size, only status, x and iterations are set.
struct PatchResult {
  PatchStatus status = PatchStatus::bad_argument;  ///< ok, or why there is none
  /// Found position in the current image, px; the start if status is not ok. Where a search back was made, what the one
  /// forward has found, whatever the status.
  Vec2 x;
  Sym2 information;          ///< inverse covariance of x, 1/px^2; of rank one along the gradient of an edge
  int rank = 0;              ///< of the information: 2, or 1 for an edge
  float correlation = 0;     ///< normalised cross-correlation with the template, -1 to 1
  float gain = 1, bias = 0;  ///< current = gain * template + bias, grey levels
  float residual = 0;        ///< rms that gain, bias and a small warp leave, grey levels
  float return_px = 0;       ///< forward-backward distance, if it was checked
  int iterations = 0;        ///< over all levels
};

/// Templates in slots, and the search for them. All memory in the arena. Not copyable.
class PatchTracker {
 public:
  PatchTracker() = default;
  PatchTracker(const PatchTracker&) = delete;
  PatchTracker& operator=(const PatchTracker&) = delete;

  /// Makes all slots, empty. \return `bad_argument` for limits out of range, `out_of_memory`; then nothing has changed.
  Status create(Arena& arena, const PatchLimits& limits);
  /// The same without checks; with an arena that measures, only its bytes are counted. Precondition: limits in range.
  void lay_out(Arena& arena, const PatchLimits& limits);

  const PatchLimits& limits() const { return limits_; }  ///< Limits of the layout.

  /// Stores the surroundings of x (px of level 0, sub-pixel) on each level as the slot's template.
  /// \return `outside_image` if the window leaves the image, `flat`, `bad_argument`; then the slot is as it was.
  PatchStatus capture(int slot, const Pyramid& pyramid, Vec2 x, const PatchOptions& options = {});
  /// Empties the slot, if there is such a slot.
  void release(int slot);
  bool is_captured(int slot) const;  ///< True where the slot holds a template.

  /// Finds the slot's template in `current`, from `start` (px of level 0).
  /// \param warp  displacement in the current image = warp * displacement in the template (J_cur J_ref^-1).
  ///         `bad_argument` if it mirrors, is not finite, has an entry beyond 4, or changes areas by more than 16.
  /// Cost: about 2 us a point on a desktop core (window 13, 3 levels), 1 us more where the template is resampled.
  PatchResult track(int slot, const Pyramid& current, Vec2 start, const Mat2& warp = {},
                    const PatchOptions& options = {});

  /// Finds the patch around `x` of `previous` in `current`, from `start`. With max_return_px, tracks it back as well:
  /// the status is `inconsistent` if that ends farther from x.
  PatchResult track_between(const Pyramid& previous, Vec2 x, const Pyramid& current, Vec2 start,
                            const PatchOptions& options = {});

 private:
  PatchLimits limits_{0, 0, 0, 0};
  patch::SearchState* state_ = nullptr;  // in the arena
};

}  // namespace pliant
