#pragma once
/// \file frame_region.hpp
/// The part of the frame in which templates are matched: its image pyramid, the previous frame's, and where both lie.
#include "pliant/coarse_translation.hpp"
#include "pliant/frame.hpp"
#include "pliant/pyramid.hpp"
#include "pliant/tracker_limits.hpp"

namespace pliant {

/// Positions are px of the frame; those in the pyramid are less by `origin`.
class FrameRegion {
 public:
  void lay_out(Arena& arena, const TrackerLimits& limits);

  /// \return bad_argument (not readable, or not planar where the frame is used in place), size_mismatch.
  Status check_frame(const FrameView& frame) const;
  /// Makes the present region the previous one, if limits keep it. To be called before `build`.
  void advance();
  /// Builds the pyramid of the region around `centre`, moved into the frame. The centre of a region that is
  /// the whole frame has no effect. A frame that is not copied must stay until matching ends.
  Status build(const FrameView& frame, Vec2 centre);

  bool is_whole_frame() const { return width_ == frame_width_ && height_ == frame_height_; }
  int width() const { return width_; }
  int height() const { return height_; }
  const Pyramid& pyramid() const { return current_; }
  Vec2 origin() const { return origin_; }
  bool keeps_previous() const { return keeps_previous_; }
  const Pyramid& previous_pyramid() const { return previous_; }
  Vec2 previous_origin() const { return previous_origin_; }
  bool contains(Vec2 x) const;
  PixelBox box() const;

 private:
  Pyramid current_, previous_;
  Vec2 origin_, previous_origin_;  // whole pixels
  int frame_width_ = 0, frame_height_ = 0, width_ = 0, height_ = 0;
  int grid_ = 1;  // px, of origins: a pixel of the coarsest level
  bool keeps_previous_ = false, copies_frame_ = false;
};

}  // namespace pliant
