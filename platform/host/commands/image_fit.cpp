#include "host/commands/image_fit.hpp"

#include <algorithm>

#include "host/io/failure.hpp"
#include "host/io/owned.hpp"
#include "host/io/words.hpp"
#include "pliant/fit.hpp"
#include "track/landmark_fit.hpp"
#include "track/offset_landmarks.hpp"
#include "track/start_fit.hpp"

namespace pliant::host {

namespace {

/// Points that a fit takes at most, count. Far more than a person or a detector gives.
constexpr std::size_t kMaxPoints = 2048;
/// A parameter is reported as unseen if the fit leaves more than this fraction of its prior's standard deviation. Round
/// value, not tuned.
constexpr float kUnseenFraction = 0.95f;

Vec2 landmark_uv(const ModelFile& file, const NamedPoint& p) {
  const std::uint16_t k = file.model().find_landmark(p.name.c_str());
  if (k == kNone) fail_input(p.where, "landmark '" + p.name + "' is not in " + file.path());
  return file.model().landmarks()[k].uv();
}

std::vector<Correspondence> correspondences(const ModelFile& file, const std::string& source,
                                            const std::vector<NamedPoint>& points, bool match_silhouette) {
  if (points.size() < kLeastFitPoints)
    fail_input(source, "too few points: " + std::to_string(points.size()) + ", at least " +
                           std::to_string(kLeastFitPoints) + " are needed");
  if (points.size() > kMaxPoints) fail_input(source, "more than " + std::to_string(kMaxPoints) + " points");
  std::vector<Correspondence> out;
  for (const NamedPoint& p : points) {
    const bool is_silhouette = match_silhouette && !p.uv && is_silhouette_landmark(p.name.c_str());
    out.push_back({p.uv ? *p.uv : landmark_uv(file, p), p.x, 1, is_silhouette});
  }
  if (!(spread_of({out.data(), out.size()}) >= kLandmarkFitTuning.least_spread_px))
    fail_input(source, "the points do not determine the pose: all lie within a few pixels");
  return out;
}

NamedValues by_name(const Model& model, const std::vector<float>& values) {
  NamedValues out;
  for (std::size_t k = 0; k < values.size(); ++k) out.emplace_back(model.parameters()[k].name, values[k]);
  return out;
}

}  // namespace

float default_focal(const ImageSize& size) {
  return start_camera(nullptr, 0, size.width, size.height).f;
}

View with_focal(const View& view, float focal_px) {
  View out = view;
  if (focal_px > 0) out.rho = clamp(view.s / focal_px, kMinRho, kMaxRho);
  if (focal_px > 0) out.s = out.rho * focal_px;
  return out;
}

View with_camera(const View& view, const Camera& camera) {
  View out = with_focal(view, camera.f);
  const Vec2 moved = view.c - Vec2{camera.cx, camera.cy};
  out.c = {camera.cx, camera.cy};
  out.tau = view.tau + (1.0f / out.s) * moved;
  return out;
}

FitFile fit_of_view(const Model& model, const ImageSize& size, const View& view,
                    const std::vector<float>& q) {
  FitFile fit;
  fit.model_crc = model.crc();
  fit.width = size.width;
  fit.height = size.height;
  fit.camera = camera_of(view);
  fit.pose = pose_of(view);
  fit.parameters = by_name(model, q);
  std::vector<float> prior_sd;
  for (const Parameter& p : model.parameters()) {
    prior_sd.push_back(p.sd);
    fit.unseen.push_back(p.name);
  }
  fit.sd = by_name(model, prior_sd);
  return fit;
}

void check_points(const ModelFile& file, const std::string& source, const std::vector<NamedPoint>& points) {
  (void)correspondences(file, source, points, true);
}

FitFile fit_to_points(const ModelFile& file, const std::string& source, const std::vector<NamedPoint>& points,
                      const FitSetup& setup) {
  const Model& model = file.model();
  auto pairs = correspondences(file, source, points, setup.match_silhouette);
  std::vector<float> q = setup.q;
  q.resize(model.parameters().count, 0.0f);
  FitOptions options;
  options.width = setup.size.width;
  options.height = setup.size.height;
  options.focal_px = setup.focal_px;
  options.camera = setup.camera ? &*setup.camera : nullptr;
  options.start = setup.view ? &*setup.view : nullptr;
  options.is_free = setup.is_free.empty() ? nullptr : setup.is_free.data();
  options.method = setup.method;
  options.euler = setup.euler;
  options.stiffness = setup.stiffness;
  Owned<LandmarkFit> fitter(model, pairs.size());
  const Status status = fitter->fit({pairs.data(), pairs.size()}, options, q.data());
  if (status == Status::underdetermined && setup.method == FitMethod::euler)
    fail_input(source, "the dynamics diverged: a smaller --delta, or --method preconditioned");
  require(status, source);
  const FitReport& report = fitter->report();
  const std::vector<float> sd(fitter->sd(), fitter->sd() + q.size());

  FitFile fit = fit_of_view(model, setup.size, report.view, q);
  if (setup.camera)
    fit.camera = *setup.camera;
  else if (setup.focal_px > 0)
    fit.camera.f = setup.focal_px;  // of the view the quotient is rounded
  fit.sd = by_name(model, sd);
  fit.unseen.clear();
  for (std::size_t k = 0; k < sd.size(); ++k)
    if ((setup.is_free.empty() || setup.is_free[k] != 0) &&
        sd[k] > kUnseenFraction * model.parameters()[k].sd)
      fit.unseen.push_back(model.parameters()[k].name);
  fit.rms_px = report.rms_px;
  fit.inliers = report.used;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    fit.points.push_back({points[i].name, pairs[i].x, fitter->residuals()[i], fitter->weights()[i] > 0,
                          !points[i].uv && !fitter->has_slid(i)});
  return fit;
}

std::vector<NamedPoint> person_landmarks(const Model& model, const FitFile& fit) {
  std::vector<Correspondence> points;
  std::vector<Vec2> residuals;
  std::vector<std::uint8_t> is_landmark;
  std::vector<NamedPoint> landmarks;
  for (const FitPoint& p : fit.points) {
    const std::uint16_t k = model.find_landmark(p.landmark.c_str());
    const Landmark at = k == kNone ? Landmark{} : model.landmarks()[k];
    points.push_back({at.uv(), p.x});
    residuals.push_back(p.residual);
    is_landmark.push_back(k != kNone && p.used && p.is_landmark);
    if (is_landmark.back() != 0) landmarks.push_back({p.landmark, p.x, ""});
  }
  if (landmarks.empty()) return landmarks;
  const float sd_px = kLandmarkFitTuning.annotation_sd_fraction * spread_of({points.data(), points.size()});
  for (Correspondence& c : points) c.sd_px = sd_px;
  std::vector<float> sd(model.parameters().count);
  for (const auto& [name, value] : fit.sd)
    if (const std::uint16_t k = model.find_parameter(name.c_str()); k != kNone) sd[k] = value;
  const Span<const Correspondence> found = find_offset_landmarks(
      model, {points.data(), points.size()}, residuals.data(), is_landmark.data(), sd.data());
  landmarks.resize(found.count);  // all landmarks, in their order, or none
  for (std::size_t k = 0; k < found.count; ++k) landmarks[k].x = found[k].x;
  return landmarks;
}

bool is_fit(std::string_view text) {
  const std::string_view json = without_byte_order_mark(text);
  const std::size_t first = json.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && json[first] == '{';
}

void check_model(const FitFile& fit, const std::string& path, const ModelFile& file) {
  if (fit.model_crc != file.model().crc())
    fail_input(path, "was fitted with another model than " + file.path());
}

void set_camera(float focal_px, const std::optional<Camera>& camera, FitFile* fit) {
  if (!camera && !(focal_px > 0)) return;
  const View fitted = view_of(fit->pose, fit->camera);
  const View view = camera ? with_camera(fitted, *camera) : with_focal(fitted, focal_px);
  fit->pose = pose_of(view);
  if (camera)
    fit->camera = *camera;
  else
    fit->camera.f = focal_px;
}

FitFile fit_in(const std::string& path, const std::string& text, const ModelFile& file, const ImageSize& size,
               const std::string& image, float focal_px, const std::optional<Camera>& camera) {
  if (!is_fit(text)) {
    FitSetup setup;
    setup.size = size;
    setup.focal_px = focal_px;
    setup.camera = camera;
    return fit_to_points(file, path, parse_points(path, text), setup);
  }
  FitFile fit = parse_fit(path, text);
  check_model(fit, path, file);
  if (fit.width != size.width || fit.height != size.height)
    fail_input(path, "is for " + std::to_string(fit.width) + "x" + std::to_string(fit.height) + " pixels, " +
                         image + " has " + std::to_string(size.width) + "x" + std::to_string(size.height));
  set_camera(focal_px, camera, &fit);
  return fit;
}

std::optional<GivenBox> box_of(const Args& args, const char* option) {
  const auto box = args.numbers(option, 4);
  const std::string whose = args.text("--box-of").value_or("pliant");
  BoxConvention convention = BoxConvention::face_box;
  if (whose == "opencv")
    convention = BoxConvention::opencv;
  else if (whose == "landmarks")
    convention = BoxConvention::landmarks;
  else if (whose != "pliant")
    fail_usage("--box-of: pliant, opencv or landmarks, not " + whose);
  if (!box) return std::nullopt;
  if (!((*box)[2] >= 1 && (*box)[3] >= 1))
    fail_usage(std::string(option) + ": width and height must be at least a pixel: " + *args.text(option));
  if (std::any_of(box->begin(), box->end(), [](float x) { return magnitude(x) > kFarthestPx; }))
    fail_usage(std::string(option) + ": a number is more than a million pixels: " + *args.text(option));
  return GivenBox{{(*box)[0], (*box)[1]}, {(*box)[2], (*box)[3]}, convention};
}

FitFile fit_to_box(const ModelFile& file, const GivenBox& box, const FitSetup& setup, FaceBox* face) {
  const auto is_apart = [](float corner, float side, int picture) {
    return corner > static_cast<float>(picture) || corner + side < 0;
  };
  if (is_apart(box.corner.x, box.size.x, setup.size.width) ||
      is_apart(box.corner.y, box.size.y, setup.size.height))
    fail_usage("the box is not in the picture");
  std::vector<float> q = setup.q;
  q.resize(file.model().parameters().count, 0.0f);
  StartPose start{start_camera(setup.camera ? &*setup.camera : nullptr, setup.focal_px, setup.size.width,
                               setup.size.height),
                  {}};
  Owned<Cascade> cascade(file.model());
  FaceBox found;
  const Status status =
      pliant::fit_to_box(*cascade, box, setup.size.width, setup.size.height, q.data(), &start, &found);
  require(status, file.path() + ": box");
  if (face != nullptr) *face = found;
  FitFile fit = fit_of_view(file.model(), setup.size, view_of(start.pose, start.camera), q);
  fit.camera = start.camera;
  return fit;
}

}  // namespace pliant::host
