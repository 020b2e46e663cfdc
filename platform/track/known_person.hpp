#pragma once
// Whom a tracker knows, and whether a face that comes is theirs.
#include "pliant/camera.hpp"
#include "pliant/face_aligner.hpp"
#include "track/landmark_offsets.hpp"

namespace pliant {

/// Tuning of the comparison of people. Each constant: unit, reason, experiment.
struct KnownPersonTuning {
  /// Root mean square distance, in standard deviations of the parameters, between the identity as it was aligned first and as it
  /// is aligned now, from which on a face is another person's; and the cosine of the turn away from the camera up to which both
  /// alignments tell: 20 degrees. Of portraits, rendered heads and a recorded face below this angle (docs/experiments.md) 151
  /// pairs of one person have at most 0.21, and 87 % of 598 pairs of two people more than 0.23.
  float most_identity_distance = 0.23f, least_frontal = 0.94f;
};
inline constexpr KnownPersonTuning kKnownPersonTuning{};

/// Whether a face is turned away from the camera so little that its alignment tells the person's shape.
inline bool is_frontal(const View& view) {
  return camera_direction(view).z >= kKnownPersonTuning.least_frontal;
}

/// The person whom the tracker knows. The arrays are the tracker's.
struct KnownPerson {
  bool is_known = false;
  Camera camera;
  float* q = nullptr;  // all parameters
  LandmarkOffsets* offsets = nullptr;
};

/// The known person's identity as it was aligned first: two alignments err alike, a track errs in another way.
class IdentityReference {
 public:
  void lay_out(Arena& arena, const Model& model);
  void forget() { is_frontal_ = false; }
  /// Whether `may_be` can tell people apart.
  bool tells() const { return is_frontal_; }
  /// \param q  all parameters of an alignment without a known identity, here and below.
  void set(const AlignedFace& face, const float* q);
  /// False: the face is another person's. True also where its turn does not let it tell.
  bool may_be(const AlignedFace& face, const float* q) const;

 private:
  Span<const Parameter> parameters_;
  float* q_ = nullptr;
  bool is_frontal_ = false;  // the face was, when q_ was set
};

}  // namespace pliant
