#include "track/face_checks.hpp"

#include "base/integers.hpp"
#include "track/detection_state.hpp"
#include "track/frame_worth.hpp"

namespace pliant {

namespace {

constexpr const FaceChecksTuning& kTuning = kFaceChecksTuning;

}  // namespace

void FaceChecks::lay_out(const TrackerLimits& limits) {
  modules_ = limits.detection->modules;
  most_bad_frames_ = kTuning.most_bad_frames + limits.key_frames;
}

void FaceChecks::begin_track(float landmark_error, bool is_of_known_person) {
  landmark_error_ = landmark_error;
  is_aligned_ = landmark_error > 0;
  if (!is_of_known_person) is_doubtful_ = is_aligned_;
  // A start that nothing has verified is checked in its own frame.
  frames_since_ = is_aligned_ ? 0 : kTuning.check_interval_frames;
  if (has_stayed_poor()) patience_ = smaller(2 * patience_, kTuning.most_poor_checks);
  bad_ = good_ = poor_ = 0;
  see();
}

bool FaceChecks::endure(const FrameResult& result, int bad_frames, std::size_t key_frames) {
  frames_since_ = kTuning.known_interval_frames;  // the next good frame is checked
  blind_frames_ += result.inliers == 0;
  return bad_frames < most_bad_frames_ &&
         blind_frames_ < kTuning.most_blind_frames + static_cast<int>(key_frames);
}

bool FaceChecks::is_due() const {
  const bool is_sure = has_confirmed() && landmark_error_ <= kTuning.doubtful_error;
  const int interval = is_sure ? kTuning.known_interval_frames : kTuning.check_interval_frames;
  return bad_ > 0 || frames_since_ + 1 >= interval;
}

/// \return false after too many bad checks in a row.
inline bool FaceChecks::check(const FrameView& frame, Estimator& estimator, Span<unsigned char> scratch) {
  Arena arena(scratch.data, scratch.count);
  FaceAligner* const aligner = modules_->lay_out_for_known_person(arena, estimator.model());
  PLIANT_ASSERT(!arena.exhausted());  // check_bytes
  AlignedFace face;
  if (aligner == nullptr || modules_->verify(*aligner, frame, estimator.camera(), pose_of(estimator.view()),
                                             estimator.parameters().data, &face) != Status::ok)
    return true;
  if (face.score < (has_confirmed() ? kTuning.least_check : kTuning.least_first_check)) {
    if (!has_confirmed()) good_ = 0;
    return ++bad_ < kTuning.most_bad_checks;
  }
  bad_ = 0;
  good_ += !has_confirmed();  // more make no difference
  landmark_error_ = landmark_error_ > 0
                        ? landmark_error_ + kTuning.error_rate * (face.landmark_error - landmark_error_)
                        : face.landmark_error;
  if (face.least_part >= kTuning.least_part || landmark_error_ <= kTuning.doubtful_error)
    is_doubtful_ = false;
  if (is_aligned_ && (is_doubtful_ || landmark_error_ > kTuning.most_landmark_error))
    ++poor_;
  else
    forget_poor();
  return true;
}

bool FaceChecks::conclude(const FrameView& frame, Estimator& estimator, bool checks,
                          Span<unsigned char> scratch, FrameResult* result) {
  see();
  frames_since_ = checks ? 0 : frames_since_ + 1;
  if (checks && !check(frame, estimator, scratch)) return false;
  const bool is_refuted = bad_ > 0 && !has_confirmed();
  tell_worth(estimator.view(), landmark_error_, is_refuted || (is_doubtful_ && good_ > 0), result);
  return true;
}

std::size_t check_bytes(const Model& model, const TrackerLimits& limits) {
  Arena trial;
  limits.detection->modules->lay_out_for_known_person(trial, model);
  return trial.used_bytes();
}

}  // namespace pliant
