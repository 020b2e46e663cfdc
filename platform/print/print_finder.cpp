#include "print/print_finder.hpp"

#include "base/arrays.hpp"
#include "base/extent.hpp"
#include "pliant/lens.hpp"
#include "print/print_tuning.hpp"

namespace pliant {

namespace {

/// Tuning of the fit to matches and of its acceptance. Chosen on the poster of `fixtures/sheet` with `pliant bench print`, and
/// judged on other prints (docs/evaluation.md, Start by print). What other values give was not recorded, except where it is told.
struct PrintFinderTuning {
  /// Matches that must agree on a view. It is verification that decides: with 6 the poster, 53 px high, is found in 0 of 8, with 4
  /// in 3, with 3 in 6, and no picture without it is taken for it.
  int least_votes = 3;
  /// Distances at which a match agrees, as fractions of the surface's extent: with the view that one match suggests, after
  /// the fit of the pose of the surface at rest, and after the fit of its parameters.
  float vote_fraction = 0.1f, rigid_fraction = 0.05f, bent_fraction = 0.02f;
  /// Least tolerance, px.
  float least_tolerance_px = 3;
  /// Standard deviation of a corner's place on its level, px: corners are whole pixels.
  float corner_sd_px = 0.7f;
  /// Deviation of the surface from the model, as a fraction of its extent (FitOptions::misfit_mm).
  float misfit_fraction = 0.01f;
  /// Blocks by which one solution is better than the other; else the smaller residual decides.
  int clear_difference = 4;
  /// Fraction by which the squared residual of a solution counts more, for each squared standard deviation that its shape is bent.
  /// A small print tilted to the other side fits nearly as well, but bent: of 160 pictures of a sheet 66 px high the best solution
  /// is the right one in 139 with 0, in 146 with 0.2, in 150 with 0.5. Of 56 in which it is bent it is in 53, 53 and 52
  /// (docs/experiments.md, Start by print).
  float bending = 0.2f;
  /// Ratio of residuals that is as clear, and cosine of half the angle within which two solutions are one: 10 degrees.
  float clear_ratio = 1.3f, same_half_cosine = 0.996f;
  /// Spacing of a block's samples, as a fraction of the surface's extent in the frame, and its bounds, px.
  float block_fraction = 0.01f, least_block_px = 1, most_block_px = 4;
  /// Acceptance: points with weight in the fit, blocks that agree, count, and their least fraction of those that are visible. Of
  /// wrong views up to 0.32 agreed (below). The counts are round values, not tuned.
  std::size_t least_points = 8;
  int least_agreed = 10;
  float least_agreement = 0.5f;
  /// Fraction of the visible blocks from which on a view is also read as mirrored_tilt. Of wrong views up to 0.32 agreed, of right
  /// ones tilted to the wrong side 0.41 and more.
  float least_promise = 0.2f;
  /// Fraction of agreeing blocks from which on a start does not wait for another search that takes one frame, and no other view is
  /// fitted: that at which a track counts as confirmed (PrintStartTuning). From a start with less a track is degraded, and given up
  /// after half a second: a page that curls began with 0.87 and a corner folded over, and 9 of 78 frames were tracked instead of
  /// 63.
  float whole_agreement = 0.92f;
  /// Fraction and number of agreeing blocks from which on a frame counts twice of those after which a start waits no longer. Round
  /// values, not tuned.
  float sure_agreement = 0.8f;
  int sure_agreed = 24;
  int most_doubtful_frames = 4;
  /// Cosine of half the angle by which a fit to blocks turns the best solution, from which on that counts as settled: 0.2 degrees,
  /// a sixth of a percent of its extent. Round value, not tuned.
  float settled_half_cosine = 0.9999985f;
  /// How much a found shape is bent (bent_of), up to which it counts as that at rest, and its pose as right. Where a covered half
  /// was folded away it was 0.5 to 19, and the pose off by up to 110 degrees; of right starts of the same films it was 0.01 to 0.24
  /// (docs/experiments.md, Start by print).
  float at_rest = 0.3f;
};
constexpr PrintFinderTuning kTuning;

/// The surface at its pose, as the lens shows it.
struct PosedSurface {
  Cascade* cascade;
  const float* q;
  const Projector* projector;
  const Lens* lens;
};

/// Whether at least this fraction of the visible blocks agrees.
bool reaches(float fraction, const PrintAgreement& a) {
  return static_cast<float>(a.agreed) >= fraction * static_cast<float>(a.visible);
}

bool is_whole(const PrintAgreement& a) {
  return reaches(kTuning.whole_agreement, a);
}

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

bool is_accepted(const PrintAgreement& a) {
  return a.agreed >= kTuning.least_agreed && reaches(kTuning.least_agreement, a);
}

bool is_promising(const PrintAgreement& a) {
  return a.agreed > 0 && reaches(kTuning.least_promise, a);
}

bool is_sure(const PrintAgreement& a) {
  return a.agreed >= kTuning.sure_agreed && reaches(kTuning.sure_agreement, a);
}

void PrintFinder::lay_out(Arena& arena, const Model& model, int width, int height) {
  model_ = model;
  PrintTable table;
  status_ = PrintTable::open(model.print(), &table);
  if (status_ == Status::ok && model.albedo().pixels == nullptr) status_ = Status::bad_table;
  matcher_.lay_out(arena, table, width, height);
  FitLimits limits;
  limits.points = static_cast<std::uint16_t>(kPrintTuning.fitted_points);
  limits.samples_base_mesh = true;  // a search makes some twenty fits
  lay_out_part(arena, &fitter_, model, limits);
  matches_ = arena.take_span<SurfaceMatch>(PrintMatcher::most_matches());
  points_ = arena.take_span<Correspondence>(kPrintTuning.fitted_points);
  rest_ = arena.take_span<float>(model.parameters().count);
  q_ = arena.take_span<float>(model.parameters().count);
  found_q_ = arena.take_span<float>(model.parameters().count);
  is_frozen_ = arena.take_span<std::uint8_t>(model.parameters().count);
  if (is_frozen_.data == nullptr) return;
  for (float& value : rest_) value = 0;
  for (std::uint8_t& flag : is_frozen_) flag = 0;
}

Status PrintFinder::search(const FrameView& frame, std::uint32_t work, const Camera& camera, float* q,
                           FoundPrint* found) {
  Status status = status_;
  if (status == Status::ok) status = Lens::make(camera, frame.width, frame.height, &lens_);
  const bool begins = matcher_.is_idle();
  if (status == Status::ok && begins) status = matcher_.begin(frame, choice());
  if (status != Status::ok) return status;
  if (!matcher_.step(work)) return Status::not_found;
  gather();
  constexpr std::size_t kMostViews = kPrintTuning.most_views;
  ViewVotes views[kMostViews];
  const std::size_t count =
      find_views({matches_.data, match_count_}, camera, kTuning.vote_fraction * matcher_.table().extent_mm(),
                 {views, kMostViews});
  const bool is_found =
      fit_views({views, count}, {begins ? frame : frame_of(matcher_.searched()), camera}, found) &&
      (begins || carry({frame, camera}, found));
  if (!is_found) {
    doubtful_frames_ = 0;
    failed_searches_ = (failed_searches_ + 1) % kPrintTuning.spread_interval;
    return Status::not_found;
  }
  if (waits(*found, begins)) return Status::not_found;
  copy(found_q_.data, found_q_.count, q);
  found->expected = expected_places(pose_of(found->view));
  return Status::ok;
}

/// Fits views until nearly all blocks agree, and keeps the best solution of all.
bool PrintFinder::fit_views(Span<const ViewVotes> views, const Picture& in, FoundPrint* found) {
  Solutions solutions;
  for (std::size_t k = 0; k < views.count && views[k].votes >= kTuning.least_votes; ++k) {
    seed_ = views[k].match;
    fit_solutions(views[k].view, in, &solutions);
    if (solutions.best.is_accepted && is_clear(solutions) && is_whole(solutions.best.agreement)) break;
  }
  if (!solutions.best.is_accepted) return false;
  seed_ = solutions.best.seed;
  settle(in, &solutions.best.view, &solutions.best.agreement);
  *found = {solutions.best.view, solutions.best.agreement, is_clear(solutions), 0};
  return true;
}

/// The box around the matches of a view, px: empty without matches.
PixelBox PrintFinder::box_of_matches(const View& view) {
  const Span<const Correspondence> points = points_near(view, kTuning.rigid_fraction);
  if (points.count == 0) return {};
  Extent seen;
  for (const Correspondence& point : points) seen.include(point.x);
  return {static_cast<int>(seen.low.x), static_cast<int>(seen.low.y), static_cast<int>(seen.high.x),
          static_cast<int>(seen.high.y)};
}

/// Moves what was found from the frame that was searched to the present one: by the shift of the box around its matches, then to
/// its blocks. \return false where it is not seen there.
bool PrintFinder::carry(const Picture& now, FoundPrint* found) {
  View view = found->view;
  copy(found_q_.data, found_q_.count, q_.data);
  view.tau = view.tau + 1 / view.s * matcher_.move_on(now.frame, box_of_matches(view));
  FitReport report;
  // What has hardly turned is fitted as it is: coarse blocks would turn it.
  const bool is_near = is_accepted(verify(view, now.frame));
  for (float spacing = kPrintTuning.carried_spacing; spacing > 1 && !is_near; spacing /= 2)
    for (int k = 0; k < kPrintTuning.carried_passes; ++k)
      if (!fit_to_blocks(now, spacing, false, &view, &report)) return false;
  for (int k = 0; k < kPrintTuning.block_passes; ++k)
    if (!fit_to_blocks(now, 1, true, &view, &report)) return false;
  found->view = view;
  found->agreement = verify(view, now.frame);
  if (!is_accepted(found->agreement)) return false;
  copy(q_.data, q_.count, found_q_.data);
  settle(now, &found->view, &found->agreement);
  return true;
}

/// Goes on fitting a solution to blocks until that hardly turns it, or fewer of them agree: templates are captured where the start
/// puts the surface, and keep its error. \pre found_q_ are the parameters of the solution.
void PrintFinder::settle(const Picture& in, View* best, PrintAgreement* best_agreement) {
  copy(found_q_.data, found_q_.count, q_.data);
  float cosine = 0;
  for (int k = 0; k < kPrintTuning.settling_passes && cosine < kTuning.settled_half_cosine; ++k) {
    View view = *best;
    FitReport report;
    if (!fit_to_blocks(in, 1, true, &view, &report)) return;
    const PrintAgreement agreement = verify(view, in.frame);
    if (agreement.agreed < best_agreement->agreed) return;
    cosine = half_cosine(best->q, view.q);
    *best = view;
    *best_agreement = agreement;
    copy(q_.data, q_.count, found_q_.data);
  }
}

/// Whether a start waits for another search. One that is nearly certain does so only where the search has taken one frame
/// (is_quick) and the surface is not small: small ones are found in few frames.
bool PrintFinder::waits(const FoundPrint& found, bool is_quick) {
  const bool is_certain = found.is_clear && is_sure(found.agreement);
  const bool is_small = print_block_px(extent_px(found.view)) <= kTuning.least_block_px;
  if (is_certain && (is_whole(found.agreement) || !is_quick || is_small)) return false;
  doubtful_frames_ += is_certain ? 2 : 1;
  return doubtful_frames_ < kTuning.most_doubtful_frames;
}

CornerChoice PrintFinder::choice() const {
  return failed_searches_ == kPrintTuning.spread_interval - 1 ? CornerChoice::spread
                                                              : CornerChoice::strongest;
}

/// The matches in terms of the surface.
void PrintFinder::gather() {
  const PrintTable& table = matcher_.table();
  match_count_ = 0;
  for (const PrintMatch& match : matcher_.matches()) {
    const FrameCorner& corner = matcher_.corners()[match.corner];
    const PrintKeypoint& keypoint = table.keypoints()[match.keypoint];
    const Vec2 from{static_cast<float>(keypoint.cosine), static_cast<float>(keypoint.sine)},
        to = corner.descriptor.direction;
    // The picture's turn by an angle: (1 + cosine, sine) is along half of it.
    const float cosine = dot(from, to), sine = from.x * to.y - from.y * to.x;
    const float norm = square_root(cosine * cosine + sine * sine);
    const bool is_half_turn = sine == 0 && cosine < 0;
    const Quat turn = is_half_turn ? Quat{0, 0, 0, 1} : Quat{norm + cosine, 0, 0, sine};
    SurfaceMatch& m = matches_[match_count_++];
    m.uv = keypoint.uv();
    m.p = fitter_.cascade().surface_point(m.uv, rest_.data);
    m.x = lens_.undistort(corner.x);
    m.q = normalised(normalised(turn) * table.views()[keypoint.view]);
    m.s = corner.scale * table.levels()[keypoint.level];
    m.sd_px = max(corner.scale, 1) * kTuning.corner_sd_px;
  }
}

/// Fits a view as it is, and tilted to the other side (mirrored_tilt), where what bent towards the camera may bend away instead.
void PrintFinder::fit_solutions(const View& start, const Picture& in, Solutions* solutions) {
  View rigid = start;
  FitReport report;
  for (float& value : q_) value = 0;
  if (!fit(in, false, kTuning.vote_fraction, &rigid, &report)) return;
  View view = rigid;
  for (std::size_t k = 0; k < kPrintTuning.solutions; ++k) {
    const Candidate candidate = fit_candidate(view, in);
    if (k == 0 && !is_promising(candidate.agreement)) return;
    if (keep(candidate, solutions)) copy(q_.data, q_.count, found_q_.data);
    if (k + 1 == kPrintTuning.solutions) break;
    view = tilted_back(k == 0 ? candidate.view : rigid, k == 0);
  }
}

/// The view tilted to the other side, where what bent towards the camera bends away. The matches that agree with the view stay
/// where they are seen: what they show may be far from the model's origin, as the front of a box is.
View PrintFinder::tilted_back(const View& view, bool bends) {
  for (float& value : q_) value = bends ? value : 0;
  const Span<const Correspondence> points = points_near(view, kTuning.rigid_fraction);
  for (float& value : q_) value = -value;
  View back = mirrored_tilt(view, matcher_.table().views()[0]);
  const Projector projector(back, true);
  Vec2 sum;
  for (const Correspondence& point : points) {
    const Vec3 p = projector.rotated(fitter_.cascade().surface_point(point.uv, q_.data));
    sum = sum + ((1 + back.rho * p.z) / back.s * (lens_.undistort(point.x) - back.c) - Vec2{p.x, p.y});
  }
  if (points.count > 0) back.tau = 1 / static_cast<float>(points.count) * sum;
  return back;
}

bool PrintFinder::is_better(const Candidate& a, const Candidate& b) {
  if (!a.is_accepted || !b.is_accepted) return a.is_accepted;
  const int least = kTuning.clear_difference;
  if (a.agreement.agreed >= b.agreement.agreed + least) return true;
  return a.agreement.agreed + least > b.agreement.agreed && a.residual_px < b.residual_px;
}

/// \return whether the candidate is now the best one.
bool PrintFinder::keep(const Candidate& candidate, Solutions* solutions) {
  const bool is_best = is_better(candidate, solutions->best);
  if (is_best) {
    solutions->other = solutions->best;
    solutions->best = candidate;
  } else if (is_better(candidate, solutions->other)) {
    solutions->other = candidate;
  }
  return is_best;
}

/// Whether the second best solution is the same, or clearly worse.
bool PrintFinder::is_clear(const Solutions& solutions) {
  const Candidate &best = solutions.best, &other = solutions.other;
  if (!other.is_accepted || best.agreement.agreed >= other.agreement.agreed + kTuning.clear_difference ||
      kTuning.clear_ratio * best.residual_px < other.residual_px)
    return true;
  return half_cosine(best.view.q, other.view.q) > kTuning.same_half_cosine;
}

/// Pose and parameters from ever nearer matches, then from blocks.
PrintFinder::Candidate PrintFinder::fit_candidate(const View& start, const Picture& in) {
  Candidate c;
  c.view = start;
  c.seed = seed_;
  FitReport report;
  if (!fit(in, true, kTuning.rigid_fraction, &c.view, &report) ||
      !fit(in, true, kTuning.bent_fraction, &c.view, &report))
    return c;
  for (int k = 0; k < kPrintTuning.block_passes; ++k)
    if (!fit_to_blocks(in, 1, true, &c.view, &report)) return c;
  c.residual_px = square_root(1 + kTuning.bending * bent_of(q_)) * report.rms_px;
  c.agreement = verify(c.view, in.frame);
  c.is_accepted = report.used >= kTuning.least_points && is_accepted(c.agreement);
  return c;
}

/// \param tolerance  of the matches that are fitted, as a fraction of the extent.
bool PrintFinder::fit(const Picture& in, bool bends, float tolerance, View* view, FitReport* report) {
  return fit_to(points_near(*view, tolerance), in, bends, view, report);
}

/// The model as it is, to where its blocks are found. \param spacing  of their samples, in that of a check.
bool PrintFinder::fit_to_blocks(const Picture& in, float spacing, bool bends, View* view, FitReport* report) {
  const Projector projector(*view, true);
  PosedSurface surface{&fitter_.cascade(), q_.data, &projector, &lens_};
  const std::size_t count = match_blocks(in.frame, model_, matcher_.table(), {&surface, project_posed},
                                         spacing * print_block_px(extent_px(*view)), points_);
  return fit_to({points_.data, count}, in, bends, view, report);
}

bool PrintFinder::fit_to(Span<const Correspondence> points, const Picture& in, bool bends, View* view,
                         FitReport* report) {
  FitOptions options;
  options.width = in.frame.width;
  options.height = in.frame.height;
  options.camera = &in.camera;
  options.start = view;
  options.misfit_mm = kTuning.misfit_fraction * matcher_.table().extent_mm();
  options.is_free = bends ? nullptr : is_frozen_.data;
  if (fitter_.fit(points, options, q_.data, report) != Status::ok) return false;
  *view = report->view;
  return true;
}

/// Matches that lie near their place on the present surface, and suggest a view similar to the one that is fitted.
/// \param tolerance  the distance, as a fraction of the extent.
Span<const Correspondence> PrintFinder::points_near(const View& view, float tolerance) {
  const float tolerance_px = max(tolerance * extent_px(view), kTuning.least_tolerance_px);
  const Projector projector(view, true);
  std::size_t count = 0;
  for (std::size_t k = 0; k < match_count_ && count < points_.count; ++k) {
    const SurfaceMatch& m = matches_[k];
    Vec2 x;
    if (!is_similar(m, matches_[seed_]) ||
        !projector.project(fitter_.cascade().surface_point(m.uv, q_.data), &x))
      continue;
    if (length(x - m.x) <= tolerance_px) points_[count++] = {m.uv, lens_.distort(m.x), m.sd_px, false};
  }
  return {points_.data, count};
}

PrintAgreement PrintFinder::verify(const View& view, const FrameView& frame) {
  const Projector projector(view, true);
  PosedSurface surface{&fitter_.cascade(), q_.data, &projector, &lens_};
  return compare_print(frame, model_, matcher_.table(), {&surface, project_posed},
                       print_block_px(extent_px(view)));
}

/// Sum of the squares of the expression parameters, in standard deviations.
float PrintFinder::bent_of(Span<const float> q) const {
  float bent = 0;
  for (std::size_t k = 0; k < q.count; ++k) {
    const Parameter& p = model_.parameters()[k];
    if (p.group == Group::expression) bent += q[k] * q[k] / (p.sd * p.sd);
  }
  return bent;
}

/// Those that face this camera while the surface is at rest. Where it was found in another shape, which may fold a part away, its
/// pose may be wrong as well: then those that can face one camera.
int PrintFinder::expected_places(const Pose& pose) {
  const FacingAtRest facing = facing_at_rest(matcher_.table(), fitter_.cascade(), rest_.data, pose);
  return bent_of(found_q_) <= kTuning.at_rest ? facing.in_view : facing.most;
}

}  // namespace pliant
