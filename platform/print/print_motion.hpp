#pragma once
// How a surface has moved while it was searched for (docs/algorithms.md, section 7.17).
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/fit.hpp"
#include "pliant/frame.hpp"
#include "pliant/pyramid.hpp"
#include "print/print_block.hpp"

namespace pliant {

/// Two frames, reduced.
struct SmallPictures {
  ImageView before, now;
  float scale;  ///< pixels of the frame to one of theirs
};

/// Patches all over the picture, followed from each frame to the next in thumbnails.
class SceneMotion {
 public:
  static constexpr int kPictures = 3;  ///< pairs of small pictures that a surface is found in
  /// Patches of frames of this size.
  static std::size_t patches(int width, int height);
  /// \param width, height  of the frames, px.
  void lay_out(Arena& arena, int width, int height);
  /// Takes the frame in which the patches are.
  void begin(const FrameView& frame);
  /// Takes the next frame. Cost: 7,000 operations a patch, of which there are some 100, and half an operation a pixel.
  void follow(const FrameView& frame);
  /// Where what was at x (px) of the first frame is in the last one, between the four patches around it.
  /// \return false where too few of them have been followed.
  bool moved(Vec2 x, Vec2* to) const;
  /// Standard deviation of a place, px.
  float sd_px() const;
  /// The thumbnails of the first and the last frame.
  SmallPictures pictures() const;

 private:
  /// Sizes of a thumbnail, and how the patches lie in it.
  struct Grid {
    int factor = 1, width = 0, height = 0;  // px of the frame to one of its own; pixels
    int columns = 0, rows = 0;              // of patches
    Grid() = default;
    Grid(int frame_width, int frame_height);
    std::size_t index_of(int column, int row) const {
      return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
             static_cast<std::size_t>(column);
    }
  };

  ImageView view_of(const Span<std::uint8_t>& pixels) const {
    return {pixels.data, grid_.width, grid_.height, grid_.width};
  }

  Grid grid_;
  Span<std::uint8_t> first_, pixels_[2];  // of the first thumbnail, and of the last two in turn
  Span<std::uint16_t> line_;
  std::size_t now_ = 0;  // the later one
  struct Patch {
    Vec2 moved, step;  // its place and its last motion, px of the thumbnail
    bool is_followed;
  };
  Span<Patch> patches_;
};

/// Finds where places of the surface have moved to: as the scene has; and where the later picture shows what the earlier one shows,
/// within 3 pixels of where that is expected.
/// \param before  where the surface was seen. \param expected  where it is expected.
/// \param points  room for them; those that are found are written.
/// \return their number. Cost: of up to 48 places, three projections each, and in pictures 7,000 operations and one more.
std::size_t match_scene(const SceneMotion& motion, const PrintTable& table, const SurfaceProjection& before,
                        Span<Correspondence> points);
std::size_t match_pictures(const SmallPictures& pictures, const PrintTable& table,
                           const SurfaceProjection& before, const SurfaceProjection& expected,
                           Span<Correspondence> points);

}  // namespace pliant
