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

  /// Bakes the field. `compute(i, j, out)` writes the differences to the root at the samples (i, j) to (i + out.count - 1, j),
  /// mm; it is called twice for each, for the range of the differences and for the samples. `root` is the index of the root's
  /// field. \return bad_argument when a difference is not finite or longer than 1e9 mm; the field is then as before.
  template <class Differences>
  Status fill(std::uint16_t root, const Differences& compute);
  /// The same where the largest component of the differences is known: calls `compute` once for each.
  template <class Differences>
  Status fill(std::uint16_t root, Vec3 largest, const Differences& compute);

  /// The baked surface at (u,v): the root, read from the model's table, and the baked difference. With `du`, also `dv`
  /// and the derivatives.
  Vec3 sample(const Model& model, Vec2 uv, Interpolation interpolation, Vec3* du, Vec3* dv) const;

 private:
  /// Smallest and largest value seen of each component.
  struct Range {
    float low[3] = {1e30f, 1e30f, 1e30f}, high[3] = {-1e30f, -1e30f, -1e30f};
    void include(Vec3 v);
  };
  /// Calls visit(i, j, difference) for all samples, until it returns false.
  template <class Differences, class Visit>
  bool visit_all(const Differences& compute, const Visit& visit) const;
  template <class Differences>
  void fill(std::uint16_t root, const Range& range, const Differences& compute);
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

template <class Differences, class Visit>
bool PersonalField::visit_all(const Differences& compute, const Visit& visit) const {
  constexpr std::size_t kTogether = 32;
  Vec3 some[kTogether];
  for (std::size_t j = 0; j < limits_.height; ++j)
    for (std::size_t first = 0; first < limits_.width; first += kTogether) {
      const std::size_t left = limits_.width - first, count = left < kTogether ? left : kTogether;
      compute(first, j, Span<Vec3>{some, count});
      for (std::size_t k = 0; k < count; ++k)
        if (!visit(first + k, j, some[k])) return false;
    }
  return true;
}

template <class Differences>
Status PersonalField::fill(std::uint16_t root, const Differences& compute) {
  Range range;
  const bool is_good = visit_all(compute, [&](std::size_t, std::size_t, Vec3 d) {
    range.include(d);
    return is_usable(d);
  });
  if (!is_good) return Status::bad_argument;
  fill(root, range, compute);
  return Status::ok;
}

template <class Differences>
Status PersonalField::fill(std::uint16_t root, Vec3 largest, const Differences& compute) {
  if (!is_usable(largest)) return Status::bad_argument;
  Range range;
  range.include(largest);
  range.include(-1 * largest);
  fill(root, range, compute);
  return Status::ok;
}

template <class Differences>
void PersonalField::fill(std::uint16_t root, const Range& range, const Differences& compute) {
  root_ = root;
  set_range(range);
  visit_all(compute, [&](std::size_t i, std::size_t j, Vec3 d) {
    set_sample(i, j, d);
    return true;
  });
}

}  // namespace pliant
