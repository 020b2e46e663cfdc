#pragma once
// What a search has detected and an alignment has still to judge.
#include <cstddef>

#include "pliant/face_detector.hpp"

namespace pliant {

/// Tuning of the candidates. Each constant: unit, reason, experiment.
struct FaceCandidatesTuning {
  /// Probability that the detector gives a box, at least, for an alignment. Low: alignment and its own verification decide. Round
  /// value, not tuned.
  float least_detection = 0.2f;
  /// Detections that wait for an alignment, count, at most. Round value, not tuned.
  std::size_t most_candidates = 8;
  /// Two boxes are of one face if their centres are nearer than this fraction of the larger side, and the larger side is below
  /// this multiple of the smaller one. Not tuned.
  float same_face_distance = 0.5f, same_face_ratio = 1.6f;
};
inline constexpr FaceCandidatesTuning kFaceCandidatesTuning{};

/// Detections that wait for an alignment: best first, one a face.
class FaceCandidates {
 public:
  void clear() { count_ = next_ = 0; }
  void add(const DetectedFace& face);
  /// Adds a place that no detection gives, whatever its score.
  void add_place(const FaceBox& box);
  bool empty() const { return count_ == 0; }
  /// The best one that has not been passed. Not if empty.
  DetectedFace& next() { return faces_[next_]; }
  const DetectedFace& next() const { return faces_[next_]; }
  /// \return false if that was the last one.
  bool pass() { return ++next_ < count_; }

 private:
  static constexpr std::size_t kMost = kFaceCandidatesTuning.most_candidates;

  DetectedFace faces_[kMost];
  std::size_t count_ = 0, next_ = 0;
};

}  // namespace pliant
