// `pliant track`: tracks a model through a video.
#include <algorithm>
#include <optional>

#include "host/commands/calibration_option.hpp"
#include "host/commands/command.hpp"
#include "host/commands/frame_stream.hpp"
#include "host/commands/image_fit.hpp"
#include "host/commands/initial_state.hpp"
#include "host/commands/track_output.hpp"
#include "host/commands/track_run.hpp"
#include "host/commands/tracker_limits.hpp"
#include "host/io/failure.hpp"
#include "host/io/files.hpp"
#include "host/io/interrupt.hpp"
#include "host/io/owned.hpp"
#include "pliant/tracker.hpp"

namespace pliant::host {

namespace {

/// Markers that a run takes at most, count.
constexpr std::size_t kMaxMarkers = 4096;

/// The camera that --calibration names; mirrored frames have a mirrored principal point.
std::optional<Camera> known_camera(const Args& args, ImageSize size, std::ostream& err) {
  auto camera = calibration_of(args, size, err);
  if (camera && args.has("--mirror")) camera->cx = static_cast<float>(size.width - 1) - camera->cx;
  return camera;
}

InitialOptions initial_options(const Args& args, ImageSize size, std::ostream& err) {
  InitialOptions options;
  options.camera = known_camera(args, size, err);
  options.focal_px = focal_of(args, size, err);
  return options;
}

/// Which parameters every frame estimates, one flag each: expressions, unless frozen.
std::vector<std::uint8_t> free_parameters(const Args& args, const Model& model) {
  const std::string freeze = args.text("--freeze").value_or("identity");
  if (freeze != "identity" && freeze != "expression")
    fail_usage("--freeze: identity or expression, not " + freeze);
  std::vector<std::uint8_t> is_free;
  for (const Parameter& p : model.parameters())
    is_free.push_back(p.group == Group::expression && freeze != "expression");
  return is_free;
}

bool is_in_picture(Vec2 x, ImageSize size) {
  return x.x >= -0.5f && x.y >= -0.5f && x.x <= static_cast<float>(size.width) - 0.5f &&
         x.y <= static_cast<float>(size.height) - 0.5f;
}

Markers read_markers(const Args& args, const Model& model, ImageSize size) {
  Markers markers;
  const auto path = args.text("--markers");
  if (!path) return markers;
  for (const NamedPoint& p : read_points(*path)) {
    if (has_landmarks(args) && model.find_landmark(p.name.c_str()) != kNone)
      fail_input(p.where, "marker '" + p.name + "' has the name of a landmark, which has columns of its own");
    if (!is_in_picture(p.x, size))
      fail_input(p.where, "marker '" + p.name + "' is outside the picture of " + std::to_string(size.width) +
                              "x" + std::to_string(size.height) + " pixels");
    markers.names.push_back(p.name);
    markers.x.push_back(p.x);
  }
  if (markers.x.empty()) fail_input(*path, "has no markers");
  if (markers.x.size() > kMaxMarkers)
    fail_input(*path, "more than " + std::to_string(kMaxMarkers) + " markers");
  return markers;
}

/// The cues that --cues names, as bits of EstimatorOptions::cues; without the option all of them.
std::uint8_t cues_of(const Args& args) {
  if (!args.has("--cues")) return EstimatorOptions{}.cues;
  std::uint8_t bits = 0;
  for (const std::string& name : args.list("--cues")) {
    const Cue cue = name == "flow" ? Cue::flow : name == "edge" ? Cue::edge : Cue::patch;
    if (name != "patch" && cue == Cue::patch) fail_usage("--cues: patch, flow, edge, not " + name);
    bits = static_cast<std::uint8_t>(bits | 1u << static_cast<unsigned>(cue));
  }
  const auto has = [bits](Cue cue) { return (bits >> static_cast<unsigned>(cue) & 1u) != 0; };
  if (has(Cue::flow) && !has(Cue::patch)) fail_usage("--cues: flow needs patch, whose fallback it is");
  return bits;
}

TrackerOptions tracker_options(const Args& args) {
  TrackerOptions options;
  options.estimator.cues = cues_of(args);
  options.estimator.mesh_operations =
      static_cast<std::uint16_t>(args.integer("--mesh-operations", 0, 0, 1000));
  options.marker_exclusion_px = static_cast<float>(
      args.number("--marker-exclusion-px", static_cast<double>(options.marker_exclusion_px), 0, 1000));
  options.keeps_landmark_offsets = !args.has("--model-landmarks");
  return options;
}

/// The limits that the command line asks for, of a tracker of frames of this size.
TrackerLimits asked_limits(const Args& args, const Model& model, const FrameStream& frames, ImageSize size) {
  TrackerLimits limits = with_base_mesh(tracker_limits(args, size), model);
  const bool searches = !model.detector().empty() || !model.print().empty();
  if (searches && !frames.is_live() && !args.has(kProfileOption.name))
    limits.search_work = whole_search(model, limits);
  return args.has("--freeze") ? without_second_look(without_person(limits)) : limits;
}

/// The same with room for what this run was given.
TrackerLimits with_room(TrackerLimits limits, const TrackerOptions& options, const Markers& markers,
                        const std::optional<Initial>& initial) {
  limits.markers = static_cast<std::uint16_t>(markers.x.size());
  if (options.estimator.mesh_operations > 0) limits.surface_texture = &kSurfaceTexture;
  const auto* landmarks = initial ? std::get_if<InitialLandmarks>(&*initial) : nullptr;
  if (landmarks != nullptr)
    limits.start_points = std::max(limits.start_points, static_cast<std::uint16_t>(landmarks->points.size()));
  return limits;
}

void check_start(const Args& args) {
  if (args.has("--init") && args.has("--box")) fail_usage("--init and --box exclude each other");
  if (args.has("--markers") && !args.has("--init") && !args.has("--box"))
    fail_usage("--markers are points of frame 0: --init or --box is needed");
  if (args.has("--landmarks") && args.has("--model-landmarks"))
    fail_usage("--landmarks and --model-landmarks exclude each other");
  args.check_needs("--box-of", "--box");
  args.check_needs("--marker-exclusion-px", "--markers");
}

/// What the track starts from; nothing: it finds the face itself.
std::optional<Initial> initial_of(const Args& args, const ModelFile& file, const FrameStream& frames,
                                  const InitialOptions& how, std::ostream& err) {
  if (const auto box = box_of(args, "--box")) return *box;
  const auto path = args.text("--init");
  if (!path) return std::nullopt;
  return read_initial(*path, file, frames.size(), frames.name(), how, err);
}

/// Bad usage where the profile has no memory for what is asked.
void check_profile(const Args& args, const TrackerOptions& options) {
  const TrackerLimits limits = tracker_limits(args, std::nullopt);
  const std::string profile = kProfileOption.name + (" " + args.text(kProfileOption.name).value_or("m"));
  if (options.estimator.mesh_operations > 0 && limits.mesh_following == nullptr)
    fail_usage("--mesh-operations does not apply to " + profile +
               ", which has no memory for mesh adaptation");
  if (!args.has("--cues")) return;
  const bool lacks_edges = limits.edges == nullptr && options.estimator.uses(Cue::edge);
  const bool lacks_flow = !limits.keeps_previous && options.estimator.uses(Cue::flow);
  if (lacks_edges || lacks_flow)
    fail_usage("--cues: " + profile + " has no cue " + (lacks_edges ? "edge" : "flow"));
}

/// Edges that --cues asks for, of a model without curves.
void warn_of_edges(const Args& args, const TrackerOptions& options, const Model& model, std::ostream& err) {
  const auto is_matched = [](const Curve& c) { return c.kind != CurveKind::boundary; };
  const bool has_curves = std::any_of(model.curves().begin(), model.curves().end(), is_matched);
  if (args.has("--cues") && options.estimator.uses(Cue::edge) && !has_curves)
    err << "--cues: " << args.operand(0)
        << " has no curves: its only edge is its silhouette, which a flat surface lacks"
        << (options.estimator.uses(Cue::patch) ? "" : "; patch finds its texture") << "\n";
}

/// Bad input: there is no frame, or it is too small or too large for a track.
FrameView first_frame(const Args& args, FrameStream& frames) {
  FrameView frame;
  if (!frames.next(&frame))
    throw Failure(kBadInput, frames.message().empty() ? frames.name() + ": has no frames" : frames.message());
  const ImageSize size = frames.size();
  if (check(tracker_limits(args, size)) != Status::ok)
    throw Failure(kBadInput, frames.name() + ": a track needs frames of 64 to 16,384 pixels a side, not " +
                                 std::to_string(size.width) + "x" + std::to_string(size.height));
  return frame;
}

/// Aspects of pixels with which upright detection misses no more faces than with square ones: as kUprightFaceDetection says.
constexpr float kLeastUprightAspect = 0.67f, kMostUprightAspect = 1.5f;

/// Profile S searches frames as they are (kUprightFaceDetection).
void warn_of_pixels(const Args& args, const InitialOptions& how, std::ostream& err) {
  if (args.text(kProfileOption.name).value_or("m") != "s" || !how.camera) return;
  const float aspect = how.camera->aspect;
  if (aspect < kLeastUprightAspect || aspect > kMostUprightAspect)
    err << kProfileOption.name << " s: some faces are not found, the camera's pixels are far from square\n";
}

int run_track(const Args& args, Console& console) {
  args.required("--out");
  check_start(args);
  TrackerOptions options = tracker_options(args);
  check_profile(args, options);
  const int last = args.integer("--count", 0, 1, 1 << 30);
  const ModelFile file(args.operand(0));
  const Model& model = file.model();
  const auto is_free = free_parameters(args, model);
  options.is_free = is_free.data();
  const std::string lack = lack_of(model, tracker_limits(args, std::nullopt), is_free);
  if (!lack.empty()) fail_input(file.path(), lack);
  warn_of_edges(args, options, model, console.err);
  FrameStream frames(args.required("--frames"), args.has("--mirror"));
  const InitialOptions initial_how = initial_options(args, frames.size(), console.err);
  const std::optional<Initial> initial = initial_of(args, file, frames, initial_how, console.err);
  const Markers markers = read_markers(args, model, frames.size());

  FrameView frame = first_frame(args, frames);
  const auto make_tracker = [&](ImageSize size) {
    const TrackerLimits asked = asked_limits(args, model, frames, size);
    return std::make_unique<Owned<Tracker>>(model, with_room(asked, options, markers, initial));
  };
  std::size_t expected = frames.count();
  if (last > 0 && expected > 0) expected = std::min(expected, static_cast<std::size_t>(last));
  TrackOutput output(args, model, markers.names, frames.rate(), expected);
  if (args.has("--arkit")) ArkitExpression(model).list_unmatched(file.path(), console.err);
  TrackRun run(frames, make_tracker, options, markers, output, console.err);
  if (initial) {
    run.start(frame, *initial, initial_how);
  } else {
    warn_of_pixels(args, initial_how, console.err);
    run.search(frame, initial_how, file.path());
  }
  Progress progress(console, "frame", expected);
  // Ctrl-C ends the track, and the result is kept.
  const InterruptWatch watch;
  const auto goes_on = [&] { return !watch.was_interrupted() && output.goes_on(); };
  for (int count = 1; count != last && goes_on() && frames.next(&frame); ++count) {
    run.track(frame);
    progress.show(static_cast<std::size_t>(count) + 1);
  }
  // Also where the stream was cut off or a picture could not be written: the frames before that have their rows.
  console.out << output.commit(run.used_bytes(), run.focal_px()) << "\n";
  if (output.has_no_pose())
    console.err << frames.name() << ": " << (model.print().empty() ? "no face" : "no print")
                << " was found in any frame\n";
  if (output.has_doubtful_truth())
    console.err << args.required("--truth") << ": most of its landmarks lie outside the frames, which are "
                << frames.size().width << "x" << frames.size().height << "\n";
  if (!frames.note().empty()) console.err << frames.note() << "\n";
  if (!output.failure().empty()) throw Failure(kBadInput, output.failure());
  if (watch.was_interrupted()) return frames.is_live() ? 0 : kInterrupted;
  if (frames.message().empty()) return 0;
  throw Failure(kBadInput, frames.message());
}

}  // namespace

Command track_command() {
  return {
      "track",
      "Tracks a face or another surface through a video. Without --init or --box it finds the face, or the "
      "printed surface, itself.",
      "face.plm --frames VIDEO|FOLDER|-|camera: --out track.csv|- [--init fit.json|points.csv|--box "
      "X,Y,W,H [--box-of WHOSE]] "
      "[--landmarks|--model-landmarks] [--arkit] [--markers points.csv] [--marker-exclusion-px R] "
      "[--focal PX|--calibration camera.yml] [--mirror] [--freeze GROUP] "
      "[--profile s|m|l] [--cues LIST] [--mesh-operations N] [--count N] "
      "[--overlay out.y4m] [--show] [--sheet out.png] [--report report.html] [--truth truth.csv]",
      {{"--frames", "SOURCE",
        "a video (other formats than Y4M need the program ffmpeg), a folder of PNG, JPEG or PNM pictures, - "
        "for Y4M "
        "on standard input, or camera:[ID|INDEX][@WxH]",
        Takes::input},
       {"--init", "INITIAL", "the initial state in frame 0: a fit.json, or a points.csv to fit the model to",
        Takes::input},
       {"--box", "X,Y,W,H", "the face in frame 0: upper left corner and size, as pliant detect writes it"},
       {"--box-of", "WHOSE",
        "pliant (default); opencv: the square of its cascades; landmarks: brows to chin, ear to ear"},
       {"--out", "CSV",
        "the track to write, one row a frame: to - or a pipe each as soon as it is known; a file appears "
        "when the track ends",
        Takes::output},
       {"--landmarks", nullptr,
        "also write the image position of every landmark; a landmark of --init keeps its offset from the "
        "fitted model, as far as noise does not explain the offset"},
       {"--model-landmarks", nullptr, "also write the image position of every landmark, all without offsets"},
       {"--arkit", nullptr,
        "write ARKit's 52 coefficients, each from 0 to 1, instead of the model's parameters"},
       {"--markers", "CSV",
        "landmark,x,y in frame 0 of a track with --init or --box: points to track with the surface and to write, which "
        "the tracker never uses",
        Takes::input},
       {"--marker-exclusion-px", "R", "distance that templates keep from markers (8)"},
       {"--focal", "PX", "focal length, if known"},
       {"--calibration", "YML", "intrinsics and lens, as OpenCV's calibration writes them", Takes::input},
       {"--mirror", nullptr,
        "mirror every frame first; initial state, markers and results are those of the mirrored frames"},
       {"--freeze", "GROUP",
        "keep the start's parameters: identity, which else follows what a head that turns far shows of it; "
        "or expression, which keeps both, so that the pose alone is tracked"},
       {"--profile", "s|m|l",
        "capacities for a small, medium or large device; default: by the frames' width"},
       {"--count", "N", "stop after N frames"},
       {"--cues", "LIST", "observations to use, of patch,flow,edge (all)"},
       {"--mesh-operations", "N",
        "splits and welds per frame, 0 to 1000, with which the mesh adapts to view and texture (0)"},
       {"--overlay", "Y4M", "the video with the mesh drawn on it", Takes::output},
       {"--show", nullptr,
        "play that video while it is made, through the program ffplay; closing the window ends the track"},
       {"--sheet", "PNG", "nine frames of the overlay in one picture", Takes::output},
       {"--truth", "CSV", "the truth of a rendered video, to compare the track with", Takes::input},
       {"--report", "HTML",
        "a page with nine frames, and charts of state, pose, parameters, times and memory", Takes::output}},
      1,
      run_track};
}

}  // namespace pliant::host
