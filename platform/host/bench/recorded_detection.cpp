#include "host/bench/recorded_detection.hpp"

#include <algorithm>
#include <cmath>
#include <deque>

#include "host/bench/detection_run.hpp"
#include "host/io/failure.hpp"
#include "host/io/frame_source.hpp"

namespace pliant::host {

namespace {

/// One start within a film.
struct FilmStart {
  std::size_t first;  ///< frame
  std::unique_ptr<DetectionRun> run;
  int right = -1;        ///< frames until the landmark error was below kRightError
  double error_sum = 0;  ///< after that
  std::size_t frames = 0, lost = 0;
};

}  // namespace

void measure_recorded_film(const ModelFile& file, const std::string& film, const std::string& truth_path,
                           DetectionReport& report) {
  constexpr std::size_t kEvery = 100, kWithin = 10, kJudged = 200;
  const std::vector<NamedLandmarks> truth = read_annotated_frames(truth_path);
  OpenedFrames opened = open_frames(film);
  if (!opened.source) throw Failure(kBadInput, opened.message);
  std::deque<FilmStart> starts;
  std::vector<double> right_errors;
  std::size_t cases = 0, right = 0, lost = 0;
  const auto finish = [&](const FilmStart& s) {
    ++cases;
    const bool is_right = s.right >= 0 && s.right < static_cast<int>(kWithin);
    right += is_right ? 1 : 0;
    lost += s.lost;
    const double error = s.frames > 0 ? s.error_sum / static_cast<double>(s.frames) : kUnknown;
    if (s.frames > 0) right_errors.push_back(error);
    report.add("film", std::to_string(s.first), s.right, error, kUnknown, static_cast<double>(s.lost));
  };
  FrameView frame;
  for (std::size_t k = 0; k < truth.size() && opened.source->next(frame) == Status::ok; ++k) {
    if (k % kEvery == 0 && k + kWithin + kJudged <= truth.size())
      starts.push_back({k, std::make_unique<DetectionRun>(file, frame.width, frame.height)});
    for (FilmStart& s : starts) {
      s.run->update(frame);
      const bool has_track = s.run->has_track();
      const double error = has_track ? landmark_error(s.run->landmarks(), truth[k]) : kUnknown;
      if (s.right < 0 && error < kRightError) s.right = static_cast<int>(k - s.first);
      if (k - s.first < kWithin) continue;
      if (has_track && std::isfinite(error)) s.error_sum += error, ++s.frames;
      s.lost += has_track ? 0 : 1;
    }
    if (!starts.empty() && k + 1 == starts.front().first + kWithin + kJudged) {
      finish(starts.front());
      starts.pop_front();
    }
  }
  if (!opened.source->message().empty()) throw Failure(kBadInput, opened.source->message());
  report.rows("film", "starts", static_cast<double>(cases));
  report.rows("film", "right_in_10_frames_percent",
              100 * static_cast<double>(right) / static_cast<double>(std::max<std::size_t>(cases, 1)));
  report.rows("film", "lost_frames", static_cast<double>(lost));
  if (right_errors.empty()) return;
  double sum = 0;
  for (const double e : right_errors) sum += e;
  report.rows("film", "nme_percent_next_200", 100 * sum / static_cast<double>(right_errors.size()));
  report.rows("film", "nme_percent_worst_start", 100 * quantile(right_errors, 1));
}

}  // namespace pliant::host
