#pragma once
/// \file landmark_names.hpp
/// The landmark names that the library asks for (docs/model-format.md), and names that are nearly one of them.
#include <string>
#include <vector>

#include "host/bake/source.hpp"

namespace pliant::host::bake {

/// A line for each landmark whose name is probably meant for one that the library asks for, which is found by its exact name only:
/// it differs in capitals, in the characters between words or in zeros of its number (`ibug1` for `ibug01`), or its number is none
/// of 00 to 67. Other names are a model's own.
std::vector<std::string> misspelt_landmarks(const Source& source);

}  // namespace pliant::host::bake
