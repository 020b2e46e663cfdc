#pragma once
// Gradients packed into 16 bits each, and their sums over the cells of a block, by direction.
#include <cstdint>

namespace pliant {

constexpr int kBlockChannels = 8;   // directions, bytes a cell of a block
constexpr int kMostBlockCells = 8;  // a side of a block
constexpr int kMostBlockCellPx = 8;

// A packed gradient: from the top, whether dx < 0, dy < 0 and |dy| > |dx|, a bit each; then its parts (gradient_parts.hpp). Both
// are cut off, so that an edge of hair or glasses does not outweigh the face.
constexpr int kAxisBits = 7, kDiagonalBits = 6;
constexpr int kPartBits = kAxisBits + kDiagonalBits;
constexpr int kMostAxis = (1 << kAxisBits) - 1, kMostDiagonal = (1 << kDiagonalBits) - 1;

/// Gradients that sum_block may read beyond the last one of a block.
constexpr int kReadBeyondBlock = 7;

/// Gradient sums of a block of cells x cells cells, kBlockChannels each: direction d is d * 45 degrees from +x towards +y.
/// \param first    the packed gradient of its first pixel. \param stride  from row to row.
/// \param cells    1 to kMostBlockCells. \param cell_px  side of a cell, 1 to kMostBlockCellPx.
void sum_block(const std::uint16_t* first, int stride, int cells, int cell_px, std::uint16_t* sums);

}  // namespace pliant
