#include "print/print_fit.hpp"

#include <initializer_list>

#include "base/arrays.hpp"
#include "print/print_tuning.hpp"

namespace pliant {

namespace {

/// Tuning of fits. Chosen on the poster of `fixtures/sheet` with `pliant bench print`, and judged on other prints
/// (docs/evaluation.md, Start by print). What other values give was not recorded, except where it is told.
struct PrintFitTuning {
  /// Distances at which a match agrees, as fractions of the surface's extent: with the view that one match suggests, after
  /// the fit of the pose of the surface at rest, and after the fit of its parameters.
  float tolerance[3] = {0.1f, 0.05f, 0.02f};
  /// Least tolerance, px.
  float least_tolerance_px = 3;
  /// Deviation of the surface from the model, as a fraction of its extent (FitOptions::misfit_mm).
  float misfit_fraction = 0.01f;
  /// Fraction by which the squared residual of a solution counts more, for each squared standard deviation that its shape is bent.
  /// A small print tilted to the other side fits nearly as well, but bent: of 160 pictures of a sheet 66 px high the best solution
  /// is the right one in 139 with 0, in 146 with 0.2, in 150 with 0.5. Of 56 in which it is bent it is in 53, 53 and 52
  /// (docs/experiments.md, Start by print).
  float bending = 0.2f;
  /// Spacing of a block's samples, as a fraction of the surface's extent in the frame, and its bounds, px.
  float block_fraction = 0.01f, least_block_px = 1, most_block_px = 4;
  /// How much a found shape is bent (PrintFit::bent), up to which it counts as that at rest, and its pose as right. Where a covered
  /// half was folded away it was 0.5 to 19, and the pose off by up to 110 degrees; of right starts of the same films it was 0.01 to
  /// 0.24 (docs/experiments.md, Start by print).
  float at_rest = 0.3f;
  /// Fraction of the places of a surface that can face one camera, from which on it counts as flat. Round value, not tuned.
  float flat = 0.95f;
};
constexpr PrintFitTuning kTuning;

/// The surface at its pose, as the lens shows it.
struct PosedSurface {
  Cascade* cascade;
  const float* q;
  const Projector* projector;
  const Lens* lens;
};

bool project_posed(void* state, Vec2 uv, Vec2* x) {
  const auto& s = *static_cast<const PosedSurface*>(state);
  const Vec2 within{clamp(uv.x, 0, 1), clamp(uv.y, 0, 1)};
  if (!s.projector->project(s.cascade->surface_point(within, s.q), x)) return false;
  *x = s.lens->distort(*x);
  return true;
}

}  // namespace

float print_block_px(float extent_px) {
  return clamp(kTuning.block_fraction * extent_px, kTuning.least_block_px, kTuning.most_block_px);
}

void PrintFit::lay_out(Arena& arena, const Model& model, const PrintTable& table) {
  model_ = model;
  table_ = table;
  FitLimits limits;
  limits.points = static_cast<std::uint16_t>(kPrintTuning.fitted_points);
  limits.samples_base_mesh = true;  // a search makes some twenty fits
  lay_out_part(arena, &fitter_, model, limits);
  points_ = arena.take_span<Correspondence>(kPrintTuning.fitted_points);
  rest_ = arena.take_span<float>(model.parameters().count);
  q_ = arena.take_span<float>(model.parameters().count);
  is_frozen_ = arena.take_span<std::uint8_t>(model.parameters().count);
  if (is_frozen_.data == nullptr) return;
  for (float& value : rest_) value = 0;
  for (std::uint8_t& flag : is_frozen_) flag = 0;
}

void PrintFit::rest() {
  copy(rest_.data, rest_.count, q_.data);
}

bool PrintFit::to_matches(const SeededMatches& matches, const PrintPicture& in, MatchTolerance tolerance,
                          bool bends, View* view) {
  return fit_to(agreeing(matches, *view, tolerance), in, bends, view);
}

bool PrintFit::to_blocks(const PrintPicture& in, View* view) {
  const Projector projector(*view, true);
  PosedSurface surface{&fitter_.cascade(), q_.data, &projector, &lens_};
  const std::size_t count = match_blocks(in.frame, model_, table_, {&surface, project_posed},
                                         print_block_px(extent_px(*view)), points_);
  return fit_to({points_.data, count}, in, true, view);
}

void PrintFit::to_motion(const SceneMotion& scene, const SmallPictures& pictures, const PrintPicture& now,
                         View* view) {
  const Projector before(*view, true);
  PosedSurface seen{&fitter_.cascade(), q_.data, &before, &lens_};
  fit_to({points_.data, match_scene(scene, table_, {&seen, project_posed}, points_)}, now, false, view);
  for (const SmallPictures& shown : {scene.pictures(), pictures, pictures}) {
    const Projector after(*view, true);
    PosedSurface expected{&fitter_.cascade(), q_.data, &after, &lens_};
    const std::size_t count =
        match_pictures(shown, table_, {&seen, project_posed}, {&expected, project_posed}, points_);
    fit_to({points_.data, count}, now, false, view);
  }
}

bool PrintFit::fit_to(Span<const Correspondence> points, const PrintPicture& in, bool bends, View* view) {
  FitOptions options;
  options.width = in.frame.width;
  options.height = in.frame.height;
  options.camera = &in.camera;
  options.start = view;
  options.misfit_mm = kTuning.misfit_fraction * table_.extent_mm();
  options.is_free = bends ? nullptr : is_frozen_.data;
  if (fitter_.fit(points, options, q_.data, &report_) != Status::ok) return false;
  *view = report_.view;
  return true;
}

float PrintFit::tolerance_mm(MatchTolerance tolerance) const {
  return kTuning.tolerance[static_cast<std::size_t>(tolerance)] * table_.extent_mm();
}

Span<const Correspondence> PrintFit::agreeing(const SeededMatches& matches, const View& view,
                                              MatchTolerance tolerance) {
  const float tolerance_px = max(view.s * tolerance_mm(tolerance), kTuning.least_tolerance_px);
  const Projector projector(view, true);
  std::size_t count = 0;
  for (std::size_t k = 0; k < matches.all.count && count < points_.count; ++k) {
    const SurfaceMatch& m = matches.all[k];
    Vec2 x;
    if (!is_similar(m, matches.all[matches.seed]) ||
        !projector.project(fitter_.cascade().surface_point(m.uv, q_.data), &x))
      continue;
    if (length(x - m.x) <= tolerance_px) points_[count++] = {m.uv, lens_.distort(m.x), m.sd_px, false};
  }
  return {points_.data, count};
}

float PrintFit::residual_px() const {
  return square_root(1 + kTuning.bending * bent()) * report_.rms_px;
}

PrintAgreement PrintFit::verify(const View& view, const FrameView& frame) {
  const Projector projector(view, true);
  PosedSurface surface{&fitter_.cascade(), q_.data, &projector, &lens_};
  return compare_print(frame, model_, table_, {&surface, project_posed}, print_block_px(extent_px(view)));
}

View PrintFit::tilted_back(const SeededMatches& matches, const View& view) {
  const Span<const Correspondence> points = agreeing(matches, view, MatchTolerance::rigid);
  for (float& value : q_) value = -value;
  View back = mirrored_tilt(view, table_.views()[0]);
  const Projector projector(back, true);
  Vec2 sum;
  for (const Correspondence& point : points) {
    const Vec3 p = projector.rotated(fitter_.cascade().surface_point(point.uv, q_.data));
    sum = sum + ((1 + back.rho * p.z) / back.s * (lens_.undistort(point.x) - back.c) - Vec2{p.x, p.y});
  }
  if (points.count > 0) back.tau = 1 / static_cast<float>(points.count) * sum;
  return back;
}

/// Sum of the squares of the expression parameters, in standard deviations.
float PrintFit::bent() const {
  float sum = 0;
  for (std::size_t k = 0; k < q_.count; ++k) {
    const Parameter& p = model_.parameters()[k];
    if (p.group == Group::expression) sum += q_[k] * q_[k] / (p.sd * p.sd);
  }
  return sum;
}

int PrintFit::expected_places(const Pose& pose) {
  const FacingAtRest facing = facing_at_rest(table_, fitter_.cascade(), rest_.data, pose);
  return bent() <= kTuning.at_rest ? facing.in_view : facing.most;
}

bool PrintFit::shows_all() {
  for (const Parameter& parameter : model_.parameters())
    if (parameter.group == Group::expression) return false;
  const FacingAtRest facing = facing_at_rest(table_, fitter_.cascade(), rest_.data, {});
  return static_cast<float>(facing.most) >= kTuning.flat * static_cast<float>(facing.places);
}

}  // namespace pliant
