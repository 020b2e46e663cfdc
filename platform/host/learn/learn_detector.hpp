#pragma once
/// \file learn_detector.hpp
/// Training of the face detector's table.
#include <cstdint>
#include <vector>

#include "host/learn/face_samples.hpp"
#include "host/learn/learn_options.hpp"
#include "host/learn/other_pictures.hpp"

namespace pliant::host::learn {

/// Learns a table for FaceDetector (face/detector_table.hpp): boosted trees, in rounds; before each round the trees so far search
/// the pictures without faces, and what they take for a face is added to the examples.
/// \param faces   every sample has a face box; those of one person in `kCheckedPersons` only set the thresholds.
/// \param others  at least one picture, without faces.
/// The bytes depend on the samples, the pictures, `seed` and `effort` alone.
std::vector<std::uint8_t> learn_detector(const FaceSamples& faces, const OtherPictures& others,
                                         const LearnOptions& options, const LearnProgress& progress);

/// Of so many persons, one does not train the trees but sets the rejection thresholds.
constexpr int kCheckedPersons = 6;

}  // namespace pliant::host::learn
