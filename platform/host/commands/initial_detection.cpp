#include "host/commands/initial_detection.hpp"

#include <cstdio>

#include "host/io/failure.hpp"

namespace pliant::host {

namespace {

FaceDetectorLimits limits_for(const ImageSize& size) {
  FaceDetectorLimits limits;
  limits.width = static_cast<std::uint16_t>(size.width);
  limits.height = static_cast<std::uint16_t>(size.height);
  return limits;
}

std::string similarity_text(float similarity) {
  char text[16];
  std::snprintf(text, sizeof text, "%.2f", static_cast<double>(similarity));
  return text;
}

}  // namespace

InitialDetection::InitialDetection(const ModelFile& file, const ImageSize& size, const Camera& camera,
                                   const std::string& frames, int max_frames, std::ostream& err)
    : frames_(frames),
      max_frames_(max_frames),
      err_(err),
      detector_(file.model(), limits_for(size)),
      camera_(camera) {
  const Status status = detector_->begin(camera, {});
  if (status == Status::not_found)
    fail_input(file.path(),
               "--init detect needs a model with an albedo, curves of lids, brows and lips, and landmarks");
  require(status, "--init detect");
}

std::optional<InitialState> InitialDetection::find(const FrameView& frame, std::size_t number) {
  FaceDetectorReport report;
  require(detector_->find(frame, &report), frames_ + ": frame " + std::to_string(number));
  best_similarity_ = max(best_similarity_, report.similarity);
  ++searched_frames_;
  if (!report.is_found) {
    if (searched_frames_ == 1) err_ << frames_ << ": frame " << number << ": no face found yet\n";
    if (searched_frames_ >= max_frames_) give_up();
    return std::nullopt;
  }
  err_ << frames_ << ": frame " << number << ": face found, similarity " << similarity_text(report.similarity)
       << "\n";
  trial_frames_ = 0;
  similarity_sum_ = 0;
  detection_frame_ = number;
  is_found_ = true;
  const Span<const float> q = detector_->parameters();
  return InitialState{camera_, report.pose, {q.begin(), q.end()}};
}

void InitialDetection::reject(std::size_t number) {
  is_found_ = false;
  err_ << frames_ << ": frame " << number << ": the face has too little texture to track, searching again\n";
  if (searched_frames_ >= max_frames_) give_up();
}

float InitialDetection::similarity_in(const FrameView& frame, Tracker& tracker) {
  float similarity = 0;
  if (tracker.result().state == TrackState::lost) return 0;
  const Status status =
      detector_->compare(frame, tracker.result().pose, tracker.estimator().parameters().data, &similarity);
  return status == Status::ok ? similarity : 0;
}

bool InitialDetection::is_confirmed(const FrameView& frame, std::size_t number, Tracker& tracker) {
  constexpr InitialDetectionTuning tuning = kInitialDetectionTuning;
  if (trial_frames_ == tuning.trial_frames) return true;
  similarity_sum_ += similarity_in(frame, tracker);
  if (++trial_frames_ < tuning.trial_frames) return true;
  const float mean = similarity_sum_ / static_cast<float>(tuning.trial_frames);
  if (mean >= tuning.confirming_fraction * FaceDetectorOptions{}.min_similarity) return true;
  is_found_ = false;
  err_ << frames_ << ": frame " << number << ": the detection in frame " << detection_frame_
       << " is not confirmed (similarity " << similarity_text(mean) << "), searching again\n";
  return false;
}

void InitialDetection::require_found() const {
  if (!is_found_) give_up();
}

void InitialDetection::give_up() const {
  const float needed = FaceDetectorOptions{}.min_similarity;
  const std::string count = std::to_string(searched_frames_) + " frames";
  if (best_similarity_ >= needed) fail_input(frames_, "no detection was confirmed in " + count);
  fail_input(frames_, "no face found in " + count + ": best similarity " + similarity_text(best_similarity_) +
                          ", " + similarity_text(needed) + " is needed");
}

}  // namespace pliant::host
