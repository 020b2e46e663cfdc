#pragma once
// Verification of a pose by the print: blocks of the frame are compared with the albedo (docs/algorithms.md,
// section 7.18).
#include "pliant/fit.hpp"
#include "pliant/frame.hpp"
#include "pliant/model.hpp"
#include "print/print_table.hpp"

namespace pliant {

/// Where a surface is seen: a function with its state.
struct SurfaceProjection {
  void* state;
  bool (*project)(void* state, Vec2 uv, Vec2* x);  ///< false behind the camera

  bool operator()(Vec2 uv, Vec2* x) const { return project(state, uv, x); }
};

/// Blocks of the surface with texture that face the camera inside the frame, and how many of those look like
/// the albedo.
struct PrintAgreement {
  int visible = 0, agreed = 0;
};

/// Compares blocks around the table's keypoints. A block that does not agree is compared again where the second order of the
/// surface puts its samples; it is not counted where the surface bends away. \param block_px  spacing of the 7 x 7 samples
/// of a block, px. Cost: 48 blocks, three projections and 900 samples each; eight and 1,350 where it is compared again.
PrintAgreement compare_print(const FrameView& frame, const Model& model, const PrintTable& table,
                             const SurfaceProjection& projection, float block_px);

/// A place of the surface as the camera sees it.
struct SurfacePlace {
  Vec2 uv, x;      ///< its image position, px
  Mat2 px_per_uv;  ///< dx/d(u,v)
};

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
