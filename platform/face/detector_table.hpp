#pragma once
// The learnt table of the face detector: boosted trees over gradient cells with a rejection threshold after
// each tree (a soft cascade). Little-endian, read in place, from flash.
#include <cstdint>

#include "face/gradient_cells.hpp"
#include "pliant/arena.hpp"
#include "pliant/status.hpp"

namespace pliant {

constexpr int kWindowCells = 12;    ///< cells a side of the detector's window
constexpr int kDetectorCellPx = 4;  ///< pixels a side of a cell, in the frame reduced to the window's scale
constexpr int kDetectorReach = 1;   ///< cells around a cell that it is normalised with, to each side
/// Comparisons on the way to a leaf. At one false hit in 50 frames, depth 3 finds 88 % of varied samples of
/// held-out people, depth 2 85 % (trees of the same size in all).
constexpr int kTreeDepth = 3;
constexpr int kTreeNodes = (1 << kTreeDepth) - 1, kTreeLeaves = 1 << kTreeDepth;  ///< of a tree

/// Side of the window, px.
constexpr int kWindowPx = kWindowCells * kDetectorCellPx;

/// One tree. Node k leads to node 2 k + 1 where the feature's value is below the threshold, else to node 2 k
/// + 2; behind the last level the leaves follow.
struct DetectorTree {
  std::uint16_t feature[kTreeNodes];  ///< 256 * row of the cell + kCellChannels * column + channel
  std::uint8_t threshold[kTreeNodes];
  std::int8_t leaf[kTreeLeaves];  ///< added to the window's sum
  std::uint8_t reserved;          ///< 0
  std::int16_t rejection;         ///< a window whose sum is below this after the tree is not a face
};

/// Trees of a table: what 72 KiB hold. It bounds the time of a window.
constexpr int kMostTrees = 2048;

/// Points of a broken line.
constexpr int kScoreKnots = 8;

/// First bytes of a table.
struct DetectorHeader {
  std::uint32_t magic;        ///< kDetectorMagic
  std::uint32_t total_bytes;  ///< of the table
  std::uint32_t crc32;        ///< IEEE CRC-32 of everything behind this field
  std::uint16_t tree_count;   ///< 1 to kMostTrees
  std::uint16_t tree_depth;   ///< kTreeDepth
  /// Probability of a face at a sum of all trees: a broken line through these points, sums strictly ascending,
  /// probabilities ascending, in 1/65535. Constant beyond the ends.
  std::int16_t knot_sum[kScoreKnots];
  std::uint16_t knot_probability[kScoreKnots];
};

constexpr std::uint32_t kDetectorMagic = 0x31444c50;  ///< "PLD1"

/// The feature in channel `channel` of the cell in `row` and `column` of a window.
constexpr std::uint16_t detector_feature(int row, int column, int channel) {
  return static_cast<std::uint16_t>(256 * row + kCellChannels * column + channel);
}

/// A checked view of a table, which must outlive it.
class DetectorTable {
 public:
  /// Checks all of it. \return `not_found` (no bytes), `misaligned` (not a multiple of 4), `truncated`, `bad_magic`,
  ///   `bad_checksum`, `bad_table`; `table` is then as before.
  static Status open(Span<const std::uint8_t> bytes, DetectorTable* table);

  bool is_open() const { return header_ != nullptr; }
  Span<const DetectorTree> trees() const { return trees_; }
  /// Probability of a face, 0 to 1, where no tree rejects a window of this sum. Precondition: is_open.
  float probability(int sum) const;

 private:
  const DetectorHeader* header_ = nullptr;
  Span<const DetectorTree> trees_;
};

/// The sum of all trees for a window of cells, or `kRejected`.
/// \param cells   channels of the window's first cell; cells of a row follow one another.
/// \param stride  bytes from one row of cells to the next.
int sum_of_trees(Span<const DetectorTree> trees, const std::uint8_t* cells, int stride);

constexpr int kRejected = -0x7fffffff;  ///< below every sum

}  // namespace pliant
