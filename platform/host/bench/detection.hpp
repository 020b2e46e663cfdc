#pragma once
/// \file detection.hpp
/// How well faces are found, aligned and found again, on pictures with annotated landmarks.
#include <optional>
#include <ostream>
#include <string>

#include "host/io/files.hpp"

namespace pliant::host {

/// Inputs of bench_detection. Each is optional.
struct DetectionInputs {
  std::optional<std::string>
      portraits;  ///< folder of photographs with landmarks.csv; those held out of training are used
  std::optional<std::string> others;       ///< folder of photographs without faces
  std::optional<std::string> film, truth;  ///< a film, and frame,landmark,x,y of its frames
  std::optional<std::string> details;      ///< file to write: a row a picture or start
  int count = 1000000;                     ///< pictures of each folder that are used, at most
};

/// Portraits: found and aligned in a still picture; found, aligned and tracked in a film of two seconds with drift and
/// noise; started from five points; face that vanishes and returns elsewhere at half and at twice the size; track pushed
/// onto the background. Photographs without faces: false starts in two seconds. Film: starts at every hundredth frame, and
/// the 200 frames after each. Times of the search of a frame and of an alignment.
void bench_detection(std::ostream& out, const ModelFile& file, const DetectionInputs& inputs);

}  // namespace pliant::host
