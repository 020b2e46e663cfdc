#pragma once
/// \file face_finder.hpp
/// Finds the faces in a picture, aligns the model with each, and verifies the alignments.
#include <optional>
#include <vector>

#include "host/io/files.hpp"
#include "host/io/image.hpp"
#include "host/io/owned.hpp"
#include "pliant/face_aligner.hpp"
#include "pliant/face_detector.hpp"

namespace pliant::host {

/// A face in a picture.
struct FoundFace {
  FaceBox box;                  ///< of the aligned model
  AlignedFace aligned;          ///< score: probability that it is a face, aligned right
  std::vector<float> q;         ///< all parameters
  std::vector<Vec2> landmarks;  ///< px, one for each landmark of the model
};

/// Probability that a face has at least, where the user names none. Round value, not tuned: rather right than wrong.
constexpr float kLeastFaceScore = 0.5f;

/// A detector and an aligner for one model. Noisy pictures are smoothed first, as a tracker does it.
class FaceFinder {
 public:
  /// Bad input: a model without learnt tables, or with damaged ones. The file must outlive this object.
  explicit FaceFinder(const ModelFile& file);

  /// The faces of a grey picture with a score of at least `min_score`, best first. Where no upright one is found the picture is
  /// searched at the other turns, where a face must be sure (FaceSearchTuning::sure_start_odds). Bad input, with the name of the
  /// picture: a larger side than kLargestFramePx.
  /// \param name      of the picture, for messages.
  /// \param camera    of the picture, if known.
  std::vector<FoundFace> find(const Image& grey, const std::string& name, float min_score,
                              const std::optional<Camera>& camera = std::nullopt);
  /// The face in a box. Nothing if the box is not in the picture.
  std::optional<FoundFace> align(const Image& grey, const FaceBox& box,
                                 const std::optional<Camera>& camera = std::nullopt);

 private:
  std::optional<FoundFace> align_in(const Image& quiet, const DetectedFace& at,
                                    const std::optional<Camera>& camera);

  const ModelFile& file_;
  Owned<FaceAligner> aligner_;
};

}  // namespace pliant::host
