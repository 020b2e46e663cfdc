#include "host/commands/track_output.hpp"

#include <cmath>
#include <cstdio>
#include <fstream>

#include "host/io/failure.hpp"
#include "host/io/statistics.hpp"

namespace pliant::host {

namespace {

/// Peak resident memory of this process, KiB; 0 where the system does not tell. getrusage would count the memory of the
/// parent process from before exec.
std::size_t peak_memory_kib() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.rfind("VmHWM:", 0) == 0) return std::stoul(line.substr(6));
  return 0;
}

/// Null without --arkit.
std::unique_ptr<ArkitExpression> arkit_of(const Args& args, const Model& model) {
  if (!args.has("--arkit")) return nullptr;
  auto arkit = std::make_unique<ArkitExpression>(model);
  if (arkit->absent().size() == kArkitCount)
    fail_input(args.operand(0), "has no expression that ARKit has, as --arkit needs");
  return arkit;
}

}  // namespace

bool has_landmarks(const Args& args) {
  return args.has("--landmarks") || args.has("--model-landmarks");
}

TrackOutput::TrackOutput(const Args& args, const Model& model, const std::vector<std::string>& marker_names,
                         FrameRate rate, std::size_t expected)
    : model_(model),
      table_(args.required("--out")),
      arkit_(arkit_of(args, model)),
      with_landmarks_(has_landmarks(args)),
      marker_count_(marker_names.size()),
      sheet_(expected) {
  if (const auto path = args.text("--overlay")) overlay_ = std::make_unique<Y4mWriter>(*path, rate);
  if (args.has("--show")) window_ = std::make_unique<LiveWindow>(rate);
  if (const auto path = args.text("--sheet")) sheet_file_ = std::make_unique<OutputFile>(*path);
  if (const auto path = args.text("--report")) {
    report_file_ = std::make_unique<OutputFile>(*path);
    report_ = std::make_unique<TrackReport>(model);
    facts_.title = args.required("--frames");
    facts_.table_bytes = model.table_bytes();
  }
  if (const auto path = args.text("--truth")) truth_ = std::make_unique<TruthComparison>(*path, model);
  std::vector<std::string> names;
  if (with_landmarks_)
    for (const Landmark& l : model.landmarks()) names.push_back(l.name);
  names.insert(names.end(), marker_names.begin(), marker_names.end());
  table_.write(arkit_ ? track_header({kArkitNames.begin(), kArkitNames.end()}, names)
                      : track_header(model, names));
}

void TrackOutput::add(const FrameStream& frames, const FrameView& frame, ReducedTracker& tracker,
                      double milliseconds) {
  const std::size_t number = frames.number(frame);
  const FrameResult& result = tracker.tracker().result();
  TrackRow row;
  row.frame = number;
  row.time_s = frames.time_s(frame);
  row.state = result.state;
  row.tracked = result.tracked;
  row.inliers = result.inliers;
  row.rms_px = tracker.rms_px();
  row.vertices = result.vertices;
  row.landmark_error = result.landmark_error;
  row.gaze = result.gaze;
  row.pose = result.pose;
  for (const float value : tracker.tracker().estimator().parameters()) row.q.push_back(value);
  std::vector<std::optional<Vec2>> landmarks, markers;
  for (std::size_t k = 0; k < model_.landmarks().count; ++k) landmarks.push_back(tracker.landmark(k));
  for (std::size_t k = 0; k < marker_count_; ++k) markers.push_back(tracker.marker(k));
  if (with_landmarks_) row.points = landmarks;
  row.points.insert(row.points.end(), markers.begin(), markers.end());
  if (number > 0) milliseconds_.push_back(milliseconds);
  if (row.state != TrackState::lost && truth_)
    truth_->add(number, row.pose, landmarks, {frame.width, frame.height});
  write(row, frame);
  const auto marks = [&] {
    return row.state == TrackState::lost ? TrackMarks{} : TrackMarks{tracker.mesh(), landmarks, markers};
  };
  show(row, frames, frame, marks, milliseconds);
}

void TrackOutput::add_lost(const FrameStream& frames, const FrameView& frame) {
  TrackRow row;
  row.frame = frames.number(frame);
  row.time_s = frames.time_s(frame);
  row.state = TrackState::lost;
  row.q.resize(model_.parameters().count);
  row.points.resize((with_landmarks_ ? model_.landmarks().count : 0) + marker_count_);
  write(row, frame);
  show(
      row, frames, frame, [] { return TrackMarks{}; }, std::nullopt);
}

void TrackOutput::write(const TrackRow& row, const FrameView& frame) {
  TrackRow line = row;
  if (arkit_) line.q = arkit_->coefficients(row.q, row.gaze);
  table_.write(track_line(line));
  ++frames_;
  if (row.state == TrackState::tracking) ++tracked_;
  if (row.state != TrackState::lost) {
    squared_sum_ += static_cast<double>(row.rms_px) * static_cast<double>(row.rms_px);
    ++known_;
  }
  facts_.width = frame.width;
  facts_.height = frame.height;
  facts_.vertices = static_cast<std::size_t>(row.vertices);
}

std::string TrackOutput::commit(std::size_t arena_bytes, float focal_px) {
  const std::string line = summary(arena_bytes, focal_px);  // before the files, which add to the peak memory
  table_.commit();
  try {
    if (overlay_) overlay_->commit();
    if (window_) window_->close();
  } catch (const Failure& failure) {
    failure_ = failure.what();
  }
  if (sheet_file_) {
    sheet_file_->write(encode_png(sheet_.image()));
    sheet_file_->commit();
  }
  if (report_) {
    facts_.arena_bytes = arena_bytes;
    facts_.rms_px = rms_px();
    facts_.summary = line;
    report_file_->write(report_->page(facts_, sheet_));
    report_file_->commit();
  }
  return line;
}

double TrackOutput::rms_px() const {
  return known_ == 0 ? 0 : std::sqrt(squared_sum_ / static_cast<double>(known_));
}

std::string TrackOutput::summary(std::size_t arena_bytes, float focal_px) const {
  char line[256];
  std::snprintf(line, sizeof line,
                "frames=%zu tracked=%zu rms_px=%.3f median_ms=%.3f arena_bytes=%zu f_px=%.6g", frames_,
                tracked_, rms_px(), median(milliseconds_), arena_bytes, static_cast<double>(focal_px));
  std::string out = line;
  if (const std::size_t peak = peak_memory_kib(); peak > 0) out += " peak_kib=" + std::to_string(peak);
  if (truth_) {
    if (!model_.landmarks().empty() && truth_->frame_count() > 0) {
      std::snprintf(line, sizeof line, " landmark_px=%.3f", truth_->mean_landmark_px());
      out += line;
    }
    if (truth_->frame_count() > 0) {
      std::snprintf(line, sizeof line, " rotation_deg=%.3f", truth_->median_rotation_deg());
      out += line;
    }
    out += " compared=" + std::to_string(truth_->frame_count());
  }
  return out;
}

void TrackOutput::show(const TrackRow& row, const FrameStream& frames, const FrameView& frame,
                       const std::function<TrackMarks()>& marks, std::optional<double> milliseconds) {
  if (report_) report_->add(row, milliseconds);
  const bool draws = overlay_ || window_, is_on_sheet = (sheet_file_ || report_) && sheet_.wants_next();
  if (!is_on_sheet) sheet_.skip();
  if (!draws && !is_on_sheet) return;
  const TrackPicture shown{frames.picture(frame), marks(),
                           std::to_string(row.frame) + "  " + state_text(row.state), row.state};
  if (!draws) return sheet_.add([shown] { return shown.drawn(); });
  const Image image = shown.drawn();
  show(image);
  if (is_on_sheet) sheet_.add([image] { return image; });
}

/// A disk that is full takes the overlay, not the track.
void TrackOutput::show(const Image& image) {
  try {
    if (overlay_) overlay_->write(image);
  } catch (const Failure& failure) {
    failure_ = failure.what();
    overlay_.reset();
  }
  try {
    if (window_) window_->show(image);
  } catch (const Failure& failure) {
    failure_ = failure.what();
  }
}

}  // namespace pliant::host
