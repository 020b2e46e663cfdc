// `pliant track`: follows a model through a video.
#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <sstream>

#include "host/commands/command.hpp"
#include "host/commands/detection_start.hpp"
#include "host/commands/start.hpp"
#include "host/commands/track_output.hpp"
#include "host/commands/tracker_limits.hpp"
#include "host/io/calibration.hpp"
#include "host/io/failure.hpp"
#include "host/io/files.hpp"
#include "host/io/frame_source.hpp"
#include "host/io/interrupt.hpp"
#include "host/io/owned.hpp"
#include "pliant/tracker.hpp"

namespace pliant::host {

namespace {

/// The frames of a source, flipped if asked for.
class Frames {
 public:
  Frames(const std::string& name, bool is_mirrored) : name_(name), is_mirrored_(is_mirrored) {
    OpenedFrames opened = open_frames(name);
    if (opened.source == nullptr) throw Failure(kBadInput, opened.message);
    source_ = std::move(opened.source);
  }
  const std::string& name() const { return name_; }
  ImageSize size() const { return {source_->width(), source_->height()}; }
  FrameRate rate() const { return source_->rate(); }
  bool is_live() const { return source_->is_live(); }
  /// Why `next` gave no frame; empty at the regular end.
  const std::string& message() const { return source_->message(); }

  bool next(FrameView* frame) {
    const Status status = source_->next(*frame);
    if (status != Status::ok) return false;
    if (is_mirrored_) mirror(frame);
    if (!first_) first_ = *frame;
    return true;
  }
  /// Counted from the first one. A camera's frames keep its numbers, so that those that were missed leave gaps.
  std::size_t number(const FrameView& frame) const { return frame.sequence - first_->sequence; }
  double time_s(const FrameView& frame) const {
    if (is_live()) return 1e-9 * static_cast<double>(frame.time_ns - first_->time_ns);
    return static_cast<double>(number(frame)) / rate().per_second();
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
  std::optional<FrameView> first_;
  Image flipped_;
};

/// The camera that --calibration or --focal tells of.
std::optional<Camera> camera_of_frames(const Args& args, ImageSize size, std::ostream& err) {
  auto camera = calibration_of(args, size, err);
  if (camera && args.has("--mirror")) camera->cx = static_cast<float>(size.width - 1) - camera->cx;
  return camera;
}

/// The state in frame 0, from a file.
Beginning read_init(const Args& args, const ModelFile& file, ImageSize size, const std::string& frames,
                    std::ostream& err) {
  const std::string path = args.required("--init");
  const auto camera = camera_of_frames(args, size, err);
  const FitFile fit =
      read_start(path, file, size, frames, static_cast<float>(args.number("--focal", 0, 1, 1e6)), camera);
  Beginning start{fit.camera, fit.pose, std::vector<float>(file.model().parameters().count, 0.0f)};
  list_unmatched(apply(fit.parameters, path, file.model(), start.q.data()), path, err);
  if (!args.has("--model-landmarks")) start.landmarks = personal_landmarks(file.model(), fit);
  return start;
}

/// Null unless the track is to start by itself.
std::unique_ptr<DetectionStart> detection_start(const Args& args, const ModelFile& file, const Frames& frames,
                                                std::ostream& err) {
  if (args.required("--init") != "detect") {
    if (args.has("--search-frames")) fail_usage("--search-frames is for --init detect");
    return nullptr;
  }
  if (args.has("--markers")) fail_usage("--markers are of frame 0, which --init detect may not start in");
  const ImageSize size = frames.size();
  const auto focal =
      static_cast<float>(args.number("--focal", static_cast<double>(default_focal(size)), 1, 1e6));
  const auto known = camera_of_frames(args, size, err);
  const int most = args.integer("--search-frames", 300, 1, 1 << 30);
  return std::make_unique<DetectionStart>(
      file, size, known ? *known : centred_camera(size.width, size.height, focal), frames.name(), most, err);
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
    if (has_landmarks(args) && model.find_landmark(p.name.c_str()) != kNone)
      fail_input(p.where, "marker '" + p.name + "' has the name of a landmark, which is reported itself");
    markers.names.push_back(p.name);
    markers.x.push_back(p.x);
  }
  if (markers.x.size() > 4096) fail_input(*path, "more than 4096 markers");
  return markers;
}

/// The cues named, as the estimator's bits; all without the option.
std::uint8_t cues_of(const Args& args) {
  const auto text = args.text("--cues");
  if (!text) return EstimatorOptions{}.cues;
  std::uint8_t bits = 0;
  std::istringstream names(*text);
  for (std::string name; std::getline(names, name, ',');) {
    const Cue cue = name == "flow" ? Cue::flow : name == "edge" ? Cue::edge : Cue::patch;
    if (name != "patch" && cue == Cue::patch) fail_usage("--cues: patch, flow, edge, not " + name);
    bits = static_cast<std::uint8_t>(bits | 1u << static_cast<unsigned>(cue));
  }
  return bits;
}

/// One run: starts the tracker, feeds it, and starts it again where it started wrongly by itself.
class Run {
 public:
  Run(Frames& frames, Tracker& tracker, const TrackerOptions& options, const Markers& markers,
      TrackOutput& output, DetectionStart* detection)
      : frames_(frames),
        tracker_(tracker),
        options_(options),
        markers_(markers),
        output_(output),
        detection_(detection) {}

  Status start(const FrameView& frame, const Beginning& from) {
    const Status status = tracker_.start_from_pose(frame, from.camera, from.pose, from.q.data(), options_,
                                                   {markers_.x.data(), markers_.x.size()});
    if (status != Status::ok) return status;
    camera_ = from.camera;
    is_started_ = true;
    output_.place_landmarks(tracker_.estimator(), from.landmarks);
    output_.add(frames_.number(frame), frames_.time_s(frame), frame, tracker_, 0);
    return status;
  }
  void take(const FrameView& frame) {
    if (is_started_)
      follow(frame);
    else
      look(frame);
  }
  float focal_px() const { return camera_.f; }

 private:
  std::string where(const FrameView& frame) const {
    return frames_.name() + ": frame " + std::to_string(frames_.number(frame));
  }
  void look(const FrameView& frame) {
    const std::size_t number = frames_.number(frame);
    const auto found = detection_->find(frame, number);
    if (found && start(frame, *found) == Status::ok) return;
    if (found) detection_->refuse(number);
    output_.add_lost(number, frames_.time_s(frame), frame);
  }
  void follow(const FrameView& frame) {
    FrameResult result;
    const auto before = std::chrono::steady_clock::now();
    const Status status = tracker_.update(frame, &result);
    if (frames_.is_live() && status == Status::stale_frame) return;  // a camera's clock may stumble
    require(status, where(frame));
    const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - before;
    is_started_ = detection_ == nullptr || detection_->holds(frame, frames_.number(frame), tracker_);
    if (is_started_)
      output_.add(frames_.number(frame), frames_.time_s(frame), frame, tracker_, elapsed.count());
    else
      output_.add_lost(frames_.number(frame), frames_.time_s(frame), frame);
  }

  Frames& frames_;
  Tracker& tracker_;
  const TrackerOptions& options_;
  const Markers& markers_;
  TrackOutput& output_;
  DetectionStart* detection_;
  Camera camera_;
  bool is_started_ = false;
};

int run_track(const Args& args, Console& console) {
  args.required("--out");
  args.required("--init");
  TrackerOptions options;
  options.estimator.cues = cues_of(args);
  options.estimator.mesh_operations =
      static_cast<std::uint16_t>(args.integer("--mesh-operations", 0, 0, 1000));
  options.marker_exclusion_px = static_cast<float>(args.number("--marker-exclusion-px", 8, 0, 1000));
  const int last = args.integer("--count", 0, 1, 1 << 30);
  const ModelFile file(args.operand(0));
  const Model& model = file.model();
  const auto is_free = free_parameters(args, model);
  options.is_free = is_free.data();
  Frames frames(args.required("--frames"), args.has("--mirror"));
  const auto detection = detection_start(args, file, frames, console.err);
  std::optional<Beginning> start;
  if (detection == nullptr) start = read_init(args, file, frames.size(), frames.name(), console.err);
  const Markers markers = read_markers(args, model);

  FrameView frame;
  if (!frames.next(&frame))
    throw Failure(kBadInput, frames.message().empty() ? frames.name() + ": has no frames" : frames.message());
  TrackerLimits limits = tracker_limits(args, frames.size());
  limits.markers = static_cast<std::uint16_t>(markers.x.size());
  if (options.estimator.mesh_operations > 0) limits.texture_cells = 32;
  Owned<Tracker> tracker(model, limits);
  TrackOutput output(args, model, markers.names, frames.rate());
  Run run(frames, *tracker, options, markers, output, detection.get());
  if (start)
    require(run.start(frame, *start), frames.name() + ": frame 0");
  else
    run.take(frame);
  Progress progress(console, "frame");
  // A camera has no end of its own: Ctrl-C ends it, and what was tracked is kept.
  const InterruptWatch watch(frames.is_live());
  for (int count = 1; count != last && !watch.was_interrupted() && frames.next(&frame); ++count) {
    run.take(frame);
    progress.show(static_cast<std::size_t>(count) + 1);
  }
  if (detection != nullptr) detection->conclude();
  // A stream that breaks off leaves what came before it.
  console.out << output.commit(tracker.used_bytes(), run.focal_px()) << "\n";
  if (frames.message().empty()) return 0;
  throw Failure(kBadInput, frames.message());
}

}  // namespace

Command track_command() {
  return {
      "track",
      "Follows a model through a video, from a start in its first frame.",
      "face.plm --frames VIDEO.y4m|FOLDER|-|camera: --init fit.json|points.csv|detect --out track.csv "
      "[--landmarks|--model-landmarks] "
      "[--markers points.csv] [--marker-exclusion-px R] [--focal PX|--calibration camera.yml] [--mirror] "
      "[--freeze GROUP] "
      "[--refine-identity] [--search-frames N] [--profile s|l] [--cues LIST] [--mesh-operations N] [--count "
      "N] "
      "[--overlay out.y4m] [--sheet out.png] [--report report.html] [--truth truth.csv]",
      {{"--frames", "SOURCE",
        "a Y4M file, a folder of PGM or PPM, - for Y4M on standard input, or camera:[ID|INDEX][@WxH]"},
       {"--init", "START",
        "frame 0: a fit.json, or a points.csv that is fitted first; detect: where a face is found, by "
        "itself"},
       {"--search-frames", "N", "with --init detect: give up after so many frames without a face (300)"},
       {"--out", "CSV", "the track to write: a row a frame"},
       {"--landmarks", nullptr,
        "columns with the landmarks as well; those that START gave stay where it gave them on this face, "
        "as far as they were off the fitted model by more than noise"},
       {"--model-landmarks", nullptr, "the same columns, all where the model has them"},
       {"--markers", "CSV", "landmark,x,y in frame 0: points to follow and report, never to look at"},
       {"--marker-exclusion-px", "R", "how far from a marker patches keep (8)"},
       {"--focal", "PX", "focal length, when it is known"},
       {"--calibration", "YML", "intrinsics and lens, as OpenCV's calibration writes them"},
       {"--mirror", nullptr,
        "flip every frame first; start, markers and results are those of the flipped picture"},
       {"--freeze", "GROUP", "identity (default), or expression: follow the head only"},
       {"--refine-identity", nullptr, "let the identity move as well"},
       {"--profile", "s|l", "capacities of a small or a large device; else by the size of the picture"},
       {"--count", "N", "stop after so many frames"},
       {"--cues", "LIST", "what is looked at: patch,flow,edge (all)"},
       {"--mesh-operations", "N", "splits and welds a frame, so that the mesh follows view and texture (0)"},
       {"--overlay", "Y4M", "the video with the mesh on it"},
       {"--sheet", "PNG", "nine frames of that on one picture"},
       {"--truth", "CSV", "the truth of a rendered video, to compare with"},
       {"--report", "HTML",
        "a page with nine frames, and state, pose, parameters, times and memory as charts"}},
      1,
      run_track};
}

}  // namespace pliant::host
