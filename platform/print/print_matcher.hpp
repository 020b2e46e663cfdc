#pragma once
// Corners of a frame, and the keypoints of a print that they look like (docs/algorithms.md, section 7.17).
#include <cstddef>
#include <cstdint>

#include "pliant/arena.hpp"
#include "pliant/pyramid.hpp"
#include "print/descriptor.hpp"
#include "print/print_motion.hpp"
#include "print/print_table.hpp"

namespace pliant {

/// A corner of the frame.
struct FrameCorner {
  Vec2 x;       ///< px of the frame
  float scale;  ///< pixels of the frame to a pixel of the print
  Descriptor descriptor;
};

/// A corner and the keypoint that it looks like.
struct PrintMatch {
  std::uint16_t corner, keypoint;
};

/// Which of a frame's corners are matched: the strongest of all, or the strongest of each part of the frame. A dull print in front
/// of a sharp background has few of the former, a small one has few of the latter.
enum class CornerChoice : std::uint8_t { strongest, spread };

/// Finds corners and matches of a frame, in parts of bounded work.
class PrintMatcher {
 public:
  /// \param width, height  of the frames, px.
  void lay_out(Arena& arena, const PrintTable& table, int width, int height);

  bool is_idle() const { return !is_searching_; }
  /// Takes a frame, which is copied.
  Status begin(const FrameView& frame, CornerChoice choice);
  /// Does the next part; after the last one the matcher is idle. \return its cost, cells (TrackerLimits::search_work).
  std::uint32_t step();
  static std::size_t most_matches();

  /// The frame whose corners were found: a copy.
  const ImageView& searched() const { return pyramid_.level(0); }
  /// Takes a later frame of the same size instead of it. \return both at a quarter of their size, until the next `begin`.
  SmallPictures move_on(const FrameView& now);

  Span<const FrameCorner> corners() const { return {corners_.data, corner_count_}; }
  Span<const PrintMatch> matches() const { return {matches_.data, match_count_}; }
  const PrintTable& table() const { return table_; }

 private:
  std::uint32_t find_corners_of(int level);
  void add_corner(const ImageView& image, Vec2 x, PatchScale patch, float to_frame);
  void match(std::size_t corner);

  PrintTable table_;
  Pyramid pyramid_;
  Span<unsigned char> scratch_;
  Span<FrameCorner> corners_;
  Span<PrintMatch> matches_;
  std::size_t corner_count_ = 0, match_count_ = 0;
  std::size_t next_corner_ = 0;
  CornerChoice choice_ = CornerChoice::strongest;
  int next_level_ = 0;
  bool is_searching_ = false;
};

}  // namespace pliant
