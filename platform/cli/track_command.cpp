// `pliant track`: follows a model through a video.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include "cli/command.hpp"
#include "cli/failure.hpp"
#include "cli/files.hpp"
#include "cli/overlay.hpp"
#include "cli/owned.hpp"
#include "cli/sheet.hpp"
#include "cli/start.hpp"
#include "cli/track_table.hpp"
#include "cli/truth.hpp"
#include "cli/y4m_output.hpp"
#include "frames/frame_source.hpp"
#include "pliant/tracker.hpp"

namespace pliant::cli {

namespace {

/// The frames of a source, flipped if asked for.
class Frames {
 public:
  Frames(const std::string& name, bool is_mirrored) : name_(name), is_mirrored_(is_mirrored) {
    if (name.rfind("camera:", 0) == 0) fail_usage("--frames camera: is not available in this build");
    OpenedFrames opened = open_frames(name);
    if (opened.source == nullptr) throw Failure(kBadInput, opened.message);
    source_ = std::move(opened.source);
  }
  const std::string& name() const { return name_; }
  ImageSize size() const { return {source_->width(), source_->height()}; }
  FrameRate rate() const { return source_->rate(); }
  /// Why `next` gave no frame; empty at the regular end.
  const std::string& message() const { return source_->message(); }

  bool next(FrameView* frame) {
    const Status status = source_->next(*frame);
    if (status != Status::ok) return false;
    if (is_mirrored_) mirror(frame);
    return true;
  }

 private:
  void mirror(FrameView* frame) {
    flipped_ = image_of(*frame);
    for (int y = 0; y < flipped_.height; ++y)
      std::reverse(flipped_.at(0, y), flipped_.at(0, y) + flipped_.width);
    frame->data = flipped_.pixels.data();
    frame->stride_bytes = static_cast<std::size_t>(flipped_.width);
    frame->pixel_step_bytes = 1;
  }
  std::string name_;
  bool is_mirrored_;
  std::unique_ptr<FrameSource> source_;
  Image flipped_;
};

/// The state in frame 0, from a fit or by fitting points.
FitFile read_start(const Args& args, const ModelFile& file, ImageSize size, const std::string& frames) {
  const std::string path = args.required("--init");
  if (path == "outline") fail_usage("--init outline is not available in this build");
  const std::string text = read_file(path);
  const auto focal = static_cast<float>(args.number("--focal", 0, 1, 1e6));
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string::npos || text[first] != '{') {
    FitSetup setup;
    setup.size = size;
    setup.focal_px = focal;
    return fit_to_points(file, path, parse_points(path, text), setup);
  }
  FitFile fit = parse_fit(path, text);
  if (fit.model_crc != file.model().crc())
    fail_input(path, "was fitted with another model than " + file.path());
  if (fit.width != size.width || fit.height != size.height)
    fail_input(path, "is for " + std::to_string(fit.width) + "x" + std::to_string(fit.height) + " pixels, " +
                         frames + " has " + std::to_string(size.width) + "x" + std::to_string(size.height));
  const View view = with_focal(view_of(fit.pose, fit.camera), focal);
  fit.pose = pose_of(view);
  fit.camera = camera_of(view);
  return fit;
}

/// A flag a parameter: the expressions, unless frozen; the identity only when it is to be refined.
std::vector<std::uint8_t> free_parameters(const Args& args, const Model& model) {
  const std::string freeze = args.text("--freeze").value_or("identity");
  if (freeze != "identity" && freeze != "expression")
    fail_usage("--freeze: identity or expression, not " + freeze);
  std::vector<std::uint8_t> is_free;
  for (const Parameter& p : model.parameters())
    is_free.push_back(p.group == Group::identity ? args.has("--refine-identity") : freeze != "expression");
  return is_free;
}

struct Markers {
  std::vector<std::string> names;
  std::vector<Vec2> x;
};

Markers read_markers(const Args& args, const Model& model) {
  Markers markers;
  const auto path = args.text("--markers");
  if (!path) return markers;
  for (const NamedPoint& p : read_points(*path)) {
    if (args.has("--landmarks") && model.find_landmark(p.name.c_str()) != kNone)
      fail_input(p.where, "marker '" + p.name + "' has the name of a landmark, which --landmarks reports");
    markers.names.push_back(p.name);
    markers.x.push_back(p.x);
  }
  if (markers.x.size() > 4096) fail_input(*path, "more than 4096 markers");
  return markers;
}

TrackerLimits limits_for(ImageSize size, std::size_t markers) {
  TrackerLimits limits;
  limits.width = static_cast<std::uint16_t>(size.width);
  limits.height = static_cast<std::uint16_t>(size.height);
  limits.markers = static_cast<std::uint16_t>(markers);
  return limits;
}

/// Everything that one run writes, and counts.
class TrackOutput {
 public:
  TrackOutput(const Args& args, const Model& model, const Markers& markers, FrameRate rate)
      : model_(model),
        table_(args.required("--out")),
        with_landmarks_(args.has("--landmarks")),
        marker_count_(markers.x.size()),
        rate_(rate) {
    if (const auto path = args.text("--overlay")) overlay_ = std::make_unique<Y4mOutput>(*path, rate);
    if (const auto path = args.text("--sheet")) sheet_file_ = std::make_unique<OutputFile>(*path);
    if (const auto path = args.text("--truth")) truth_ = std::make_unique<TruthComparison>(*path, model);
    std::vector<std::string> names;
    if (with_landmarks_)
      for (const Landmark& l : model.landmarks()) names.push_back(l.name);
    names.insert(names.end(), markers.names.begin(), markers.names.end());
    table_.write(track_header(model, names));
  }

  void add(std::size_t number, const FrameView& frame, Tracker& tracker, double milliseconds) {
    const FrameResult& result = tracker.result();
    TrackRow row;
    row.frame = number;
    row.time_s = static_cast<double>(number) / rate_.per_second();
    row.state = result.state;
    row.tracked = result.tracked;
    row.inliers = result.inliers;
    row.rms_px = result.rms_px;
    row.vertices = result.vertices;
    row.pose = result.pose;
    for (const float value : tracker.estimator().parameters()) row.q.push_back(value);
    const auto landmarks = project_landmarks(tracker.estimator());
    if (with_landmarks_) row.points = landmarks;
    const auto markers = project_markers(tracker);
    row.points.insert(row.points.end(), markers.begin(), markers.end());
    table_.write(track_line(row));

    if (number > 0) milliseconds_.push_back(milliseconds);
    ++frames_;
    if (row.state == TrackState::tracking) ++tracked_;
    if (row.state != TrackState::lost) {
      squared_sum_ += static_cast<double>(row.rms_px) * static_cast<double>(row.rms_px);
      ++known_;
      if (truth_) truth_->add(number, row.pose, landmarks);
    }
    if (overlay_ || sheet_file_) draw(row, frame, tracker, landmarks, markers);
  }

  void commit() {
    table_.commit();
    if (overlay_) overlay_->commit();
    if (sheet_file_) {
      sheet_file_->write(encode_png(sheet_.image()));
      sheet_file_->commit();
    }
  }

  void print_summary(std::ostream& out, std::size_t arena_bytes, float focal_px) const {
    char line[256];
    const double rms = known_ == 0 ? 0 : std::sqrt(squared_sum_ / static_cast<double>(known_));
    std::snprintf(line, sizeof line,
                  "frames=%zu tracked=%zu rms_px=%.3f median_ms=%.3f arena_bytes=%zu f_px=%.6g", frames_,
                  tracked_, rms, median(milliseconds_), arena_bytes, static_cast<double>(focal_px));
    out << line;
    if (truth_) {
      std::snprintf(line, sizeof line, " landmark_px=%.3f rotation_deg=%.3f compared=%zu",
                    truth_->mean_landmark_px(), truth_->median_rotation_deg(), truth_->frame_count());
      out << line;
    }
    out << "\n";
  }

 private:
  std::vector<std::optional<Vec2>> project_landmarks(Estimator& estimator) const {
    std::vector<std::optional<Vec2>> out;
    for (const Landmark& l : model_.landmarks()) {
      Vec2 x;
      out.push_back(estimator.project({l.u, l.v}, &x) ? std::optional<Vec2>(x) : std::nullopt);
    }
    return out;
  }
  std::vector<std::optional<Vec2>> project_markers(Tracker& tracker) const {
    std::vector<std::optional<Vec2>> out;
    for (std::size_t k = 0; k < marker_count_; ++k) {
      Vec2 x;
      out.push_back(tracker.marker(k, &x) ? std::optional<Vec2>(x) : std::nullopt);
    }
    return out;
  }
  void draw(const TrackRow& row, const FrameView& frame, Tracker& tracker,
            const std::vector<std::optional<Vec2>>& landmarks,
            const std::vector<std::optional<Vec2>>& markers) {
    Overlay overlay(image_of(frame));
    if (row.state != TrackState::lost) {
      overlay.draw_mesh(wire_of(tracker.estimator()));
      for (const auto& x : landmarks)
        if (x) overlay.draw_landmark(*x);
      for (const auto& x : markers)
        if (x) overlay.draw_marker(*x);
    }
    overlay.draw_caption(std::to_string(row.frame) + "  " + state_text(row.state));
    overlay.draw_state(row.state);
    if (overlay_) overlay_->write(overlay.image());
    if (sheet_file_) sheet_.add(overlay.image());
  }

  Model model_;
  OutputFile table_;
  bool with_landmarks_;
  std::size_t marker_count_;
  FrameRate rate_;
  std::unique_ptr<Y4mOutput> overlay_;
  std::unique_ptr<OutputFile> sheet_file_;
  std::unique_ptr<TruthComparison> truth_;
  ContactSheet sheet_;
  std::vector<double> milliseconds_;
  std::size_t frames_ = 0, tracked_ = 0, known_ = 0;
  double squared_sum_ = 0;
};

int run_track(const Args& args, Console& console) {
  args.required("--out");
  args.required("--init");
  TrackerOptions options;
  options.marker_exclusion_px = static_cast<float>(args.number("--marker-exclusion-px", 8, 0, 1000));
  const ModelFile file(args.operand(0));
  const Model& model = file.model();
  const auto is_free = free_parameters(args, model);
  options.is_free = is_free.data();
  Frames frames(args.required("--frames"), args.has("--mirror"));
  const FitFile start = read_start(args, file, frames.size(), frames.name());
  const Markers markers = read_markers(args, model);
  std::vector<float> q(model.parameters().count, 0.0f);
  list_unmatched(apply(start.parameters, model, q.data()), args.required("--init"), console.err);

  FrameView frame;
  if (!frames.next(&frame))
    throw Failure(kBadInput, frames.message().empty() ? frames.name() + ": has no frames" : frames.message());
  Owned<Tracker> tracker(model, limits_for(frames.size(), markers.x.size()));
  require(tracker->start(frame, start.camera, start.pose, q.data(), {markers.x.data(), markers.x.size()},
                         options),
          frames.name() + ": frame 0");
  TrackOutput output(args, model, markers, frames.rate());
  output.add(0, frame, *tracker, 0);
  Progress progress(console, "frame");
  for (std::size_t number = 1; frames.next(&frame); ++number) {
    FrameResult result;
    const auto before = std::chrono::steady_clock::now();
    require(tracker->update(frame, &result), frames.name() + ": frame " + std::to_string(number));
    const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - before;
    output.add(number, frame, *tracker, elapsed.count());
    progress.show(number + 1);
  }
  // A stream that breaks off leaves what came before it.
  output.commit();
  output.print_summary(console.out, tracker.used_bytes(), start.camera.f);
  if (frames.message().empty()) return 0;
  throw Failure(kBadInput, frames.message());
}

}  // namespace

Command track_command() {
  return {"track",
          "Follows a model through a video, from a start in its first frame.",
          "face.plm --frames VIDEO.y4m|FOLDER|- --init fit.json|points.csv --out track.csv [--landmarks] "
          "[--markers points.csv] [--marker-exclusion-px R] [--focal PX] [--mirror] [--freeze GROUP] "
          "[--refine-identity] "
          "[--overlay out.y4m] [--sheet out.png] [--truth truth.csv]",
          {{"--frames", "SOURCE", "a Y4M file, a folder of PGM or PPM, or - for Y4M on standard input"},
           {"--init", "FILE", "frame 0: a fit.json, or a points.csv that is fitted first"},
           {"--out", "CSV", "the track to write: a row a frame"},
           {"--landmarks", nullptr, "columns with the model's landmarks as well"},
           {"--markers", "CSV", "landmark,x,y in frame 0: points to follow and report, never to look at"},
           {"--marker-exclusion-px", "R", "how far from a marker patches keep (8)"},
           {"--focal", "PX", "focal length, when it is known"},
           {"--mirror", nullptr,
            "flip every frame first; start, markers and results are those of the flipped picture"},
           {"--freeze", "GROUP", "identity (default), or expression: follow the head only"},
           {"--refine-identity", nullptr, "let the identity move as well"},
           {"--overlay", "Y4M", "the video with the mesh on it"},
           {"--sheet", "PNG", "nine frames of that on one picture"},
           {"--truth", "CSV", "the truth of a rendered video, to compare with"},
           {"--report", "HTML", "", false}},
          1,
          run_track};
}

}  // namespace pliant::cli
