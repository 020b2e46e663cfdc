#pragma once
/// \file stretch_prior.hpp
/// The prior of surfaces that bend and do not stretch (docs/algorithms.md, section 5.8).

namespace pliant {

struct StretchPrior;
/// Springs of the model's table as rows of tracking, by name, so that programs that do not use them do not
/// link them.
extern const StretchPrior kStretchPrior;

/// The same limits without springs.
template <class Limits>
constexpr Limits without_stretch(Limits limits) {
  limits.stretch = nullptr;
  return limits;
}

}  // namespace pliant
