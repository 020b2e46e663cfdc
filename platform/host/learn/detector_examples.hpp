#pragma once
/// \file detector_examples.hpp
/// Windows that the detector learns from.
#include <vector>

#include "host/learn/detector_windows.hpp"
#include "host/learn/face_samples.hpp"
#include "host/learn/learn_options.hpp"
#include "host/learn/other_pictures.hpp"

namespace pliant::host::learn {

/// Windows of one face at the places where the search may meet it.
using FaceWindows = std::vector<Window>;

/// Windows of faces.
struct FaceExamples {
  std::vector<Window> training;
  std::vector<FaceWindows> checking;  ///< of other persons: they set the thresholds
};

/// Draws `count` samples.
FaceExamples draw_faces(const FaceSamples& faces, std::size_t count, const LearnOptions& options,
                        const LearnProgress& progress);

/// Windows at random places of pictures without faces, sizes spread over octaves.
std::vector<Window> draw_others(const OtherPictures& others, std::size_t count, const LearnOptions& options);

/// Windows that the trees take for faces, at most `count`: of pictures without faces, in a random order that depends on the
/// round, and of face samples, beside the face.
std::vector<Window> find_false_hits(const std::vector<DetectorTree>& trees, const OtherPictures& others,
                                    const FaceSamples& faces, std::size_t count, std::size_t round,
                                    const LearnOptions& options, const LearnProgress& progress);

}  // namespace pliant::host::learn
