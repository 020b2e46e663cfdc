#pragma once
/// \file aligner_evidence.hpp
/// Alignments as verification sees them: of faces, right and wrong, and of pictures without faces.
#include <array>
#include <functional>

#include "host/learn/aligner_cascade.hpp"
#include "host/learn/aligner_check.hpp"
#include "host/learn/other_pictures.hpp"

namespace pliant::host::learn {

/// One alignment as the check sees it.
struct Evidence {
  std::vector<std::uint8_t> blocks;  // of all landmarks
  std::vector<std::uint8_t> mirrored_blocks;
  std::vector<float> weights;  // a landmark
  float gate = 0.5f;
  float displacement = 0, parameters = 0;
  float error = 0;  // of the landmarks; 1 where there is no face
  int half = 0;     // examples of one half are scored by weights learnt from the other; of no face, by number, not by picture
  double appearance = 0, text = 0;
  std::array<double, kFaceParts> part{};         // of the appearance, each part's
  std::array<double, kFaceParts> part_weight{};  // of the weights
  bool is_face = true;
  bool is_moved = false;  // a pose moved away from where the alignment ended
};

/// Collects the evidence of alignments.
class EvidenceCollector {
 public:
  /// \param cascade  after its last stage; each example is aligned by what was learnt without its fold.
  EvidenceCollector(AlignerCascade& cascade, const AlignerCheckTuning& tuning);

  /// Alignments of faces, and poses moved away from them.
  std::vector<Evidence> of_faces();
  /// Alignments at random places of pictures without faces, numbers first to first + count - 1: those that are wanted.
  std::vector<Evidence> of_others(const OtherPictures& others, std::size_t first, std::size_t count,
                                  const std::function<bool(const Evidence&)>& is_wanted);
  /// Alignments of what a detector finds in pictures without faces.
  std::vector<Evidence> of_found(const OtherPictures& others, const std::vector<std::uint8_t>& detector,
                                 std::size_t searches);

 private:
  FaceBox moved_box(FaceBox box, SampleRandom& random) const;
  View moved_view(const View& view, const AlignerExample& example, SampleRandom& random) const;
  Evidence align_other(const Image& picture, const FaceBox& box, std::size_t number, std::size_t thread);
  Evidence collect(AlignerPass& pass, int fold);

  AlignerCascade& cascade_;
  AlignerCheckTuning tuning_;
  std::vector<std::unique_ptr<OpenAlignerTable>> tables_;
};

}  // namespace pliant::host::learn
