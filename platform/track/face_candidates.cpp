#include "track/face_candidates.hpp"

namespace pliant {

namespace {

constexpr const FaceCandidatesTuning& kTuning = kFaceCandidatesTuning;

bool are_of_one_face(const FaceBox& a, const FaceBox& b) {
  const float small = min(a.side, b.side), large = max(a.side, b.side);
  return length(a.center - b.center) < kTuning.same_face_distance * large &&
         large < kTuning.same_face_ratio * small;
}

}  // namespace

void FaceCandidates::add(const DetectedFace& face) {
  if (!(face.score >= kTuning.least_detection)) return;
  std::size_t at = 0;
  for (; at < count_ && faces_[at].score >= face.score; ++at)
    if (are_of_one_face(faces_[at].box, face.box)) return;
  std::size_t kept = at;
  for (std::size_t k = at; k < count_; ++k)
    if (!are_of_one_face(faces_[k].box, face.box)) faces_[kept++] = faces_[k];
  if (at == kMost) return;
  count_ = kept < kMost ? kept + 1 : kMost;
  for (std::size_t k = count_ - 1; k > at; --k) faces_[k] = faces_[k - 1];
  faces_[at] = face;
}

void FaceCandidates::add_place(const FaceBox& box) {
  clear();
  faces_[0] = {box, 0};
  count_ = 1;
}

}  // namespace pliant
