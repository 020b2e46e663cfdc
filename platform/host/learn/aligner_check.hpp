#pragma once
/// \file aligner_check.hpp
/// Learns verification: how probably an alignment is right, and how large its error is.
#include "host/learn/aligner_cascade.hpp"
#include "host/learn/other_pictures.hpp"

namespace pliant::host::learn {

/// Tuning of the learning of verification. Each constant: unit, reason, experiment.
struct AlignerCheckTuning {
  float right_error =
      0.06f;  ///< mean error of landmarks over the eyes' distance below which an alignment is right
  float wrong_error = 0.12f;  ///< and above which it is wrong; between both it is no example
  int moved_starts = 2;  ///< poses near the truth that are examples too, an alignment: a track that drifts
  float moved_most = 0.45f;    ///< largest shift of those, fraction of the eyes' distance
  /// Weight of those for the expected error; that of other alignments is 1. With 1 errors of covered faces are estimated too large,
  /// since most examples of large errors are then faces in full view, beside their place (docs/experiments.md, Expected error).
  double moved_weight = 0.1;
  /// Errors beyond these count as these for the expected error: they need not be told apart. Round values, not tuned.
  double least_error = 0.01, most_error = 0.4;
  double others_per_face = 1;  ///< alignments at random places of pictures without faces, for each of a face
  int other_px = 160;          ///< side of those pictures
  float other_least_px = 45, other_most_px = 120;  ///< side of the boxes there
  float other_room = 0.3f;  ///< least distance of their middle from the picture's edge, fraction of its side
  double mined_per_face = 3;  ///< more of them, of which those are kept that a first training does not reject
  double mined_score = -2;    ///< appearance from which on these are kept
  double searches_per_face =
      1;                 ///< pictures without faces that the detector searches, for each alignment of a face
  /// Drawn pictures that the detector searches, for each alignment of a face. With 1 less text is taken for a face, and covered
  /// faces are recognised worse (docs/experiments.md, Text).
  double drawn_per_face = 0.3;
  int searched_px = 200;  ///< side of the pictures that the detector searches
  int found_starts = 4;  ///< alignments of each place that the detector takes for a face
  /// Standard deviations of the starts around a found place: of the centre, fraction of the side, and of the logarithm of the
  /// side; of the poses near the truth: of the turn about each axis, and of the logarithm of the scale. No experiment chose them.
  float found_shift = 0.06f, found_log_side = 0.08f, moved_turn_rad = 0.06f, moved_log_scale = 0.08f;
  /// Of the squared weights against the mean loss; and passes over the examples. The descent ends far from its minimum. With the
  /// minimum no more frames of films are right (docs/experiments.md, Expected error).
  double regularisation = 3e-5;
  int rounds = 12;
};

/// Learns from the cascade's examples, where its stages left them, and from alignments in pictures without faces: at random
/// places, and where a detector takes them for faces. Drawn pictures come last: from them the text form is learnt, which is to be 0
/// on all other examples, as far as it can.
/// \param others, drawn  pictures without faces. Of drawn ones only what the detector finds is aligned. Either may be empty.
/// \param detector       its learnt table; may be empty.
LearntCheck learn_check(AlignerCascade& cascade, const OtherPictures& others, const OtherPictures& drawn,
                        const std::vector<std::uint8_t>& detector, const LearnProgress& progress,
                        const AlignerCheckTuning& tuning = {});

}  // namespace pliant::host::learn
