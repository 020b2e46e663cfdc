#pragma once
/// \file brow_search.hpp
/// Finds the brows of a fitted photograph whose annotation lacks them.
#include <vector>

#include "host/learn/photographs.hpp"

namespace pliant::host::learn {

/// Landmarks ibug17 to ibug26, each brow as a whole: the fitted one is moved, tilted and bent to where there is a dark band
/// above the eye. Empty if the model lacks them or the outer eye corners.
std::vector<AnnotatedLandmark> find_brows(const Model& model, const Photograph& fitted);

}  // namespace pliant::host::learn
