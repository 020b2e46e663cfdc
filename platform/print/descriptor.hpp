#pragma once
// Binary descriptors of corners (docs/algorithms.md, section 7.17): a direction from the patch's centre of
// brightness, and comparisons between places of the patch turned into that direction. Integers but for the
// direction.
#include <cstdint>

#include "pliant/geometry.hpp"
#include "pliant/pyramid.hpp"
#include "print/print_table.hpp"

namespace pliant {

struct Descriptor {
  Vec2 direction{1, 0};  ///< unit vector, px
  std::uint32_t bits[kDescriptorWords] = {};
};

/// How much of the image a descriptor covers.
enum class PatchScale : std::uint8_t {
  whole,  ///< 21 px
  half,   ///< 10.5 px: what `whole` would cover in the image at twice the size
};

/// Pixels around a corner that its descriptor reads, to each side.
constexpr int descriptor_reach(PatchScale scale) {
  return scale == PatchScale::whole ? 13 : 7;
}

/// Describes the patch around a whole pixel.
/// \return false, and nothing written, if the patch leaves the image or is flat. Cost: 12,000 operations.
bool describe(const ImageView& image, int x, int y, PatchScale scale, Descriptor* descriptor);

/// Number of bits that differ, 0 to 256.
int distance_of(const std::uint32_t (&a)[kDescriptorWords], const std::uint32_t (&b)[kDescriptorWords]);

}  // namespace pliant
