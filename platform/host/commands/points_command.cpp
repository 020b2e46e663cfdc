// `pliant points`: writes a page with the model's landmarks over a photograph, on which a person corrects them (the paper,
// section 6).
#include <algorithm>
#include <cstdio>
#include <optional>
#include <set>

#include "host/commands/calibration_option.hpp"
#include "host/commands/command.hpp"
#include "host/commands/face_finder.hpp"
#include "host/commands/frame_stream.hpp"
#include "host/commands/image_fit.hpp"
#include "host/commands/points_surface.hpp"
#include "host/io/bounding_box.hpp"
#include "host/io/calibration.hpp"
#include "host/io/csv.hpp"
#include "host/io/failure.hpp"
#include "host/io/files.hpp"
#include "host/io/ibug_names.hpp"
#include "host/io/json.hpp"
#include "host/io/owned.hpp"
#include "host/io/page.hpp"
#include "host/render/overlay.hpp"
#include "host/render/scene.hpp"
#include "track/landmark_fit.hpp"

namespace pliant::host {

namespace {

/// Without a start the model is in the middle of the picture, at this fraction of its height: a usual portrait.
constexpr float kFilledPicture = 0.6f;
/// Cosine of the angle between the view ray and the outward normal above which a landmark starts switched off. More than 0,
/// because landmarks of the silhouette are at 0. Chosen by eye.
constexpr float kTurnedAway = 0.4f;
/// Distance in the chart over which the surface's normal is averaged: wider than the creases of lids and lips.
constexpr float kNeighbourhood = 0.03f;

/// iBUG landmarks that the page joins by a line, if the model has them.
struct Chain {
  int first, last;  // ibug
  bool is_closed;
};
constexpr Chain kChains[] = {{0, 16, false},  {17, 21, false}, {22, 26, false},
                             {27, 30, false}, {31, 35, false}, {36, 41, true},
                             {42, 47, true},  {48, 59, true},  {60, 67, true}};

/// Numbers and commas alone: how many there must be is for box_of to say.
bool is_box(const std::string& text) {
  return text.find(',') != std::string::npos &&
         text.find_first_not_of("0123456789.,-+eE ") == std::string::npos;
}

/// The text of the file that --start names, if it names one: read once, since it may be a pipe.
std::optional<std::string> start_text(const Args& args) {
  const auto start = args.text("--start");
  return start && !is_box(*start) ? std::optional(read_file(*start)) : std::nullopt;
}

FitFile start_of(const Args& args, const std::optional<std::string>& text, const ModelFile& file,
                 const Image& image, const std::string& path, std::ostream& err) {
  FitSetup setup;
  setup.size = {image.width, image.height};
  setup.focal_px = focal_of(args, setup.size, err);
  setup.camera = calibration_of(args, setup.size, err);
  const auto start = args.text("--start");
  if (args.has("--box-of") && !(start && is_box(*start))) fail_usage("--box-of needs a box as --start");
  if (start && is_box(*start)) return fit_to_box(file, *box_of(args, "--start"), setup);
  if (start) {
    FitFile fit = fit_in(*start, *text, file, setup.size, path, setup.focal_px, setup.camera);
    if (is_fit(*text)) fit.points.clear();  // the points of the fit are not needed
    return fit;
  }
  std::vector<float> q(file.model().parameters().count, 0.0f);
  const float f = setup.focal_px > 0 ? setup.focal_px : default_focal(setup.size);
  const Camera camera = setup.camera.value_or(centred_camera(image.width, image.height, f));
  Pose pose = frontal_pose(file.model(), q.data(), camera, image.height, kFilledPicture);
  if (!file.model().aligner().empty()) {
    const auto faces = FaceFinder(file).find(to_grey(image), path, kLeastFaceScore, camera);
    if (!faces.empty()) pose = faces[0].aligned.pose, q = faces[0].q;
  }
  FitFile fit = fit_of_view(file.model(), setup.size, view_of(pose, camera), q);
  fit.camera = camera;
  return fit;
}

/// A place on the surface that the page shows.
struct Handle {
  std::string name;
  Vec2 uv;
};

/// The points of --start, if it names a file of points.
struct GivenPoints {
  std::vector<NamedPoint> all;
  /// Those that the model put where they are, and no person: with a 0 in the column `placed`, which the page writes.
  std::set<std::string> followers;

  bool have_uv() const {
    return std::any_of(all.begin(), all.end(), [](const NamedPoint& p) { return p.uv.has_value(); });
  }
};

GivenPoints points_in(const std::string& path, const std::string& text) {
  GivenPoints given;
  if (is_fit(text)) return given;
  given.all = parse_points(path, text);
  const CsvTable table(path, text);
  const auto placed = table.find_column("placed");
  const std::size_t name = table.column("landmark");
  for (std::size_t row = 0; placed && row < table.row_count(); ++row)
    if (table.cell(row, *placed) == "0") given.followers.insert(table.cell(row, name));
  return given;
}

/// Whether a fit needs points of the chart beside the landmarks.
bool has_few_landmarks(const Model& model) {
  return model.landmarks().count < kLeastFitPoints;
}

/// The landmarks; of a model that has few, also the vertices nearest to the corners, sides and middle of the part of the chart that
/// the surface takes. Given points with a (u,v) of their own are there as well, under their names.
std::vector<Handle> handles_of(const Model& model, const std::vector<NamedPoint>& given) {
  std::vector<Handle> handles;
  for (const Landmark& l : model.landmarks()) handles.push_back({l.name, l.uv()});
  const BoundingBox<Vec2> taken({model.base_uv().begin(), model.base_uv().end()});
  for (int k = 0; has_few_landmarks(model) && k < 9; ++k) {
    const Vec2 half = 0.5f * taken.size();
    const Vec2 wanted =
        taken.low + Vec2{half.x * static_cast<float>(k % 3), half.y * static_cast<float>(k / 3)};
    Vec2 uv = model.base_uv()[0];
    for (const Vec2 other : model.base_uv())
      if (length(other - wanted) < length(uv - wanted)) uv = other;
    char name[32];
    std::snprintf(name, sizeof name, "uv_%.2f_%.2f", static_cast<double>(uv.x), static_cast<double>(uv.y));
    const bool is_new = std::none_of(handles.begin(), handles.end(), [&](const Handle& h) {
      return h.name == name || !(length(h.uv - uv) > 0);
    });
    if (is_new) handles.push_back({name, uv});
  }
  for (const NamedPoint& p : given) {
    if (!p.uv) continue;
    const auto same =
        std::find_if(handles.begin(), handles.end(), [&](const Handle& h) { return h.name == p.name; });
    if (same != handles.end())
      same->uv = *p.uv;
    else
      handles.push_back({p.name, *p.uv});
  }
  return handles;
}

/// Image positions of the handles at the start, their normals, whether they are wanted and whether they are placed. Counts those
/// that are switched on: wanted and turned to the camera, or placed.
/// \param followers  given points that are not placed.
Json points_at(const Model& model, const FitFile& start, const std::vector<float>& q,
               const std::vector<Handle>& handles, const std::set<std::string>& followers,
               std::size_t* on_count) {
  Owned<Cascade> cascade(model);
  cascade->select(q.data());
  const Projector projector(view_of(start.pose, start.camera), true);
  const Lens lens = lens_of(start.camera, {start.width, start.height});
  const bool has_68 = model.find_landmark("ibug00") != kNone && model.find_landmark("ibug67") != kNone;
  Json points = Json::array();
  for (const Handle& handle : handles) {
    const Vec2 uv = handle.uv;
    const auto at = [&](float du, float dv) {
      return cascade->selected_point(
          {clamp(uv.x + du * kNeighbourhood, 0, 1), clamp(uv.y + dv * kNeighbourhood, 0, 1)});
    };
    const Vec3 p = at(0, 0);
    const Vec3 normal = normalised(cross(at(0, 1) - at(0, -1), at(1, 0) - at(-1, 0)));
    Vec2 x{-100, -100};
    const bool is_seen = projector.project(p, &x) &&
                         dot(projector.rotated(normal), normalised(projector.to_camera(p))) < kTurnedAway;
    x = lens.distort(x);
    // The five points of eyes, nose and mouth add nothing to the 68. Of given points, only those are wanted.
    bool is_wanted = start.points.empty() && (!has_68 || handle.name.compare(0, 4, "ibug") == 0),
         is_placed = false;
    for (const FitPoint& given : start.points) {
      if (given.landmark != handle.name) continue;
      is_wanted = true;
      is_placed = followers.count(handle.name) == 0;
      if (is_placed) x = given.x;
    }
    *on_count += is_placed || (is_wanted && is_seen);
    points.push_back(Json::object({{"name", handle.name},
                                   {"u", uv.x},
                                   {"v", uv.y},
                                   {"x", x.x},
                                   {"y", x.y},
                                   {"normal", {normal.x, normal.y, normal.z}},
                                   {"wanted", is_wanted},
                                   {"placed", is_placed}}));
  }
  return points;
}

Json chains() {
  Json out;
  for (const Chain& chain : kChains) {
    Json names;
    for (int k = chain.first; k <= chain.last; ++k) names.push_back(ibug_name(k));
    out.push_back(Json::object({{"closed", chain.is_closed}, {"names", names}}));
  }
  return out;
}

/// What the page shows.
struct Photograph {
  std::string path;
  Image image;
  std::string address;  ///< of the picture in the page
};

/// The picture of --image, or the first frame of --frames.
Photograph photograph_of(const Args& args) {
  if (args.has("--image") == args.has("--frames")) fail_usage("one of --image and --frames is needed");
  if (args.has("--image")) {
    const std::string path = args.required("--image");
    const std::string bytes = read_file(path);
    const Image image = image_in(path, bytes);
    return {path, image, picture_address(image, bytes)};
  }
  FrameStream stream(args.required("--frames"), false);
  FrameView frame;
  if (!stream.next(&frame) && stream.message().empty()) fail_input(stream.name(), "has no frames");
  if (!stream.message().empty()) throw Failure(kBadInput, stream.message());
  const Image image = stream.picture(frame);
  return {stream.name(), image, png_address(image)};
}

int run_points(const Args& args, Console& console) {
  const std::string output = args.required("-o");
  const Photograph photograph = photograph_of(args);
  const std::string& path = photograph.path;
  const Image& image = photograph.image;
  const ModelFile file(args.operand(0));
  const Model& model = file.model();
  const auto text = start_text(args);
  const FitFile start = start_of(args, text, file, image, path, console.err);
  const std::vector<float> q = all_parameters(start, args.text("--start").value_or(path), model);
  const GivenPoints given = text ? points_in(*args.text("--start"), *text) : GivenPoints{};
  const bool has_uv = has_few_landmarks(model) || given.have_uv();
  const std::vector<Handle> handles = handles_of(model, given.all);
  std::vector<Vec2> uv;
  for (const Handle& handle : handles) uv.push_back(handle.uv);
  std::size_t on_count = 0;
  const Json data = Json::object({{"width", image.width},
                                  {"height", image.height},
                                  {"points", points_at(model, start, q, handles, given.followers, &on_count)},
                                  {"turnedAway", kTurnedAway},
                                  {"surface", page_surface(model, start, q, uv)},
                                  {"hasUv", has_uv},
                                  {"chains", chains()},
                                  {"picture", photograph.address}});
  const std::string title = path.substr(path.find_last_of('/') + 1);
  write_file(output, fill_page(kPointsPage, {{"title", html_text(title)},
                                             {"data", script_json(json_text(data))},
                                             {"fit", kSurfaceFitScript},
                                             {"file", kPointsFileScript},
                                             {"script", kPointsScript}}));
  console.out << output << ": " << handles.size() << (has_uv ? " points of the chart, " : " landmarks, ")
              << on_count
              << " switched on; open it in a browser, and save points.csv for `pliant "
              << (args.has("--frames") ? "track --init" : "fit --points") << "`\n";
  return 0;
}

}  // namespace

Command points_command() {
  return {
      "points",
      "Writes a page with the model over a picture, with handles at its landmarks, or at points of its chart "
      "as well if it has fewer than four. They can be moved, switched off and saved; the model follows those "
      "that are moved.",
      "face.plm (--image picture | --frames VIDEO|FOLDER) [--start fit.json|points.csv|X,Y,W,H] "
      "[--box-of WHOSE] [--focal PX|--calibration camera.yml] "
      "-o points.html",
      {{"--image", "FILE", "the photograph; the page contains it", Takes::input},
       {"--frames", "VIDEO",
        "instead: a video or a folder of pictures, of which the page shows the first frame, as pliant track "
        "--init needs it",
        Takes::input},
       {"--start", "START",
        "a fit.json, a points.csv (which is fitted) or a face box (default: the face that is found, else the "
        "middle)",
        Takes::input},
       {"--box-of", "WHOSE",
        "of a face box: pliant (default), as pliant detect writes it; opencv: the square of its cascades; landmarks: brows to "
        "chin, ear to ear"},
       {"--focal", "PX", "focal length, pixels, if known"},
       {"--calibration", "YML", "intrinsics and lens, as OpenCV's calibration writes them", Takes::input},
       {"-o", "HTML", "the page to write; it needs no network", Takes::output}},
      1,
      run_points};
}

}  // namespace pliant::host
