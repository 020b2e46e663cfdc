#pragma once
/// \file patch_tracker.hpp
/// The patch tracker: where has the small piece of picture around a point gone, how well is that known, and
/// is it still the same piece?
///
/// Pyramidal, inverse compositional (Baker and Matthews 2004): translation is solved for, a gain and a bias
/// of the light are projected out, and the change of shape (rotation, scale, shear) comes predicted, as a 2 x
/// 2 warp. Kernels are integers; the bits are the same on every target. Between two pictures (`track_between`
/// with `takes_edges`) it is optical flow at a point: of rank two at a corner, one at an edge, none elsewhere.
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/geometry.hpp"
#include "pliant/pyramid.hpp"
#include "pliant/status.hpp"

namespace pliant {

namespace patch {
struct Anchor;
struct Surround;
struct Work;
struct Position;
struct SearchOptions;
struct Measurement;
struct Kept;
}  // namespace patch

/// Why a patch was found, or not.
enum class PatchStatus : std::uint8_t {
  ok = 0,
  bad_argument = 1,     ///< NaN, no such slot, or a pyramid that was never built
  empty_slot = 2,       ///< nothing was captured in this slot
  outside_image = 3,    ///< part of the window lies, or went, outside the picture
  flat = 4,             ///< too little texture in one direction, or too few pixels that are not clipped
  diverged = 5,         ///< moved farther than allowed at the finest level
  low_correlation = 6,  ///< ended somewhere that does not look like the template
  bad_light = 7,        ///< gain or bias outside their range
  inconsistent = 8,     ///< tracked back from where it was found, it does not return
};

/// A short English sentence without a final stop. Never null.
const char* text(PatchStatus status);

/// Capacities. Bytes: slots * patch_slot_bytes, and 9 kB (window 11) to 25 kB (window 21) of work space.
struct PatchLimits {
  int slots = 64;   ///< 0 is allowed: `track_between` needs none
  int window = 13;  ///< side of the compared square, odd, 7 to 21 px
  int levels = 3;   ///< 1 to Pyramid::kMaxLevels
  /// Pixels stored around the window, so that a rotated or stretched window still finds its corners; 0 to 16.
  /// What falls outside is left out of the comparison.
  int margin = 4;
  /// Keeps of each slot the warped template at full size, and the equations that follow from it, until the predicted
  /// warp moves the window's edge by half a pixel more (by a tenth, where warp_sd is 0): searches then take a third
  /// less time where the warp changes slowly, for 1.6 kB more a slot (window 11). Results differ by less than their own
  /// deviation.
  bool keeps_templates = false;
};

/// Bytes of one slot that keeps no template: 1,647 as above; 494 with a window of 11, two levels and a margin of 1,
/// which is enough where windows turn by less than 15 degrees between capture and search.
constexpr int patch_slot_bytes(const PatchLimits& l) {
  const int side = l.window + 2 + 2 * l.margin;
  return l.levels * (side * side + 16) + 12;
}

/// How to search and what to accept. The defaults suit faces at 320 x 240.
struct PatchOptions {
  int first_level = -1;  ///< where the search starts, 0 is full size; -1: as start_sd_px says
  /// Standard deviation of the start, px, as far as it is known: coarse levels are left out that are not needed to find a
  /// point so near, and up to half a pixel all of the search but its last steps. 0: unknown, all levels are searched.
  float start_sd_px = 0;
  int max_iterations = 10;   ///< on each level, at least 1
  float epsilon_px = 0.01f;  ///< how close to its end the search is brought, at full size
  /// Standard deviation of the entries of a warp that was not predicted, which the last steps allow for. 0:
  /// none is allowed for; a tenth to a fifth more precise, and faster by a third, where the prediction is
  /// exact; many times less precise where not.
  float warp_sd = 0.03f;
  float max_move_px = 0;         ///< from the start, in the end; 0: no limit
  float min_correlation = 0.8f;  ///< normalised cross-correlation with the template
  float min_eigenvalue = 0.5f;   ///< of the mean structure tensor, light projected out, (grey/px)^2
  /// A patch with texture in one direction only, or nothing but noise in the other, is followed along that one: normal
  /// flow, of rank one. min_eigenvalue then holds for the larger one. False: it is `flat`.
  bool takes_edges = false;
  float min_gain = 0.5f, max_gain = 2.0f;
  float max_bias = 80.0f;           ///< magnitude, grey levels
  float max_return_px = 0;          ///< forward-backward check of `track_between`; 0: not done
  bool masks_clipped = true;        ///< leaves out pixels <= 5 and >= 250
  float noise_floor_grey = 1.0f;    ///< the residual counts as at least this, in the information
  float position_floor_px = 0.02f;  ///< standard deviation that no result claims to be better than
};

/// One search. Everything but status, x and iterations is zero unless the search came to an end at full size.
struct PatchResult {
  PatchStatus status = PatchStatus::bad_argument;
  Vec2 x;                    ///< found position in the current picture; the start when the search failed
  Sym2 information;          ///< inverse covariance of x, 1/px^2; of rank one along the gradient of an edge
  int rank = 0;              ///< of the information: 2, or 1 for an edge
  float correlation = 0;     ///< NCC with the template (for a slot: with the patch first captured), -1 to 1
  float gain = 1, bias = 0;  ///< current = gain * template + bias, grey levels
  float residual = 0;        ///< rms of what light and an allowed warp leave, grey levels
  float return_px = 0;       ///< forward-backward distance, if it was asked for
  int iterations = 0;        ///< over all levels
};

/// Slots of captured patches, and the search for them. All memory in the arena. Not copyable.
class PatchTracker {
 public:
  PatchTracker() = default;
  PatchTracker(const PatchTracker&) = delete;
  PatchTracker& operator=(const PatchTracker&) = delete;

  /// `bad_argument` for limits out of range, `out_of_memory`; then nothing has changed. All slots are empty.
  Status create(Arena& arena, const PatchLimits& limits);
  void lay_out(Arena& arena, const PatchLimits& limits);

  const PatchLimits& limits() const { return limits_; }

  /// Stores the surroundings of x (pixels of level 0, sub-pixel) on every level as the anchor of `slot`. The
  /// whole window must lie inside the picture and have texture: otherwise outside_image or flat, and the slot
  /// is as it was.
  PatchStatus capture(int slot, const Pyramid& pyramid, Vec2 x, const PatchOptions& options = {});
  /// Empties the slot.
  void release(int slot);
  bool is_captured(int slot) const;
  /// Where the slot's patch was captured.
  Vec2 anchor(int slot) const;

  /// Finds the slot's anchor patch in `current`, from `start`.
  /// \param warp  displacement in the current picture = warp * displacement in the anchor's (J_cur J_ref^-1).
  ///              One that shrinks or stretches by more than 4, mirrors, or is not finite is a bad_argument.
  /// Cost: about 2 us a point on a desktop core (window 13, 3 levels), 1 us more where the template is
  /// warped.
  PatchResult track(int slot, const Pyramid& current, Vec2 start, const Mat2& warp = {},
                    const PatchOptions& options = {});

  /// Finds what is around `x` in `previous` again in `current`, from `start`. With max_return_px, also tracks
  /// back and compares.
  PatchResult track_between(const Pyramid& previous, Vec2 x, const Pyramid& current, Vec2 start,
                            const PatchOptions& options = {});

 private:
  struct Source;

  bool is_slot(int slot) const { return slot >= 0 && slot < limits_.slots; }
  Vec2 load_template(const Source& source, int level, const PatchOptions& options);
  PatchResult search(const Source& source, const Pyramid& current, Vec2 start, const PatchOptions& options);
  PatchStatus measure(const ImageView& image, patch::SearchOptions search, bool is_near,
                      const PatchOptions& options, patch::Position& p, patch::Measurement& measured);

  PatchLimits limits_{0, 0, 0, 0};
  patch::Anchor* anchors_ = nullptr;      // one a slot
  patch::Kept* kept_ = nullptr;           // one a slot, or none
  patch::Surround* surrounds_ = nullptr;  // one a slot and level
  std::uint8_t* pixels_ = nullptr;        // of the surrounds, in the same order
  patch::Work* work_ = nullptr;           // what one search needs
};

}  // namespace pliant
