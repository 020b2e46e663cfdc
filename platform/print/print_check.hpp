#pragma once
// Verification of a pose by the print: blocks of the frame are compared with the albedo (docs/algorithms.md,
// section 7.18).
#include "pliant/cascade.hpp"
#include "pliant/fit.hpp"
#include "pliant/frame.hpp"
#include "pliant/model.hpp"
#include "print/print_block.hpp"

namespace pliant {

/// Blocks of the surface with texture that face the camera inside the frame, and how many of those look like
/// the albedo.
struct PrintAgreement {
  int visible = 0, agreed = 0;
  int agreed_once = 0;  ///< of the visible ones: now, or in an earlier comparison with the same history
  int outside = 0;      ///< of the first round of places: they face the camera beyond the frame
};

/// The blocks that have agreed since a track began.
class PrintHistory {
 public:
  void clear() { *this = {}; }
  bool has(std::size_t block) const { return (bits_[block / 32] >> block % 32 & 1) != 0; }
  void add(std::size_t block) { bits_[block / 32] |= std::uint32_t{1} << block % 32; }
  /// Of the first round of places, which are all over the surface.
  int first_round_count() const;

 private:
  static constexpr std::size_t kBlocks = kPrintTuning.blocks * kPrintTuning.block_rounds;
  std::uint32_t bits_[(kBlocks + 31) / 32] = {};
};

/// Compares blocks around the table's keypoints. A block that does not agree is compared again where the second order of the
/// surface puts its samples; it is not counted where the surface bends away, or where another part of it is in front.
/// \param block_px  spacing of the 7 x 7 samples of a block, px.
/// \param history   takes the blocks that agree. Null: none.
/// Cost: 48 blocks, three projections and 900 samples each; eight and 1,350 where it is compared again, and five `shows` where it
/// does not agree then.
PrintAgreement compare_print(const FrameView& frame, const Model& model, const PrintTable& table,
                             const SurfaceProjection& projection, float block_px,
                             PrintHistory* history = nullptr);

/// How many of the first round of places face a camera while the surface is at rest.
struct FacingAtRest {
  int in_view = 0;  ///< this camera
  int most = 0;     ///< one camera, at most: all of a flat sheet, less than half of a can
  int places = 0;   ///< all
};

/// Cost: 48 places are sampled, and 2,304 products. 0.6 kB of stack.
/// \param q  all parameters, at rest.
FacingAtRest facing_at_rest(const PrintTable& table, Cascade& cascade, const float* q, const Pose& pose);

/// Compares the block around one place.
/// \return true if it looks like the albedo, or if it cannot be compared: it turns away, or is not all in the frame.
///   False if the albedo has no texture there.
bool shows_print(const FrameView& frame, const Model& model, const SurfacePlace& place, float block_px);

/// Finds blocks near where they are expected, up to two samples away, to a fraction of a sample.
/// \param points  room for them, one block each; those that are found are written.
/// \return their number. Cost: 8,000 operations a block.
std::size_t match_blocks(const FrameView& frame, const Model& model, const PrintTable& table,
                         const SurfaceProjection& projection, float block_px, Span<Correspondence> points);

}  // namespace pliant
