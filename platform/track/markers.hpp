#pragma once
/// \file markers.hpp
/// Image points that go with the surface and are never observed.
#include <cstddef>
#include <cstdint>

#include "pliant/estimator.hpp"

namespace pliant {

/// Where a marker is on the surface, for another start.
struct MarkerPlace {
  Vec2 uv;
  Vec3 offset;  ///< mm
};

/// Each marker is a surface point of the estimator and an offset from it (surface_offset.hpp).
class Markers {
 public:
  void lay_out(Arena& arena, std::size_t capacity);

  /// Casts image positions (px) of the present view onto the posed mesh. Earlier markers are removed.
  /// \param x             finite. \param exclusion_px  for `are_far_from`.
  /// \return bad_argument (nothing visible), capacity, and the statuses of Estimator::add_point.
  Status place(Estimator& estimator, Span<const Vec2> x, float exclusion_px);
  /// Writes where the markers are. \pre room for the capacity. \return how many there are.
  std::size_t save(const Estimator& estimator, MarkerPlace* places) const;
  /// Puts markers there again, after a start without. \pre count <= capacity.
  void restore(Estimator& estimator, const MarkerPlace* places, std::size_t count);
  /// As LandmarkOffsets::project_all and keep_all. \pre room for the capacity.
  void project_all(const View& view, Estimator& estimator, Vec2* x) const;
  void keep_all(const View& view, Estimator& estimator, const Vec2* x);
  /// Image position of marker k, px. False for k beyond the markers placed, and behind the camera.
  bool position(std::size_t k, Estimator& estimator, Vec2* x) const;
  std::size_t count() const { return count_; }
  /// Whether every marker is behind the camera or farther than exclusion_px from x.
  bool are_far_from(Vec2 x, Estimator& estimator) const;

 private:
  std::uint16_t* ids_ = nullptr;
  Vec3* offsets_ = nullptr;  // mm
  std::size_t capacity_ = 0, count_ = 0;
  float exclusion_px_ = 0;
};

}  // namespace pliant
