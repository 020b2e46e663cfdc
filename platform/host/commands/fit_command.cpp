// `pliant fit`: shape and pose of a model in one picture.
#include "host/commands/calibration_option.hpp"
#include "host/commands/command.hpp"
#include "host/commands/image_fit.hpp"
#include "host/io/calibration.hpp"
#include "host/io/failure.hpp"
#include "host/io/files.hpp"
#include "host/io/numbers.hpp"
#include "host/io/owned.hpp"
#include "host/render/overlay.hpp"
#include "host/render/photo_texture.hpp"

namespace pliant::host {

namespace {

/// A flag a parameter: a group by name, all, none, or the first so many of the table.
std::vector<std::uint8_t> free_parameters(const Model& model, const std::optional<std::string>& choice) {
  if (!choice || *choice == "all") return {};
  std::vector<std::uint8_t> is_free(model.parameters().count, 0);
  const auto count = parse_number(*choice);
  const bool is_group = *choice == "identity" || *choice == "expression";
  if (!is_group && !(count && *count >= 0) && *choice != "none")
    fail_usage("--parameters: identity, expression, all, none or a count, not " + *choice);
  const Group group = *choice == "identity" ? Group::identity : Group::expression;
  for (std::size_t k = 0; k < is_free.size(); ++k)
    is_free[k] = is_group ? model.parameters()[k].group == group : count && static_cast<double>(k) < *count;
  return is_free;
}

/// The size from --size, --image or --pose; those that are there must agree.
ImageSize picture_size(const Args& args, const Image& picture, const std::optional<FitFile>& pose) {
  std::optional<ImageSize> size = args.size("--size");
  const auto agree = [&](int width, int height, const std::string& path) {
    if (size && (size->width != width || size->height != height))
      fail_input(path, "is of " + std::to_string(width) + "x" + std::to_string(height) + " pixels, not " +
                           std::to_string(size->width) + "x" + std::to_string(size->height));
    size = ImageSize{width, height};
  };
  if (!picture.pixels.empty()) agree(picture.width, picture.height, args.required("--image"));
  if (pose) agree(pose->width, pose->height, args.required("--pose"));
  if (!size) fail_usage("--size or --image is needed");
  return *size;
}

void draw_overlay(const std::string& path, const Model& model, const FitFile& fit, const Image& picture) {
  std::vector<float> q(model.parameters().count, 0.0f);
  apply(fit.parameters, path, model, q.data());
  Overlay overlay(picture.pixels.empty() ? Image(fit.width, fit.height, 1, 96) : to_grey(picture));
  overlay.draw_mesh(wire_of(model, fit, q));
  for (const FitPoint& p : fit.points) overlay.draw_residual(p.x, p.residual, p.used);
  Owned<Cascade> cascade(model);
  for (const auto& x :
       project_landmarks(model, *cascade, fit.pose, fit.camera, {fit.width, fit.height}, q.data()))
    if (x) overlay.draw_landmark(*x);
  char caption[64];
  std::snprintf(caption, sizeof caption, "RMS %.2f PX, %zu OF %zu POINTS", static_cast<double>(fit.rms_px),
                fit.inliers, fit.points.size());
  if (!fit.points.empty()) overlay.draw_caption(caption);
  write_file(path, encode_png(overlay.image()));
}

/// --method and what goes with it.
void read_method(const Args& args, FitSetup& setup) {
  const std::string method = args.text("--method").value_or("gauss-newton");
  setup.stiffness = static_cast<float>(args.number("--stiffness", 1, 0, 1e6));
  setup.euler.delta = static_cast<float>(args.number("--delta", 1e-3, 1e-12, 1e3));
  setup.euler.steps = static_cast<int>(args.number("--steps", 600, 1, 1e6));
  if (method == "gauss-newton") return;
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
  std::vector<float> q(model.parameters().count, 0.0f);
  apply(fit.parameters, path, model, q.data());
  write_file(path, textured_glb(model, fit, q, picture));
}

int run_fit(const Args& args, Console& console) {
  const std::string output = args.required("-o");
  if (!args.has("--points") && !args.has("--box") && !args.has("--pose"))
    fail_usage("one of --points, --box and --pose is needed");
  if (args.has("--box") && args.has("--pose")) fail_usage("--box and --pose exclude each other");
  if (args.has("--texture") && !args.has("--image")) fail_usage("--texture needs the photograph: --image");
  const auto box = args.numbers("--box", 4);
  const ModelFile file(args.operand(0));
  const Model& model = file.model();
  Image picture;
  if (const auto path = args.text("--image")) picture = read_image(*path);
  std::optional<FitFile> start;
  if (const auto path = args.text("--pose")) start = parse_fit(*path, read_file(*path));

  FitSetup setup;
  setup.size = picture_size(args, picture, start);
  setup.focal_px = static_cast<float>(args.number("--focal", 0, 1, 1e6));
  setup.camera = calibration_of(args, setup.size, console.err);
  setup.is_free = free_parameters(model, args.text("--parameters"));
  const std::string silhouette = args.text("--silhouette").value_or("match");
  if (silhouette != "match" && silhouette != "fixed")
    fail_usage("--silhouette: match or fixed, not " + silhouette);
  setup.match_silhouette = silhouette == "match";
  read_method(args, setup);
  setup.q.assign(model.parameters().count, 0.0f);
  FitFile fit;
  if (start) {
    list_unmatched(apply(start->parameters, args.required("--pose"), model, setup.q.data()),
                   args.required("--pose"), console.err);
    const View view = view_of(start->pose, start->camera);
    setup.view = setup.camera ? with_camera(view, *setup.camera) : with_focal(view, setup.focal_px);
    fit = fit_of_view(model, setup.size, *setup.view, setup.q);
    fit.camera = setup.camera.value_or(fit.camera);
  }
  if (box) {
    fit = fit_to_box(file, *box, setup);
    setup.view = view_of(fit.pose, fit.camera);
  }
  if (const auto points = args.text("--points"))
    fit = fit_to_points(file, *points, read_points(*points), setup);

  write_file(output, fit_text(fit));
  if (const auto path = args.text("--overlay")) draw_overlay(*path, model, fit, picture);
  if (const auto path = args.text("--texture")) write_textured(*path, model, fit, picture);
  console.out << output << ": " << fit.inliers << " of " << fit.points.size() << " points, rms "
              << number_text(static_cast<double>(fit.rms_px)) << " px, f "
              << number_text(static_cast<double>(fit.camera.f)) << " px\n";
  return 0;
}

}  // namespace

Command fit_command() {
  return {
      "fit",
      "Fits a model to one picture: pose, focal length and parameters.",
      "face.plm (--points points.csv | --box x,y,w,h | --pose fit.json) --size WxH [--image picture] "
      "[--focal PX|--calibration camera.yml] "
      "[--parameters GROUP|COUNT] [--silhouette match|fixed] -o fit.json [--overlay picture.png] [--texture "
      "face.glb]",
      {{"--points", "CSV",
        "landmark,x,y: landmarks of the model by name, at least four; with columns u,v any points of the "
        "surface"},
       {"--box", "X,Y,W,H", "a face detector's box; with --points, the start of the fit"},
       {"--pose", "JSON", "an earlier fit; with --points, the start of the fit"},
       {"--size", "WxH", "of the picture, where no --image tells"},
       {"--image", "FILE", "the picture, to draw on"},
       {"--focal", "PX", "focal length, when it is known"},
       {"--calibration", "YML", "intrinsics and lens, as OpenCV's calibration writes them"},
       {"--parameters", "CHOICE", "free ones: identity, expression, all (default), none, or the first COUNT"},
       {"--silhouette", "HOW",
        "ibug00 to ibug16: match them to the silhouette (default), or take them as fixed places of the "
        "surface"},
       {"--method", "NAME",
        "gauss-newton (default); euler, the published dynamics; preconditioned or barzilai-borwein, the same "
        "with steps "
        "that converge at any resolution"},
       {"--delta", "STEP", "step of --method euler; 0.001"},
       {"--steps", "N", "steps of the dynamics, a stage; 600"},
       {"--stiffness", "K", "weight of the prior on the parameters; 1; 0: the points alone"},
       {"-o", "JSON", "the fit to write"},
       {"--overlay", "PNG", "a picture of the fit"},
       {"--texture", "GLB", "the fitted model with the photograph on it"}},
      1,
      run_fit};
}

}  // namespace pliant::host
