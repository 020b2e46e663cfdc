#pragma once
/// \file landmark_offsets.hpp
/// Per-person displacement of each landmark from the model's position (surface_offset.hpp).
#include <cstddef>

#include "pliant/estimator.hpp"
#include "pliant/fit.hpp"

namespace pliant {

/// An offset (mm, model's axes) for each landmark of the model. Landmarks with the same (u,v) have the same offset.
class LandmarkOffsets {
 public:
  void lay_out(Arena& arena, const Model& model);

  /// Sets all offsets to 0.
  void clear();
  /// Sets all offsets; `offsets` has `values().count` of them.
  void set(Span<const Vec3> offsets);
  Span<const Vec3> values() const { return values_; }

  /// Sets the offset of the landmarks at `uv` so that they project to x (px) in the estimator's view. Their
  /// offsets stay as they were if the surface point is behind the camera.
  void place(Vec2 uv, Vec2 x, Estimator& estimator);
  /// The same in two steps, for a fit that ends before the estimator starts. `set_pending` stores image
  /// positions; `place_pending` replaces them by offsets from the tracked surface. A personalised field may
  /// differ a little from the surface that was fitted.
  void set_pending(Span<const Correspondence> places, const Model& model);
  void place_pending(Estimator& estimator);
  /// The same for an alignment: image positions of all landmarks, px. Those named ibugNN are stored, also for others at their
  /// (u,v).
  void set_pending(Span<const Vec2> places, const Model& model);

  /// Image position (px) of landmark k at the estimator's state; false behind the camera.
  bool project(std::size_t k, Estimator& estimator, Vec2* x) const;

  /// Image positions (px) of all landmarks in a view, at the estimator's parameters; kNowhere behind the camera.
  void project_all(const View& view, Estimator& estimator, Vec2* x) const;
  /// Changes the offsets so that the landmarks are at x again after the parameters have changed. Only their part across the view
  /// changes; the part along it, which comes from other views, stays. \param moved  out: by how much, mm, model's axes.
  void keep_all(const View& view, Estimator& estimator, const Vec2* x, Vec3* moved);

 private:
  Span<Vec3> values_;
};

}  // namespace pliant
