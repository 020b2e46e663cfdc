#pragma once
/// \file ibug_curves.hpp
/// Curves of a face through its iBUG landmarks.
#include <vector>

#include "host/bake/source.hpp"

namespace pliant::host::bake {

/// Outline, brows, lids and lips; those whose landmarks are all there.
std::vector<SourceCurve> ibug_curves(const std::vector<SourceLandmark>& landmarks);

}  // namespace pliant::host::bake
