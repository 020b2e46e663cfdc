#pragma once
// A personalised field: the sum that the frozen part of a cascade adds to the constant at its root, sampled on a grid over
// the chart
// (docs/algorithms.md, section 3.4).
#include "pliant/cascade.hpp"

namespace pliant {

class PersonalField {
 public:
  void lay_out(Arena& arena, const PersonalFieldLimits& limits);
  bool has_room() const { return samples_ != nullptr; }

  /// Bakes the field. `point(uv)` is the surface at (u,v) (mm); `root` is the index of the constant's field.
  /// Calls `point` twice for each sample: for the range of the differences, and for the samples.
  /// \return bad_argument when a difference is not finite or longer than 1e9 mm; the field is then as before.
  template <class SurfacePoint>
  Status fill(const Model& model, std::uint16_t root, Interpolation interpolation, const SurfacePoint& point);

  /// The baked surface at (u,v): the root, read from the model's table, and the baked difference. With `du`, also `dv`
  /// and the derivatives.
  Vec3 sample(const Model& model, Vec2 uv, Interpolation interpolation, Vec3* du, Vec3* dv) const;

 private:
  /// Smallest and largest value seen of each component.
  struct Range {
    float low[3] = {1e30f, 1e30f, 1e30f}, high[3] = {-1e30f, -1e30f, -1e30f};
    void include(Vec3 v);
  };
  Vec2 uv_of(std::size_t i, std::size_t j) const {
    return {static_cast<float>(i) / static_cast<float>(limits_.width - 1),
            static_cast<float>(j) / static_cast<float>(limits_.height - 1)};
  }
  void set_range(const Range& range);
  void set_sample(std::size_t i, std::size_t j, Vec3 difference);
  static bool is_usable(Vec3 difference) {
    return is_finite(difference) && dot(difference, difference) <= 1e18f;  // mm^2
  }

  PersonalFieldLimits limits_;
  std::int16_t* samples_ = nullptr;
  Field field_ = {};
  std::uint16_t root_ = kNone;
};

template <class SurfacePoint>
Status PersonalField::fill(const Model& model, std::uint16_t root, Interpolation interpolation,
                           const SurfacePoint& point) {
  const auto difference = [&](Vec2 uv) {
    return point(uv) - pliant::sample(model, model.fields()[root], uv, interpolation);
  };
  Range range;
  for (std::size_t j = 0; j < limits_.height; ++j)
    for (std::size_t i = 0; i < limits_.width; ++i) {
      const Vec3 d = difference(uv_of(i, j));
      if (!is_usable(d)) return Status::bad_argument;
      range.include(d);
    }
  root_ = root;
  set_range(range);
  for (std::size_t j = 0; j < limits_.height; ++j)
    for (std::size_t i = 0; i < limits_.width; ++i) set_sample(i, j, difference(uv_of(i, j)));
  return Status::ok;
}

}  // namespace pliant
