#include "print/print_finder.hpp"

#include <initializer_list>

#include "base/arrays.hpp"

namespace pliant {

namespace {

/// Tuning of the choice among solutions and of their acceptance. Chosen on the poster of `fixtures/sheet` with `pliant bench
/// print`, and judged on other prints (docs/evaluation.md, Start by print). What other values give was not recorded, except where
/// it is told.
struct PrintFinderTuning {
  /// Matches that must agree on a view. It is verification that decides: with 6 the poster, 53 px high, is found in 0 of 8, with 4
  /// in 3, with 3 in 6, and no picture without it is taken for it.
  int least_votes = 3;
  /// Standard deviation of a corner's place on its level, px: corners are whole pixels.
  float corner_sd_px = 0.7f;
  /// Blocks by which one solution is better than the other; else the smaller residual decides.
  int clear_difference = 4;
  /// Ratio of residuals that is as clear, and cosine of half the angle within which two solutions are one: 10 degrees.
  float clear_ratio = 1.3f, same_half_cosine = 0.996f;
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
};
constexpr PrintFinderTuning kTuning;

/// Whether at least this fraction of the visible blocks agrees.
bool reaches(float fraction, const PrintAgreement& a) {
  return static_cast<float>(a.agreed) >= fraction * static_cast<float>(a.visible);
}

bool is_whole(const PrintAgreement& a) {
  return reaches(kTuning.whole_agreement, a);
}

bool is_settled(const View& before, const View& now) {
  return half_cosine(before.q, now.q) >= kTuning.settled_half_cosine;
}

}  // namespace

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
  PrintTable table;
  status_ = PrintTable::open(model.print(), &table);
  if (status_ == Status::ok && model.albedo().pixels == nullptr) status_ = Status::bad_table;
  matcher_.lay_out(arena, table, width, height);
  motion_.lay_out(arena, width, height);
  fit_ = create_part<PrintFit>(arena, model, table);
  fit_cells_ = kPrintTuning.cells_of_fit(model.cascade().count);
  matches_ = arena.take_span<SurfaceMatch>(PrintMatcher::most_matches());
  order_ = arena.take_span<std::uint16_t>(matches_.count);
  views_ = arena.take_span<ViewVotes>(kPrintTuning.most_views);
  now_ = arena.make<Progress>();
  best_q_ = arena.take_span<float>(model.parameters().count);
}

Status PrintFinder::search(const FrameView& frame, std::uint32_t work, const Camera& camera, float* q,
                           FoundPrint* found) {
  Status status = status_;
  if (status == Status::ok) status = fit_->set_camera(camera, frame.width, frame.height);
  const bool begins = is_idle();
  if (status == Status::ok && begins) status = matcher_.begin(frame, choice());
  if (status != Status::ok) return status;
  if (begins) {
    stage_ = Stage::matching;
    motion_.begin(frame);
  } else {
    motion_.follow(frame);
  }
  const PrintPicture searched{frame_of(matcher_.searched()), camera};
  if (stage_ != Stage::carrying) {
    std::uint32_t done = 0;
    do done += step(searched);
    while (stage_ != Stage::carrying && done < work);
    const bool goes_on = stage_ != Stage::carrying || (now_->best.is_accepted && !begins);
    if (goes_on) return Status::not_found;
  }
  stage_ = Stage::none;
  if (!conclude({frame, camera}, begins, found)) return Status::not_found;
  copy(best_q_.data, best_q_.count, q);
  return Status::ok;
}

/// The next part. \return its cost, cells.
std::uint32_t PrintFinder::step(const PrintPicture& in) {
  const Span<const PrintMatch> found = matcher_.matches();
  switch (stage_) {
    case Stage::matching: {
      const std::uint32_t cells = matcher_.step();
      if (matcher_.is_idle()) match_count_ = 0, stage_ = Stage::gathering;
      return cells;
    }
    case Stage::gathering:
      if (match_count_ < found.count) return gather(found[match_count_]), 1;
      scaled_matches().sort();
      voted_ = view_count_ = 0, stage_ = Stage::voting;
      return 0;
    case Stage::voting:
      if (voted_ < match_count_) return vote(in.camera);
      *now_ = {}, stage_ = Stage::fitting;
      return 0;
    case Stage::fitting:
      return static_cast<std::uint32_t>(fit_next(in)) * fit_cells_;
    default:
      settle(in);
      return fit_cells_;
  }
}

CornerChoice PrintFinder::choice() const {
  return failed_searches_ == kPrintTuning.spread_interval - 1 ? CornerChoice::spread
                                                              : CornerChoice::strongest;
}

/// A match in terms of the surface.
void PrintFinder::gather(const PrintMatch& match) {
  const PrintTable& table = matcher_.table();
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
  m.p = fit_->point_at_rest(m.uv);
  m.x = fit_->lens().undistort(corner.x);
  m.q = normalised(normalised(turn) * table.views()[keypoint.view]);
  m.s = corner.scale * table.levels()[keypoint.level];
  m.sd_px = max(corner.scale, 1) * kTuning.corner_sd_px;
}

/// \return the cost, cells.
std::uint32_t PrintFinder::vote(const Camera& camera) {
  const std::uint32_t compared = vote_for_view(
      scaled_matches(), voted_++, camera, fit_->tolerance_mm(MatchTolerance::vote), views_, &view_count_);
  return compared / kPrintTuning.pairs_per_cell + 1;
}

/// The next solution: a view as it is, then tilted to the other side, where what bent towards the camera may bend away instead.
/// Views are fitted until nearly all blocks agree, and the best solution of all is kept. \return fits that were made.
int PrintFinder::fit_next(const PrintPicture& in) {
  if (now_->solution == 0 && !begin_view(in)) return end_view(), 1;
  Candidate& c = now_->present;
  const int fits = fit_solution(in);
  if (fits > 0) {
    c.residual_px = fit_->residual_px();
    c.agreement = fit_->verify(c.view, in.frame);
    c.is_accepted = fit_->used() >= kTuning.least_points && is_accepted(c.agreement);
  }
  end_solution();
  return fits + 1;
}

/// \return false after the last view with enough votes, and where the view cannot be fitted.
bool PrintFinder::begin_view(const PrintPicture& in) {
  if (now_->view >= view_count_ || views_[now_->view].votes < kTuning.least_votes) return false;
  const ViewVotes& votes = views_[now_->view];
  now_->rigid = votes.view;
  fit_->rest();
  if (!fit_->to_matches(matches_of(votes.match), in, MatchTolerance::vote, false, &now_->rigid)) return false;
  now_->present = {now_->rigid, votes.match, 0, {}, false};
  return true;
}

/// Pose and parameters from ever nearer matches, then from blocks. \return fits that were made; 0 where one was not possible.
int PrintFinder::fit_solution(const PrintPicture& in) {
  View& view = now_->present.view;
  const SeededMatches matches = matches_of(now_->present.seed);
  for (const MatchTolerance tolerance : {MatchTolerance::rigid, MatchTolerance::bent})
    if (!fit_->to_matches(matches, in, tolerance, true, &view)) return 0;
  const int fits = fit_to_blocks(in, &view);
  return fits > 0 ? 2 + fits : 0;
}

/// Fits to blocks until that hardly turns the view. \return fits that were made; 0 where one was not possible.
int PrintFinder::fit_to_blocks(const PrintPicture& in, View* view) {
  for (int fits = 1;; ++fits) {
    const View before = *view;
    if (!fit_->to_blocks(in, view)) return 0;
    if (fits == kPrintTuning.block_passes || is_settled(before, *view)) return fits;
  }
}

void PrintFinder::end_solution() {
  Candidate& c = now_->present;
  if (now_->solution == 0 && !is_promising(c.agreement)) return end_view();
  if (keep(c)) copy(fit_->q().data, best_q_.count, best_q_.data);
  if (++now_->solution == kPrintTuning.solutions) return end_view();
  const bool bends = now_->solution == 1;
  if (!bends) fit_->rest();
  const SeededMatches matches = matches_of(c.seed);
  c = {fit_->tilted_back(matches, bends ? c.view : now_->rigid), c.seed, 0, {}, false};
}

/// Goes on to the next view, or to settling.
void PrintFinder::end_view() {
  const Candidate& best = now_->best;
  ++now_->view;
  now_->solution = 0;
  const bool is_sufficient = best.is_accepted && is_clear() && is_whole(best.agreement);
  const bool is_last = now_->view >= view_count_ || views_[now_->view].votes < kTuning.least_votes;
  if (!is_sufficient && !is_last) return;
  copy(best_q_.data, best_q_.count, fit_->q().data);
  stage_ = best.is_accepted ? Stage::settling : Stage::carrying;
}

/// Goes on fitting the best solution to blocks until that hardly turns it, or fewer of them agree: templates are captured where the
/// start puts the surface, and keep its error.
void PrintFinder::settle(const PrintPicture& in) {
  Candidate& best = now_->best;
  const View before = best.view;
  View view = before;
  stage_ = Stage::carrying;  // if nothing is gained
  if (!fit_->to_blocks(in, &view)) return;
  const PrintAgreement agreement = fit_->verify(view, in.frame);
  if (agreement.agreed < best.agreement.agreed) return;
  best.view = view;
  best.agreement = agreement;
  copy(fit_->q().data, best_q_.count, best_q_.data);
  if (++now_->settling < kPrintTuning.settling_passes && !is_settled(before, view)) stage_ = Stage::settling;
}

/// \param is_quick  the search has taken one frame, the present one. \return whether a track begins.
bool PrintFinder::conclude(const PrintPicture& now, bool is_quick, FoundPrint* found) {
  const bool is_unique = is_clear();  // before the best solution moves on
  const bool is_found = now_->best.is_accepted && (is_quick || carry(now));
  if (!is_found) {
    doubtful_frames_ = 0;
    failed_searches_ = (failed_searches_ + 1) % kPrintTuning.spread_interval;
    return false;
  }
  *found = {now_->best.view, now_->best.agreement, is_unique, 0, false};
  if (waits(*found, is_quick)) return false;
  copy(best_q_.data, best_q_.count, fit_->q().data);
  found->expected = fit_->expected_places(pose_of(found->view));
  found->shows_all = fit_->shows_all();
  return true;
}

/// Moves what was found from the frame that was searched to the present one: with the scene, then to its blocks.
/// \return false where it is not seen there.
bool PrintFinder::carry(const PrintPicture& now) {
  Candidate& best = now_->best;
  copy(best_q_.data, best_q_.count, fit_->q().data);
  fit_->to_motion(motion_, matcher_.move_on(now.frame), now, &best.view);
  if (fit_to_blocks(now, &best.view) == 0) return false;
  best.agreement = fit_->verify(best.view, now.frame);
  copy(fit_->q().data, best_q_.count, best_q_.data);
  return is_accepted(best.agreement);
}

/// Whether a start waits for another search. One that is nearly certain does so only where the search has taken one frame
/// (is_quick) and the surface is not small: small ones are found in few frames.
bool PrintFinder::waits(const FoundPrint& found, bool is_quick) {
  const bool is_certain = found.is_clear && is_sure(found.agreement);
  const bool is_small = print_block_px(fit_->extent_px(found.view)) <= print_block_px(0);
  if (is_certain && (is_whole(found.agreement) || !is_quick || is_small)) return false;
  doubtful_frames_ += is_certain ? 2 : 1;
  return doubtful_frames_ < kTuning.most_doubtful_frames;
}

bool PrintFinder::is_better(const Candidate& a, const Candidate& b) {
  if (!a.is_accepted || !b.is_accepted) return a.is_accepted;
  const int least = kTuning.clear_difference;
  if (a.agreement.agreed >= b.agreement.agreed + least) return true;
  return a.agreement.agreed + least > b.agreement.agreed && a.residual_px < b.residual_px;
}

/// Among the best two of all views. \return whether the candidate is now the best one.
bool PrintFinder::keep(const Candidate& candidate) {
  const bool is_best = is_better(candidate, now_->best);
  if (is_best) {
    now_->other = now_->best;
    now_->best = candidate;
  } else if (is_better(candidate, now_->other)) {
    now_->other = candidate;
  }
  return is_best;
}

/// Whether the second best solution is the same, or clearly worse.
bool PrintFinder::is_clear() const {
  const Candidate &best = now_->best, &other = now_->other;
  if (!other.is_accepted || best.agreement.agreed >= other.agreement.agreed + kTuning.clear_difference ||
      kTuning.clear_ratio * best.residual_px < other.residual_px)
    return true;
  return half_cosine(best.view.q, other.view.q) > kTuning.same_half_cosine;
}

}  // namespace pliant
