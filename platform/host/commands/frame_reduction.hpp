#pragma once
/// \file frame_reduction.hpp
/// Frames in which a face is larger than a tracker's templates are made for, reduced by a whole number.
#include "host/io/image.hpp"
#include "pliant/camera.hpp"
#include "pliant/frame.hpp"
#include "pliant/geometry.hpp"

namespace pliant::host {

class FrameReduction {
 public:
  explicit FrameReduction(int factor = 1) : factor_(factor) {}
  /// By how much frames of this size have to be reduced for a face that they show at this scale.
  static int factor_for(float px_per_mm, ImageSize size);
  /// The factor with which the largest face that fits into frames of this size can be tracked.
  static int factor_for(ImageSize size);

  int factor() const { return factor_; }
  ImageSize reduced(ImageSize size) const { return {size.width / factor_, size.height / factor_}; }
  /// The frame, each pixel the mean of factor x factor; what is left at the right and at the bottom is cut off. Valid until the
  /// next call, and with a factor of 1 as long as the frame is.
  FrameView reduced(const FrameView& frame);
  /// The camera that sees the reduced frames.
  Camera reduced(const Camera& camera) const;
  /// A place of the whole frame in the reduced one, and back, px.
  Vec2 reduced(Vec2 x) const;
  Vec2 whole(Vec2 x) const;

 private:
  int factor_;
  Image image_;  // the last frame
};

}  // namespace pliant::host
