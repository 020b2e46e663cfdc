// What is searched for in a frame, how far, by which picture, and what is noted of it. Predictions are made by hand.
#include "track/template_matcher.hpp"

#include <doctest/doctest.h>

#include <functional>
#include <set>

#include "random.hpp"
#include "template_rig.hpp"
#include "track/template_tuning.hpp"

namespace template_matcher_test {

using namespace pliant;
using template_rig::film;
using template_rig::Rig;

namespace {

constexpr const TemplateMatchTuning& kTuning = kTemplateMatchTuning;

/// Points of a head that stands still, in a region that is not at the frame's corner.
struct Match {
  Rig rig;
  InArena<TemplateMatcher> matcher;
  std::vector<Observation> seen;
  std::vector<Prediction> predicted;
  std::vector<std::uint16_t> index;
  std::vector<Vec2> at;  // where the points are

  explicit Match(std::uint16_t patches = 40, std::uint16_t region_px = 160)
      : rig(patches, region_px), matcher(rig.limits), seen(rig.templates->count()), index(1000) {
    rig.place(0, patches);
    const std::size_t count = rig.used(0, patches);
    REQUIRE(count > 25);
    for (std::size_t k = 0; k < count; ++k) {
      predicted.push_back(rig.estimator->predict(rig.templates.object[k].id));
      at.push_back(rig.templates.object[k].found_at);
      predicted[k].x = at[k];
      index[predicted[k].id] = static_cast<std::uint16_t>(k);
    }
    matcher->start(true);
    matcher->limit_steps(1'000'000);
    show(film().frames[0]);
  }
  std::size_t count() const { return at.size(); }
  Template& point(std::size_t k) { return rig.templates.object[k]; }
  MatchFrame frame() { return {rig.templates.object, rig.region.object, {seen.data(), seen.size()}}; }
  void show(const std::vector<std::uint8_t>& pixels) {
    FrameView view = film().view(0);
    view.data = pixels.data();
    rig.region->advance();
    REQUIRE(rig.region->build(view, {160, 120}) == Status::ok);
  }
  void predict(Vec2 off) {
    for (std::size_t k = 0; k < count(); ++k) predicted[k].x = at[k] + off;
  }
  std::size_t match(int round) {
    return matcher->match(frame(), {{predicted.data(), predicted.size()}, index.data()}, round);
  }
  /// A frame's first searches. \return how many points were found where they are.
  std::size_t search(std::uint32_t number, Vec2 off, float coarse_px = 0) {
    matcher->begin_frame(number, true, coarse_px);
    predict(off);
    match(0);
    std::size_t found = 0;
    for (std::size_t k = 0; k < count(); ++k)
      found += seen[k].reason == Reason::found && length(seen[k].x - at[k]) < 0.3f;
    return found;
  }
  /// A good frame in which all points were found, `off` where they were expected.
  void move_frame(std::uint32_t number, Vec2 off) {
    REQUIRE(search(number, {}) == count());
    for (std::size_t k = 0; k < count(); ++k) seen[k].x = at[k] + off;
    matcher->end_frame(frame(), true);
  }
  void still_frame(std::uint32_t number) { move_frame(number, {}); }
  /// Slots of the points of a first pass, which has run.
  std::set<std::size_t> first_pass(std::uint32_t number) {
    matcher->begin_frame(number, true, 0);
    if (!matcher->run_first_pass(frame(), rig.estimator.object)) return {};
    std::set<std::size_t> points;
    for (std::size_t k = 0; k < count(); ++k)
      if (seen[k].reason != Reason::not_visible) points.insert(k);
    return points;
  }
};

/// The same with so many points that a first pass takes every third to fourth one.
struct ManyPoints : Match {
  ManyPoints() : Match(150, 0) {
    REQUIRE(count() >= kTuning.first_pass_least_ratio * kTuning.first_pass_points);
    for (std::size_t k = 0; k < count(); ++k) point(k).was_found = true;
  }
  std::size_t ratio() const { return count() / kTuning.first_pass_points; }
};

enum class Does { nothing, searches, follows };

}  // namespace

TEST_CASE("the second round searches again only for points to which it can add something") {
  Match m;
  m.still_frame(1);
  const struct {
    std::string what;
    std::function<void(Prediction&, Observation&)> change;
    Does first, again;  // the second with the same prediction, and what was seen changed in the same way
  } kCases[] = {
      {"nothing new", [](Prediction&, Observation&) {}, Does::nothing, Does::nothing},
      {"an outlier in the same place", [](Prediction&, Observation& o) { o.reason = Reason::rejected; },
       Does::nothing, Does::nothing},
      {"found a little elsewhere",
       [](Prediction& p, Observation& o) { o.x.x = p.x.x + 0.9f * kTuning.rematch_distance_px; },
       Does::nothing, Does::nothing},
      {"found elsewhere",
       [](Prediction& p, Observation& o) { o.x.x = p.x.x + 1.1f * kTuning.rematch_distance_px; },
       Does::searches, Does::searches},
      {"warped a little",
       [](Prediction& p, Observation&) {
         p.jacobian = p.jacobian * Mat2{1.05f, 0, 0, 1};
       },
       Does::nothing, Does::nothing},
      {"warped",
       [](Prediction& p, Observation&) {
         p.jacobian = p.jacobian * Mat2{1.07f, 0, 0, 1};
       },
       Does::searches, Does::nothing},
      {"found with doubt", [](Prediction&, Observation& o) { o.score = kTuning.min_correlation - 0.01f; },
       Does::searches, Does::searches},
      {"hidden now", [](Prediction& p, Observation&) { p.visible = false; }, Does::searches, Does::nothing},
      {"not found", [](Prediction&, Observation& o) { o.reason = Reason::diverged; }, Does::follows,
       Does::follows},
      {"not found, and expected elsewhere",
       [](Prediction& p, Observation& o) {
         p.x.x += 1.1f * kTuning.rematch_move_px;
         o.reason = Reason::diverged;
       },
       Does::searches, Does::follows},
  };
  std::uint32_t number = 2;
  for (const auto& c : kCases) {
    CAPTURE(c.what);
    REQUIRE(m.search(number++, {}) == m.count());
    constexpr std::size_t k = 5;
    Prediction& p = m.predicted[k];
    const Prediction before = p;
    for (const Does expected : {c.first, c.again}) {
      p = before;
      c.change(p, m.seen[k]);
      const std::uint32_t searches = m.matcher->work().searches;
      CHECK(m.match(1) == (expected != Does::nothing));
      CHECK(m.matcher->work().searches - searches == (expected == Does::nothing || !p.visible ? 0
                                                      : expected == Does::follows             ? 2
                                                                                              : 1));
      CHECK((m.seen[k].cue == Cue::flow) == (expected == Does::follows));
      if (p.visible && expected != Does::nothing) CHECK(length(m.seen[k].x - m.at[k]) < 0.3f);
      if (!p.visible) CHECK(m.seen[k].reason == Reason::not_visible);
    }
    p = before;
  }
}

TEST_CASE("a search reaches as far as the last frame and the coarse translation say that it must") {
  Match m;
  const std::size_t most = m.count() - m.count() / 10, some = m.count() / 2;
  constexpr Vec2 kFar{8, 0};         // px
  CHECK(m.search(1, kFar) >= most);  // nothing is known yet
  for (const float moved_px : {0.1f, 0.3f, 0.6f}) {
    CAPTURE(moved_px);
    m.move_frame(2, {0, moved_px});
    CHECK(m.search(3, kFar) < some);
    CHECK(m.search(3, {5, 0}, 30) >= most);
    for (const float coarse_px : {60.0f, 150.0f, kUnknownPx}) CHECK(m.search(3, kFar, coarse_px) >= most);
  }
  for (const float moved_px : {1.5f, 3.0f}) {
    m.move_frame(2, {0, moved_px});
    CHECK(m.search(3, {5, 0}) >= most);
  }
  m.move_frame(2, {0, 0.1f});
  for (std::size_t k = 0; k < m.count(); ++k) m.point(k).was_found = false;
  CHECK(m.search(3, kFar) >= most);  // where they are is not known
  m.move_frame(2, {0, 0.1f});
  m.matcher->start(true);  // another track
  CHECK(m.search(3, kFar) >= most);
}

TEST_CASE("what the last solve left of a point is expected again, and is no surprise") {
  Match m;
  m.still_frame(1);
  const Vec2 left{5, 0};
  for (std::size_t k = 0; k < m.count(); ++k) m.point(k).residual = (1 / kTuning.residual_memory) * left;
  CHECK(m.search(2, {-5, 0}) == m.count());
  m.matcher->end_frame(m.frame(), true);
  CHECK(m.search(3, {8, 0}) < m.count() / 2);  // searches stay short
}

TEST_CASE("a frame notes of each point what was seen of it, and of one that was not found that it was not") {
  Match m;
  REQUIRE(m.search(1, {}) == m.count());
  m.seen[3].residual = {0.25f, -0.5f};
  m.seen[3].score = 0.75f;
  m.seen[3].x = m.at[3] + Vec2{1, 2};
  m.seen[4].residual = {0.25f, -0.5f};
  m.seen[4].reason = Reason::rejected;
  m.matcher->end_frame(m.frame(), true);
  CHECK(m.point(3).was_found);
  CHECK(length(m.point(3).residual - Vec2{0.25f, -0.5f}) == 0);
  CHECK(m.point(3).correlation == 0.75f);
  CHECK(length(m.point(3).found_at - m.at[3]) > 2);
  CHECK_FALSE(m.point(4).was_found);
  CHECK(length(m.point(4).residual) == 0);
}

TEST_CASE("points outside of the region, at its border, or hidden have no place, and say why") {
  Match m;
  m.matcher->begin_frame(1, true, 0);
  m.predict({});
  m.predicted[0].x = m.rig.region->origin() - Vec2{1, -50};
  m.predicted[1].x = m.rig.region->origin() + Vec2{1, 50};
  m.predicted[2].visible = false;
  m.match(0);
  CHECK(m.seen[0].reason == Reason::not_visible);
  CHECK(m.seen[1].reason == Reason::outside_image);
  CHECK(m.seen[2].reason == Reason::not_visible);
  CHECK(m.seen[3].reason == Reason::found);
  CHECK(m.matcher->observation_count() == m.count());
  m.matcher->limit_steps(0);
  CHECK(m.search(2, {}) == 0);
  for (std::size_t k = 0; k < m.count(); ++k) CHECK(m.seen[k].reason == Reason::not_visible);
}

TEST_CASE("a later search of a frame reaches less far than its first one") {
  Match m;
  m.still_frame(1);
  REQUIRE(m.search(2, {}) == m.count());
  for (std::size_t k = 0; k < m.count(); ++k) m.seen[k].reason = Reason::diverged;
  m.predict({1.5f * kTuning.later_reach_px, 0});
  m.match(1);
  for (std::size_t k = 0; k < m.count(); ++k)
    CHECK_FALSE((m.seen[k].reason == Reason::found && m.seen[k].cue == Cue::patch &&
                 length(m.seen[k].x - m.at[k]) < 0.3f));
}

TEST_CASE("a match that is hardly like its template counts in the first round only") {
  Match m;
  Random random(3);
  std::vector<std::uint8_t> noisy = film().frames[0];
  for (std::uint8_t& grey : noisy)
    grey =
        static_cast<std::uint8_t>(clamp(0.35f * static_cast<float>(grey) + 80 + 9 * random.normal(), 0, 255));
  m.show(noisy);
  m.matcher->start(false);
  m.search(1, {});
  const auto least = [&] {
    float score = 1;
    for (std::size_t k = 0; k < m.count(); ++k)
      if (m.seen[k].reason == Reason::found) score = min(score, m.seen[k].score);
    return score;
  };
  CHECK(least() < kTuning.min_correlation);
  CHECK(least() >= kTuning.min_correlation - kTuning.early_correlation_slack);
  m.match(1);
  CHECK(least() >= kTuning.min_correlation);
}

TEST_CASE(
    "where the last round's search finds no template the point is followed, if tracking back returns to it") {
  Match m;
  m.still_frame(1);
  Random random(3);
  std::vector<std::uint8_t> noisy = film().frames[0];
  for (std::uint8_t& grey : noisy)
    grey = static_cast<std::uint8_t>(
        clamp(0.35f * static_cast<float>(grey) + 80 + 25 * random.normal(), 0, 255));
  const auto count_with = [&](Reason reason) {
    std::size_t n = 0;
    for (std::size_t k = 0; k < m.count(); ++k) n += m.seen[k].reason == reason;
    return n;
  };
  for (int frame = 0; frame < 2; ++frame) m.show(noisy);
  m.search(2, {});
  m.predict({1.1f * kTuning.rematch_move_px, 0});
  m.match(1);
  CHECK(count_with(Reason::found) > m.count() / 2);
  CHECK(count_with(Reason::forward_backward) > 0);
}

TEST_CASE(
    "a point is followed without its template for so many frames in a row, with a quarter of the weight") {
  constexpr std::size_t k = 5;
  for (const bool may_follow : {true, false}) {
    CAPTURE(may_follow);
    Match m;
    m.matcher->start(may_follow);
    m.still_frame(1);
    std::uint32_t number = 2;
    const auto is_followed = [&](bool ends_well = true) {
      m.show(film().frames[0]);
      m.search(number++, {});
      m.seen[k].reason = Reason::low_correlation;
      m.match(1);
      const bool is_flow = m.seen[k].reason == Reason::found && m.seen[k].cue == Cue::flow;
      if (!is_flow) CHECK(m.seen[k].reason == Reason::low_correlation);
      if (is_flow) CHECK(length(m.seen[k].x - m.at[k]) < 0.1f);
      m.matcher->end_frame(m.frame(), ends_well);
      return is_flow;
    };
    if (!may_follow) {
      CHECK_FALSE(is_followed());
      continue;
    }
    for (int again = 0; again < 2; ++again) {
      for (int i = 0; i < (again == 0 ? 5 : int{kTuning.frame_to_frame_most}); ++i) CHECK(is_followed());
      if (again == 0) m.still_frame(number++);  // its template was found again
    }
    CHECK_FALSE(is_followed());
    CHECK_FALSE(m.point(k).was_found);
    m.still_frame(number++);
    CHECK(is_followed());
    const PatchResult r = m.rig.templates->match_from_previous(m.at[k], m.rig.region.object, m.at[k], {});
    CHECK(m.seen[k].information.xx == doctest::Approx(0.25 * double(r.information.xx)).epsilon(0.01));
    CHECK(is_followed(false));
    CHECK_FALSE(is_followed());  // a bad frame: it was nowhere
  }
}

TEST_CASE(
    "first passes take points by turns, until each had one; none that was lost, and none after a bad frame") {
  ManyPoints m;
  std::set<std::size_t> all;
  std::size_t sum = 0;
  for (std::uint32_t n = 1; n <= m.ratio(); ++n) {
    const std::set<std::size_t> points = m.first_pass(n);
    CHECK(points.size() <= m.count() / m.ratio() + 1);
    sum += points.size();
    all.insert(points.begin(), points.end());
  }
  CHECK(all.size() == m.count());
  CHECK(sum == m.count());
  m.matcher->begin_frame(1, false, 0);
  CHECK_FALSE(m.matcher->run_first_pass(m.frame(), m.rig.estimator.object));
  m.rig.templates.object[7].was_found = false;
  for (std::uint32_t n = 1; n <= m.ratio(); ++n) CHECK(m.first_pass(n).count(7) == 0);
  const std::size_t enough = kTuning.first_pass_least_ratio * kTuning.first_pass_points;
  for (std::size_t k = 0; k < m.count(); ++k) m.point(k).was_found = k > 0 && k < enough;
  CHECK(m.first_pass(1).empty());  // one point too few
  m.point(0).was_found = true;
  CHECK_FALSE(m.first_pass(1).empty());
}

TEST_CASE("points of a first pass that fails are not searched for again before the solve of round 0") {
  ManyPoints m;
  m.matcher->begin_frame(1, true, 0);
  Random random(3);
  std::vector<std::uint8_t> noise = film().frames[0];
  for (std::uint8_t& grey : noise) grey = static_cast<std::uint8_t>(random.below(256));
  for (int frame = 0; frame < 2; ++frame) m.show(noise);
  REQUIRE_FALSE(m.matcher->run_first_pass(m.frame(), m.rig.estimator.object));  // it finds too few points
  const std::uint32_t searches = m.matcher->work().searches;
  REQUIRE(searches > 0);
  CHECK(m.match(0) == m.count() - searches);
  std::size_t followed = 0;
  for (std::size_t k = 0; k < m.count(); ++k) followed += m.seen[k].cue == Cue::flow;
  CHECK(followed == 0);
}

TEST_CASE(
    "a first pass is made where the one before has brought the other points nearer, and tried now and then") {
  constexpr std::uint32_t kTried = kTuning.first_pass_retry_frames;
  // Whether the frame after one has a first pass. \param pass, others  px, how far points were from where they were expected.
  const auto has_one_after = [](float pass, float others, std::uint32_t number, bool is_good = true) {
    ManyPoints m;
    const std::set<std::size_t> points = m.first_pass(1);
    REQUIRE(points.size() > 0);
    m.predict({});
    m.match(1);
    for (std::size_t k = 0; k < m.count(); ++k) {
      m.seen[k].reason = Reason::found;
      m.seen[k].x = m.predicted[k].x + Vec2{0, points.count(k) > 0 ? pass : others};
    }
    for (const std::size_t k : points) {
      const Prediction p = m.rig.estimator->predict(m.point(k).id);
      m.seen[k].x = p.x + Vec2{0, pass};
    }
    m.matcher->end_frame(m.frame(), is_good);
    for (std::size_t k = 0; k < m.count(); ++k) m.point(k).was_found = true;
    const std::set<std::size_t> next = m.first_pass(number);
    m.predict({12, 0});
    m.match(1);
    std::size_t others_found = 0;
    for (std::size_t k = 0; k < m.count(); ++k)
      others_found +=
          next.count(k) == 0 && m.seen[k].reason == Reason::found && length(m.seen[k].x - m.at[k]) < 0.3f;
    // The other points' searches reach as far as those after the last first pass had to.
    if (!next.empty()) CHECK((2 * others_found > m.count() - next.size()) == (others >= 1 || !is_good));
    return !next.empty();
  };
  CHECK(has_one_after(0.3f, 3, kTried));
  CHECK(has_one_after(3, 0.3f, kTried + 1));
  CHECK(has_one_after(3, 1, kTried + 1));
  CHECK_FALSE(has_one_after(1, 1, kTried + 1));
  CHECK_FALSE(has_one_after(1, 3, kTried - 1));
  CHECK(has_one_after(1, 1, kTried));
  CHECK(has_one_after(1, 1, kTried + 1, false));  // after a bad frame nothing is known
}

}  // namespace template_matcher_test
