// `pliant bench faults`: what a tracker says of a film in which something goes wrong, and when it is back.
#include <utility>

#include "host/bench/bench.hpp"
#include "host/bench/detection_report.hpp"
#include "host/bench/fault_run.hpp"
#include "host/io/failure.hpp"
#include "host/io/frame_source.hpp"

namespace pliant::host {

namespace {

constexpr std::size_t kClipStep = 300;  ///< frames from the beginning of one clip to that of the next

/// The first frames of a film, every `kClipStep`th frame the beginning of a clip.
std::vector<JudgedClip> read_clips(const ModelFile& file, const TrackerLimits& limits,
                                   const std::string& film, std::size_t most) {
  OpenedFrames opened = open_frames(film);
  if (!opened.source) throw Failure(kBadInput, opened.message);
  std::vector<JudgedClip> clips;
  std::vector<Image> frames;
  JudgedClip judged;
  FrameView frame;
  for (std::size_t k = 0; clips.size() < most && opened.source->next(frame) == Status::ok; ++k) {
    if (k % kClipStep >= kClipFrames) continue;
    frames.push_back(image_of(frame));
    if (frames.size() < kClipFrames) continue;
    if (judge(file, limits, std::move(frames), &judged)) clips.push_back(std::move(judged));
    frames.clear();
  }
  if (!opened.source->message().empty()) throw Failure(kBadInput, opened.source->message());
  if (clips.empty())
    fail_input(film, "no part of " + std::to_string(kClipFrames) +
                         " frames in which the face is found and tracked throughout");
  return clips;
}

}  // namespace

void bench_faults(std::ostream& out, const ModelFile& file, const TrackerLimits& limits,
                  const std::string& film, std::size_t clips) {
  const BenchRows rows(out, "faults");
  const std::vector<JudgedClip> judged = read_clips(file, limits, film, clips);
  for (const FilmFault& fault : film_faults()) {
    FaultCounts counts;
    for (const JudgedClip& one : judged) play(file, one, fault, &counts);
    rows(fault.name, "clips", counts.clips);
    rows(fault.name, "tracking_percent",
         counts.with_face > 0 ? 100 * counts.tracking / counts.with_face : kUnknown);
    rows(fault.name, "wrong_frames", counts.wrong);
    rows(fault.name, "worst_wrong_percent", 100 * counts.wrong_most);
    rows(fault.name, "back_frames", counts.back.empty() ? kUnknown : quantile(counts.back, 0.5));
    rows(fault.name, "back_frames_worst", counts.back.empty() ? kUnknown : quantile(counts.back, 1));
    rows(fault.name, "never_back", counts.never);
    rows(fault.name, "most_of_bound_percent", 100 * counts.most_work);
    rows(fault.name, "slowest_over_median",
         quantile(counts.milliseconds, 1) / quantile(counts.milliseconds, 0.5));
  }
}

}  // namespace pliant::host
