#pragma once
/// \file landmark_offsets.hpp
/// Where this person has the model's landmarks: an offset from the model's place for each (surface_offset.hpp).
#include <cstddef>

#include "pliant/estimator.hpp"
#include "pliant/fit.hpp"

namespace pliant {

/// One offset (mm, model's axes) a landmark of the model. Landmarks with the same (u,v) have the same offset.
class LandmarkOffsets {
 public:
  void lay_out(Arena& arena, const Model& model);

  /// Every landmark is where the model has it.
  void clear();
  /// Sets all offsets; `offsets` has `values().count` of them.
  void set(Span<const Vec3> offsets);
  Span<const Vec3> values() const { return values_; }

  /// Sets the offset of the landmarks at `uv` so that they are seen at x (px) in the estimator's view; none is set where
  /// the surface is behind the camera.
  void place(Vec2 uv, Vec2 x, Estimator& estimator);
  /// The same in two steps, for a fit that ends before the estimator starts: until `place_pending` the offsets hold image
  /// positions. Offsets are from the surface that is tracked, which a personalised field may change a little.
  void set_pending(Span<const Correspondence> places, const Model& model);
  void place_pending(Estimator& estimator);

  /// Image position (px) of landmark k at the estimator's state; false behind the camera.
  bool project(std::size_t k, Estimator& estimator, Vec2* x) const;

 private:
  Span<Vec3> values_;
};

}  // namespace pliant
