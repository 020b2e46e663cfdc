#pragma once
// Blocks: square patches of a surface as the camera sees them, and how like what is expected they look (docs/algorithms.md,
// section 7.18).
#include <cstddef>
#include <cstdint>

#include "base/integers.hpp"
#include "base/lanes.hpp"
#include "pliant/arena.hpp"
#include "pliant/geometry.hpp"
#include "print/print_table.hpp"
#include "print/print_tuning.hpp"

namespace pliant {

/// Where a surface is seen: a function with its state.
struct SurfaceProjection {
  void* state;
  bool (*project)(void* state, Vec2 uv, Vec2* x);  ///< false behind the camera
  /// Whether x (px) shows (u,v), and no other part of the surface in front of it. Null: always.
  bool (*shows)(void* state, Vec2 uv, Vec2 x) = nullptr;

  bool operator()(Vec2 uv, Vec2* x) const { return project(state, uv, x); }
};

/// A place of the surface as the camera sees it.
struct SurfacePlace {
  Vec2 uv, x;      ///< its image position, px
  Mat2 px_per_uv;  ///< dx/d(u,v)
};

/// Tuning of blocks. Chosen on the poster of `fixtures/sheet` with `pliant bench print`, and judged on two other prints
/// (docs/evaluation.md, Start by print). What other values give was not recorded, except where it is told.
struct BlockTuning {
  /// Samples of a block to each side of its middle: 7 x 7 samples. Their number fixes the cost. Not tuned.
  int half = 3;
  /// Step of the differences that give the warp of a block, (u,v).
  float step_uv = 0.01f;
  /// Area of a unit of (u,v) in the frame, at least: as a fraction of its squared longer side (a chart may be narrow), and px^2 (so
  /// that the warp has an inverse). The second is a round value, not tuned.
  float least_slant = 0.1f, least_area_px2 = 1;
  /// Standard deviation of a block's samples in a picture, at least, grey levels.
  float least_sd = 2;
  /// Correlation from which on a block agrees. Of 48 blocks at wrong places 2 % reach it.
  float least_correlation = 0.6f;
};
inline constexpr BlockTuning kBlockTuning{};

/// A block: where it is seen, and how (u,v) changes there, per px. The sample that the first order puts d px from the middle is
/// seen where the second order puts it.
struct Block {
  Vec2 uv, x;
  Mat2 uv_per_px;
  Vec2 along[2], bend[3];  // px per px, off the first order; px per px^2: x^2, y^2, xy

  Vec2 place_of(Vec2 d) const {
    return x + d + d.x * (along[0] + d.x * bend[0] + d.y * bend[2]) + d.y * (along[1] + d.y * bend[1]);
  }
};

/// \return false where the surface turns away.
bool make_block(const SurfacePlace& place, Block* block);
/// The block around (u,v). \return false where the surface turns away or is not seen. Cost: three projections.
bool find_block(const SurfaceProjection& project, Vec2 uv, Block* block);

/// The places that blocks are made around: keypoints from all over the table, each round between those of the rounds before. It
/// takes further rounds until as many places face the camera as a round has: of a closed surface less than half do.
class BlockPlaces {
 public:
  BlockPlaces(Span<const PrintKeypoint> keypoints, std::size_t blocks)
      : keypoints_(keypoints), blocks_(smaller(blocks, keypoints.count)) {
    const std::size_t most = kPrintTuning.block_rounds * blocks_;
    count_ = most < keypoints.count ? most : blocks_;
  }

  std::size_t blocks() const { return blocks_; }  ///< Places of a round.
  std::size_t count() const { return count_; }    ///< Places of all rounds.
  Vec2 operator[](std::size_t k) const {
    const std::size_t round = k / blocks_, rounds = count_ / blocks_;
    return keypoints_[(k % blocks_ * rounds + round) * keypoints_.count / count_].uv();
  }

 private:
  Span<const PrintKeypoint> keypoints_;
  std::size_t blocks_, count_;
};

constexpr int kBlockSide = 2 * kBlockTuning.half + 1, kBlockSamples = kBlockSide * kBlockSide;

/// What the samples of a block are expected to show: less their mean, each row filled up with a zero.
struct ExpectedBlock {
  static constexpr int kRow = 2 * static_cast<int>(kLanes);
  float samples[kBlockSide * kRow];
  float variance;
};
static_assert(kBlockSide == ExpectedBlock::kRow - 1);

/// Normalised cross-correlation; 0 where the frame is flat.
/// \param grey    samples of the frame. One number behind the last is read, and does not count.
/// \param stride  from one row of samples to the next.
float correlate(const float* grey, int stride, const ExpectedBlock& expected);

/// Index of the nearest of `size` pixels. \pre x is no further from them than the range of int.
inline int nearest(float x, int size) {
  return within(static_cast<int>(x + 0.5f), 0, size - 1);
}

}  // namespace pliant
