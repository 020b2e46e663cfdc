#include "host/commands/detection_start.hpp"

#include <cstdio>

#include "host/io/failure.hpp"

namespace pliant::host {

namespace {

constexpr int kTrialFrames = 10;
/// Less than at the start: a face that turns and talks looks less like what was fitted.
constexpr float kHoldShare = 0.85f;

FaceDetectorLimits limits_for(const ImageSize& size) {
  FaceDetectorLimits limits;
  limits.width = static_cast<std::uint16_t>(size.width);
  limits.height = static_cast<std::uint16_t>(size.height);
  return limits;
}

std::string number_of(float likeness) {
  char text[16];
  std::snprintf(text, sizeof text, "%.2f", static_cast<double>(likeness));
  return text;
}

}  // namespace

DetectionStart::DetectionStart(const ModelFile& file, const ImageSize& size, const Camera& camera,
                     const std::string& frames, int most_frames, std::ostream& err)
    : frames_(frames),
      most_frames_(most_frames),
      err_(err),
      finder_(file.model(), limits_for(size)),
      camera_(camera) {
  const Status status = finder_->begin(camera, {});
  if (status == Status::not_found)
    fail_input(file.path(),
               "--init detect needs a model with an albedo, curves of lids, brows and lips, and landmarks");
  require(status, "--init detect");
}

std::optional<Beginning> DetectionStart::find(const FrameView& frame, std::size_t number) {
  FaceDetectorReport report;
  require(finder_->find(frame, &report), frames_ + ": frame " + std::to_string(number));
  most_ = max(most_, report.similarity);
  ++looked_;
  if (!report.is_found) {
    if (looked_ == 1) err_ << frames_ << ": frame " << number << ": no face found yet, looking on\n";
    if (looked_ >= most_frames_) give_up();
    return std::nullopt;
  }
  err_ << frames_ << ": frame " << number << ": found, likeness " << number_of(report.similarity) << "\n";
  const Span<const float> q = finder_->parameters();
  followed_ = 0;
  sum_ = 0;
  started_at_ = number;
  is_on_ = true;
  return Beginning{camera_, report.pose, {q.begin(), q.end()}};
}

void DetectionStart::refuse(std::size_t number) {
  is_on_ = false;
  err_ << frames_ << ": frame " << number << ": too little to track there, looking on\n";
  if (looked_ >= most_frames_) give_up();
}

bool DetectionStart::holds(const FrameView& frame, std::size_t number, Tracker& tracker) {
  if (followed_ == kTrialFrames) return true;
  float likeness = 0;
  const bool is_compared = tracker.result().state != TrackState::lost &&
                           finder_->compare(frame, tracker.result().pose,
                                            tracker.estimator().parameters().data, &likeness) == Status::ok;
  if (!is_compared) likeness = 0;
  sum_ += likeness;
  if (++followed_ < kTrialFrames) return true;
  const float mean = sum_ / kTrialFrames;
  if (mean >= kHoldShare * FaceDetectorOptions{}.min_similarity) return true;
  is_on_ = false;
  err_ << frames_ << ": frame " << number << ": the start in frame " << started_at_
       << " does not hold (likeness " << number_of(mean) << "), looking again\n";
  return false;
}

void DetectionStart::conclude() const {
  if (!is_on_) give_up();
}

void DetectionStart::give_up() const {
  const float needed = FaceDetectorOptions{}.min_similarity;
  const std::string count = std::to_string(looked_) + " frames";
  if (most_ >= needed) fail_input(frames_, "no start held, " + count + " looked at");
  fail_input(frames_, "no face found in " + count + ": likeness at most " + number_of(most_) + ", " +
                          number_of(needed) + " is needed");
}

}  // namespace pliant::host
