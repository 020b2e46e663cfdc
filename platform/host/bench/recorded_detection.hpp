#pragma once
/// \file recorded_detection.hpp
/// Starts by detection within an annotated film.
#include <string>

#include "host/bench/detection_report.hpp"
#include "host/io/files.hpp"

namespace pliant::host {

/// Starts a tracker at every hundredth frame, without points: how many are right within 10 frames, and the landmark error
/// of the 200 frames after these. \param truth  frame,landmark,x,y of the film's frames.
void measure_recorded_film(const ModelFile& file, const std::string& film, const std::string& truth,
                           DetectionReport& report);

}  // namespace pliant::host
