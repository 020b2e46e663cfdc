#pragma once
// Positions of many points of a surface, frame after frame of a film. Of all parameters only a few change in a film: what the
// others give is computed once. To rounding these are the positions of Cascade::selected_point.
#include <vector>

#include "aligned_block.hpp"
#include "pliant/cascade.hpp"

class MovingSurface {
 public:
  /// \param cascade  must outlive this object.
  MovingSurface(pliant::Cascade& cascade, std::vector<pliant::Vec2> uv);
  MovingSurface(const MovingSurface&) = delete;
  MovingSurface& operator=(const MovingSurface&) = delete;

  /// Of all points at these parameters, mm. Valid until the next call.
  const std::vector<pliant::Vec3>& at(const float* q);

 private:
  bool has_new_changes(const float* q);
  bool can_sample() const;
  void sample(const float* q);

  pliant::Cascade& cascade_;
  std::vector<pliant::Vec2> uv_;
  AlignedBlock block_;
  pliant::Cascade own_;                // its free parameters are those that have changed
  std::vector<std::uint8_t> changes_;  // of each parameter: whether it has changed
  std::vector<float> last_;            // parameters of the call before
  bool is_sampled_ = false;
  std::vector<pliant::Vec3> samples_, positions_;
};
