#pragma once
/// \file learn_aligner.hpp
/// Training of the face aligner's table.
#include <cstdint>
#include <vector>

#include "host/learn/face_samples.hpp"
#include "host/learn/learn_options.hpp"
#include "host/learn/other_pictures.hpp"

namespace pliant::host::learn {

/// How samples for alignment differ from those for detection: more of them show drawn people, who turn further. A photograph that
/// is turned shows no nostrils and no chin from below; with fewer drawn people pitch was underestimated.
FaceSampleTuning aligner_sample_tuning();

/// Learns a table for FaceAligner (face/aligner_table.hpp): the stages one after the other, then the verification.
/// \param model   of the samples; needs the landmarks ibug17 to ibug67.
/// \param others    pictures without faces, also behind faces.
/// \param drawn     further ones that only teach the verification: screens, text, diagrams. May be empty.
/// \param detector  table of the detector whose finds are aligned; its false ones teach the verification. May be empty.
/// The bytes depend on the samples, the pictures, `seed` and `effort` alone.
std::vector<std::uint8_t> learn_aligner(const Model& model, const FaceSamples& faces,
                                        const OtherPictures& others, const OtherPictures& drawn,
                                        const std::vector<std::uint8_t>& detector,
                                        const LearnOptions& options, const LearnProgress& progress);

}  // namespace pliant::host::learn
