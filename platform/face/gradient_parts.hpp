#pragma once
// A gradient as the sum of one vector along an axis and one along a diagonal: (dx, dy) = (dx - dy) (1, 0) + dy (1, 1) for
// 0 <= dy <= dx, and the same in the other octants.

namespace pliant {

/// sqrt(2) * 128: (1, 1) as a multiple of the diagonal's unit vector.
constexpr unsigned kDiagonalGain = 181;

}  // namespace pliant
