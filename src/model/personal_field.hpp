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

  std::size_t width() const { return limits_.width; }  ///< samples
  std::size_t height() const { return limits_.height; }
  /// Of sample (i, j).
  Vec2 uv_of(std::size_t i, std::size_t j) const {
    return {static_cast<float>(i) / static_cast<float>(limits_.width - 1),
            static_cast<float>(j) / static_cast<float>(limits_.height - 1)};
  }

  /// Fills the field. `differences(i, j, out)` writes the differences to the root at the samples (i, j) to (i + out.count - 1, j),
  /// mm; it is called twice for each, for the range of the differences and for the samples. With `largest`, no component of
  /// which is exceeded on either side of zero, it is called once. `root` is the index of the root's field.
  /// \return bad_argument when a difference is not finite or longer than 1e9 mm; the field is then as before.
  template <class Differences>
  Status fill(std::uint16_t root, const Differences& differences, const Vec3* largest = nullptr) {
    const auto compute = [](const void* state, std::size_t i, std::size_t j, Span<Vec3> out) {
      (*static_cast<const Differences*>(state))(i, j, out);
    };
    return fill(root, largest, compute, &differences);
  }

  /// The personalised surface at (u,v): the root, read from the model's table, and the stored difference. With `du`, also `dv`
  /// and the derivatives.
  Vec3 sample(const Model& model, Vec2 uv, Interpolation interpolation, Vec3* du, Vec3* dv) const;

  /// Starts to fetch what `sample` will read.
  void announce(const Model& model, Vec2 uv) const;

 private:
  /// Smallest and largest value seen of each component.
  struct Range {
    float low[3] = {1e30f, 1e30f, 1e30f}, high[3] = {-1e30f, -1e30f, -1e30f};
    void include(Vec3 v);
  };
  using Compute = void (*)(const void* state, std::size_t i, std::size_t j, Span<Vec3> out);
  /// One function for all kinds of differences: code is scarce on microcontrollers.
  Status fill(std::uint16_t root, const Vec3* largest, Compute compute, const void* state);
  void set_range(const Range& range);
  void set_samples(std::size_t i, std::size_t j, Span<const Vec3> differences);
  static bool is_usable(Vec3 difference) {
    return is_finite(difference) && dot(difference, difference) <= 1e18f;  // mm^2
  }

  PersonalFieldLimits limits_;
  std::int16_t* samples_ = nullptr;
  Field field_ = {};
  std::uint16_t root_ = kNone;
};

}  // namespace pliant
