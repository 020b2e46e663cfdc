#include "host/bench/fault_run.hpp"

#include <algorithm>

#include "host/bench/detection_run.hpp"
#include "host/bench/rows.hpp"
#include "host/commands/plan.hpp"

namespace pliant::host {

namespace {

/// An error beyond this, as a fraction of the distance of the eyes, is wrong: a landmark is then on another part of the face.
constexpr double kWrongError = 0.1;
/// Frames in which a track must have begun. Profile S searches a picture in up to ten.
constexpr std::size_t kMostStartFrames = 12;

/// Adds middle and width of the face.
void add_place(const NamedLandmarks& landmarks, FilmClip* clip) {
  Vec2 sum;
  float left = 1e9f, right = -1e9f;
  for (const auto& [name, x] : landmarks) {
    sum = sum + x;
    left = std::min(left, x.x);
    right = std::max(right, x.x);
  }
  clip->middle.push_back((1 / std::max(static_cast<float>(landmarks.size()), 1.0f)) * sum);
  clip->width.push_back(std::max(right - left, 1.0f));
}

/// Work of the last frame, in instructions.
double counted_work(Tracker& tracker) {
  if (!tracker.is_started()) return 0;
  return static_cast<double>(
      tracker.estimator().work_costs(tracker.limits().patch_window).of(tracker.work()));
}

bool is_spoilt(std::size_t frame) {
  return frame >= kFaultBegins && frame < kFaultBegins + kFaultFrames;
}

/// Gives the run its next frame, and notes the time if the track goes on.
void show(const FaultyFrame& faulty, std::size_t frame, DetectionRun& run, FaultCounts* counts) {
  FrameView view = frame_of(faulty.picture, frame);
  view.time_ns += faulty.time_error;
  const bool had_track = run.has_track();
  const double before = process_ms();
  run.update(view);
  if (had_track && run.has_track()) counts->milliseconds.push_back(process_ms() - before);
}

/// Of the landmarks from where the frame shows them.
double error_of(DetectionRun& run, const JudgedClip& judged, const FaultyFrame& faulty, std::size_t frame) {
  const NamedLandmarks& truth = judged.truth[faulty.is_frozen ? kFaultBegins : frame];
  return landmark_error(run.landmarks(), moved(truth, faulty.scale, faulty.shift));
}

}  // namespace

bool judge(const ModelFile& file, TrackerLimits limits, std::vector<Image> frames, JudgedClip* out) {
  limits.width = static_cast<std::uint16_t>(frames[0].width);
  limits.height = static_cast<std::uint16_t>(frames[0].height);
  *out = {{std::move(frames), {}, {}}, {}, limits};
  FilmClip& clip = out->clip;
  DetectionRun run(file, limits);
  for (std::size_t k = 0; k < clip.frames.size(); ++k) {
    run.update(frame_of(clip.frames[k], k));
    // Degraded frames of a head that is turned far are near enough to the truth, and else there would be no such clips.
    if (k >= kMostStartFrames && !run.has_track()) return false;
    out->truth.push_back(run.landmarks());
    add_place(out->truth.back(), &clip);
  }
  return true;
}

void play(const ModelFile& file, const JudgedClip& judged, const FilmFault& fault, FaultCounts* counts) {
  const FilmClip& clip = judged.clip;
  DetectionRun run(file, judged.limits);
  const double most = most_counted_instructions(make_plan(file.model(), judged.limits).loads);
  double back = -1;
  for (std::size_t k = 0; k < kClipFrames; ++k) {
    const FaultyFrame faulty =
        k < kFaultBegins ? FaultyFrame{clip.frames[k]} : fault.make(clip, k, fault.value);
    if (faulty.is_missing) continue;
    show(faulty, k, run, counts);
    counts->most_work = std::max(counts->most_work, counted_work(run.tracker()) / most);
    const bool is_tracking = run.has_track() && run.result().state == TrackState::tracking;
    const double error = is_tracking ? error_of(run, judged, faulty, k) : 0;
    if (is_tracking && (!faulty.has_face || !(error < kWrongError))) {
      ++counts->wrong;
      counts->wrong_most = std::max(counts->wrong_most, error);
    }
    if (is_spoilt(k) && faulty.has_face) {
      ++counts->with_face;
      counts->tracking += is_tracking ? 1 : 0;
    }
    if (k >= kFaultBegins + kFaultFrames && back < 0 && is_tracking && error < kRightError)
      back = static_cast<double>(k - kFaultBegins - kFaultFrames);
  }
  ++counts->clips;
  if (back < 0)
    ++counts->never;
  else
    counts->back.push_back(back);
}

}  // namespace pliant::host
