// `pliant fit`: fits a model to one image.
#include <algorithm>
#include <cmath>
#include <functional>

#include "host/commands/calibration_option.hpp"
#include "host/commands/command.hpp"
#include "host/commands/face_finder.hpp"
#include "host/commands/image_fit.hpp"
#include "host/io/failure.hpp"
#include "host/io/files.hpp"
#include "host/io/ibug_names.hpp"
#include "host/io/numbers.hpp"
#include "host/io/owned.hpp"
#include "host/render/overlay.hpp"
#include "host/render/photo_texture.hpp"
#include "track/face_checks.hpp"
#include "track/landmark_fit.hpp"

namespace pliant::host {

namespace {

/// Which parameters --parameters selects, one flag each; empty: all, also where a count says so.
std::vector<std::uint8_t> free_parameters(const Model& model, const std::optional<std::string>& choice) {
  if (!choice || *choice == "all") return {};
  std::vector<std::uint8_t> is_free(model.parameters().count, 0);
  const auto count = parse_number(*choice);
  const bool is_group = *choice == "identity" || *choice == "expression";
  const bool is_count = count && *count >= 0 && *count == std::floor(*count);
  if (is_count && *count >= static_cast<double>(is_free.size())) return {};
  if (!is_group && !is_count && *choice != "none")
    fail_usage("--parameters: identity, expression, all, none or a count, not " + *choice);
  const Group group = *choice == "identity" ? Group::identity : Group::expression;
  for (std::size_t k = 0; k < is_free.size(); ++k)
    is_free[k] = is_group ? model.parameters()[k].group == group : count && static_cast<double>(k) < *count;
  return is_free;
}

/// The image size, from --size, --image or --pose. Bad input: they do not agree.
ImageSize image_size(const Args& args, const Image& image, const std::optional<FitFile>& pose) {
  std::optional<ImageSize> size = args.size("--size");
  const auto agree = [&](int width, int height, const std::string& path) {
    if (size && (size->width != width || size->height != height))
      fail_input(path, "has " + std::to_string(width) + "x" + std::to_string(height) + " pixels, not " +
                           std::to_string(size->width) + "x" + std::to_string(size->height));
    size = ImageSize{width, height};
  };
  if (!image.pixels.empty()) agree(image.width, image.height, args.required("--image"));
  if (pose) agree(pose->width, pose->height, args.required("--pose"));
  if (!size) fail_usage("--size or --image is needed");
  return *size;
}

void draw_overlay(const std::string& path, const Model& model, const FitFile& fit, const Image& picture) {
  const std::vector<float> q = all_parameters(fit, path, model);
  Overlay overlay(picture.pixels.empty() ? Image(fit.width, fit.height, 1, 96) : picture);
  overlay.draw_mesh(wire_of(model, fit, q));
  for (const FitPoint& p : fit.points) overlay.draw_residual(p.x, p.residual, p.used);
  Owned<Cascade> cascade(model);
  for (const auto& x :
       project_landmarks(model, *cascade, fit.pose, fit.camera, {fit.width, fit.height}, q.data()))
    if (x) overlay.draw_landmark(*x);
  char caption[64];
  std::snprintf(caption, sizeof caption, "rms %.2f px, %zu of %zu points", static_cast<double>(fit.rms_px),
                fit.inliers, fit.points.size());
  if (!fit.points.empty()) overlay.draw_caption(caption);
  write_file(path, encode_png(overlay.image()));
}

/// --method and the options of the methods.
void read_method(const Args& args, FitSetup& setup) {
  const std::string method = args.text("--method").value_or("gauss-newton");
  setup.stiffness =
      static_cast<float>(args.number("--stiffness", static_cast<double>(setup.stiffness), 0, 1e6));
  setup.euler.delta =
      static_cast<float>(args.number("--delta", static_cast<double>(setup.euler.delta), 1e-12, 1e3));
  setup.euler.steps = args.integer("--steps", setup.euler.steps, 1, 1000000);
  if (method != "euler") args.refuse({"--delta"}, "is the step of --method euler, not of " + method);
  if (method == "gauss-newton") {
    args.refuse({"--steps"},
                "are those of the dynamics: --method euler, preconditioned or barzilai-borwein is needed");
    return;
  }
  setup.method = FitMethod::euler;
  if (method == "euler")
    setup.euler.step = EulerStep::published;
  else if (method == "preconditioned")
    setup.euler.step = EulerStep::preconditioned;
  else if (method == "barzilai-borwein")
    setup.euler.step = EulerStep::barzilai_borwein;
  else
    fail_usage("--method: gauss-newton, euler, preconditioned or barzilai-borwein, not " + method);
}

void write_textured(const std::string& path, const Model& model, const FitFile& fit, const Image& picture) {
  write_file(path, textured_glb(model, fit, all_parameters(fit, path, model), picture));
}

void check_usage(const Args& args) {
  if (!args.has("--points") && !args.has("--box") && !args.has("--pose") && !args.has("--image"))
    fail_usage("one of --points, --box, --pose and --image is needed");
  if (args.has("--box") && args.has("--pose")) fail_usage("--box and --pose exclude each other");
  args.check_needs("--texture", "--image");
  args.check_needs("--box-of", "--box");
  args.check_needs("--silhouette", "--points");
}

/// Bad usage: an option of a fit to points, where a box or an earlier fit is taken as it is.
void check_fitted(const Args& args, bool is_fitted) {
  if (!is_fitted)
    args.refuse({"--parameters", "--method", "--delta", "--steps", "--stiffness"},
                "acts on a fit to points: --points is needed, or a picture in which a face is found");
}

bool matches_silhouette(const Args& args) {
  const std::string how = args.text("--silhouette").value_or("match");
  if (how != "match" && how != "fixed") fail_usage("--silhouette: match or fixed, not " + how);
  return how == "match";
}

/// Takes view and parameters of an earlier fit into the setup, and its camera if that has a lens, which no fit finds again.
/// \return the fit, with the camera of the setup.
FitFile initial_fit(FitFile earlier, const std::string& path, const Model& model, FitSetup& setup,
                    std::ostream& err) {
  list_unmatched(apply(earlier.parameters, path, model, setup.q.data()), path, err);
  set_camera(setup.focal_px, setup.camera, &earlier);
  const Camera& camera = earlier.camera;
  if (camera.k1 != 0 || camera.k2 != 0 || camera.aspect != 1) setup.camera = camera;
  setup.view = view_of(earlier.pose, camera);
  FitFile fit = fit_of_view(model, setup.size, *setup.view, setup.q);
  fit.camera = camera;
  return fit;
}

/// The most probable face of the picture, or the face in the box. Bad input: there is none.
FoundFace face_in(const Image& image, const std::string& path, const ModelFile& file, const FitSetup& setup,
                  const std::optional<FaceBox>& box) {
  FaceFinder finder(file);
  const Image grey = to_grey(image);
  std::optional<Camera> camera = setup.camera;
  if (!camera && setup.focal_px > 0) camera = centred_camera(image.width, image.height, setup.focal_px);
  if (box) {
    auto face = finder.align(grey, *box, camera);
    if (!face) fail_input(path, "the box is not in the picture");
    return *face;
  }
  auto faces = finder.find(grey, path, kLeastFaceScore, camera);
  if (faces.empty()) fail_input(path, "no face found");
  return faces[0];
}

/// The model fitted to the landmarks of an aligned face in the picture `path`.
FitFile fit_to_face(const ModelFile& file, const std::string& path, const FoundFace& face, FitSetup setup) {
  std::vector<NamedPoint> points;
  for (std::size_t k = 0; k < face.landmarks.size(); ++k) {
    const char* name = file.model().landmarks()[k].name;
    // The alignment finds those from the brows to the lips; those of the jaw follow the model.
    if (ibug_number(name) >= 17) points.push_back({name, face.landmarks[k], name});
  }
  setup.view = with_focal(view_of(face.aligned.pose, face.aligned.camera), setup.camera ? 0 : setup.focal_px);
  for (std::size_t k = 0; k < face.q.size(); ++k)
    if (setup.is_free.empty() || setup.is_free[k] != 0) setup.q[k] = face.q[k];
  FitFile fit = fit_to_points(file, path, points, setup);
  // A fit that may not move everything, or that has not converged, is farther from the face than the alignment.
  if (setup.is_free.empty() && setup.method == FitMethod::gauss_newton)
    fit.landmark_error = face.aligned.landmark_error;
  return fit;
}

/// Residual of the dynamics over that of the Gauss-Newton fit above which they have not converged. 600 steps of the published
/// dynamics reach 1.4 to 1.6 on photographs. Not tuned.
constexpr float kUnconvergedRatio = 1.2f;
/// Residual, px, that is as good as none: points of the model itself are fitted to less by all methods. Round value.
constexpr float kNegligiblePx = 0.05f;

/// Bad input: a fit by the dynamics that is farther from its points than the best one. It is written all the same, as is the track
/// of a film that is cut off.
void check_convergence(const FitFile& fit, const FitFile& best, const std::string& source) {
  if (fit.rms_px <= max(kUnconvergedRatio * best.rms_px, kNegligiblePx)) return;
  fail_input(source, "the dynamics have not converged, rms " + number_text(static_cast<double>(fit.rms_px)) +
                         " px instead of " + number_text(static_cast<double>(best.rms_px)) +
                         ": try --method preconditioned");
}

/// Tells what is probably wrong with a fit that could be made.
void warn_of(const FitFile& fit, bool has_points, Console& console) {
  if (fit.landmark_error > kFaceChecksTuning.most_landmark_error)
    console.err << "the landmarks are doubtful: it may be no face, or hidden in part\n";
  if (!has_points || fit.points.empty()) return;
  const auto is_outside = [&](const FitPoint& p) {
    return p.x.x < 0 || p.x.y < 0 || p.x.x > static_cast<float>(fit.width - 1) ||
           p.x.y > static_cast<float>(fit.height - 1);
  };
  const auto outside = std::count_if(fit.points.begin(), fit.points.end(), is_outside);
  if (2 * outside > static_cast<std::ptrdiff_t>(fit.points.size()))
    console.err << outside << " of " << fit.points.size() << " points lie outside of " << fit.width << "x"
                << fit.height << " pixels\n";
  if (rotation_matrix(fit.pose.q).m[2][2] < 0)
    console.err << "the surface shows its back: is y upwards in the points, are they mirrored, or is v 1 at "
                   "the top, as in OBJ files?\n";
}

FitSetup fit_setup(const Args& args, const Model& model, const ImageSize& size, std::ostream& err) {
  FitSetup setup;
  setup.size = size;
  setup.focal_px = focal_of(args, setup.size, err);
  setup.camera = calibration_of(args, setup.size, err);
  setup.is_free = free_parameters(model, args.text("--parameters"));
  setup.match_silhouette = matches_silhouette(args);
  read_method(args, setup);
  setup.q.assign(model.parameters().count, 0.0f);
  return setup;
}

void print_summary(const FitFile& fit, const std::string& output, std::ostream& out) {
  out << output << ": " << fit.inliers << " of " << fit.points.size() << " points, rms "
      << short_text(fit.rms_px) << " px, f " << short_text(fit.camera.f) << " px";
  if (fit.landmark_error > 0)
    out << ", expected landmark error " << decimal_text(static_cast<double>(fit.landmark_error))
        << " of the distance of the outer eye corners";
  out << "\n";
}

int run_fit(const Args& args, Console& console) {
  const std::string output = args.required("-o");
  check_usage(args);
  const auto box = box_of(args, "--box");
  const ModelFile file(args.operand(0));
  const Model& model = file.model();
  Image image;
  if (const auto path = args.text("--image")) image = read_image(*path);
  std::optional<FitFile> earlier;
  if (const auto path = args.text("--pose")) {
    earlier = parse_fit(*path, read_file(*path));
    check_model(*earlier, *path, file);
  }

  FitSetup setup = fit_setup(args, model, image_size(args, image, earlier), console.err);
  FitFile fit;
  if (earlier) fit = initial_fit(*earlier, args.required("--pose"), model, setup, console.err);
  std::optional<FaceBox> face_box;
  if (box) {
    fit = fit_to_box(file, *box, setup, &face_box.emplace());
    setup.view = view_of(fit.pose, fit.camera);
  }
  const auto points = args.text("--points");
  const bool aligns = !points && !earlier && ((!image.pixels.empty() && !model.aligner().empty()) || !box);
  check_fitted(args, points || aligns);
  std::function<FitFile(const FitSetup&)> make_fit;
  if (points)
    make_fit = [&, read = read_points(*points)](const FitSetup& how) {
      return fit_to_points(file, *points, read, how);
    };
  else if (aligns)
    make_fit = [&, face = face_in(image, args.required("--image"), file, setup, face_box)](
                   const FitSetup& how) { return fit_to_face(file, args.required("--image"), face, how); };
  if (make_fit) fit = make_fit(setup);

  write_file(output, fit_text(fit));
  if (const auto path = args.text("--overlay")) draw_overlay(*path, model, fit, image);
  if (const auto path = args.text("--texture")) write_textured(*path, model, fit, image);
  print_summary(fit, output, console.out);
  warn_of(fit, points.has_value(), console);
  if (make_fit && setup.method == FitMethod::euler) {
    FitSetup best = setup;
    best.method = FitMethod::gauss_newton;
    check_convergence(fit, make_fit(best), points ? *points : args.required("--image"));
  }
  return 0;
}

}  // namespace

Command fit_command() {
  return {
      "fit",
      "Fits a model to one image: pose, focal length and parameters. With --image alone it finds the face "
      "itself.",
      "face.plm (--image picture | --size WxH) [--points points.csv | --box x,y,w,h [--box-of WHOSE] | "
      "--pose fit.json] "
      "[--focal PX|--calibration camera.yml] [--parameters GROUP|COUNT] [--silhouette match|fixed] "
      "[--method NAME [--delta STEP] [--steps N]] [--stiffness K] "
      "-o fit.json [--overlay picture.png] [--texture face.glb]",
      {{"--points", "CSV",
        "landmark,x,y: at least four landmarks by name; with columns u,v also other points of the surface",
        Takes::input},
       {"--box", "X,Y,W,H",
        "where the face is: upper left corner and size; with --points, where the fit begins"},
       {"--box-of", "WHOSE",
        "pliant (default): as pliant detect writes it; opencv: the square of its cascades; landmarks: brows "
        "to "
        "chin, ear to ear"},
       {"--pose", "JSON", "an earlier fit; with --points, where the fit begins", Takes::input},
       {"--size", "WxH", "size of the image, 16 to 16384 pixels a side, if there is no --image"},
       {"--image", "FILE",
        "the image; the model is aligned with the face in it, unless points or a pose are given",
        Takes::input},
       {"--focal", "PX", "focal length, if known"},
       {"--calibration", "YML", "intrinsics and lens, as OpenCV's calibration writes them", Takes::input},
       {"--parameters", "CHOICE",
        "parameters to estimate: identity, expression, all (default), none, or the first COUNT"},
       {"--silhouette", "HOW",
        "ibug00 to ibug16: match them to the silhouette (default), or keep them at fixed surface points"},
       {"--method", "NAME",
        "gauss-newton (default); euler, the published dynamics, which do not converge on photographs of "
        "faces with "
        "the published step; preconditioned or barzilai-borwein, the same dynamics with steps that converge"},
       {"--delta", "STEP", "step of --method euler; 0.001, the published one"},
       {"--steps", "N", "steps of the dynamics in each stage; 600, the published number"},
       {"--stiffness", "K", "weight of the prior on the parameters; 1; 0: no prior"},
       {"-o", "JSON", "the fit to write", Takes::output},
       {"--overlay", "PNG", "a picture of the fit", Takes::output},
       {"--texture", "GLB", "the fitted model with the image as its texture", Takes::output}},
      1,
      run_fit};
}

}  // namespace pliant::host
