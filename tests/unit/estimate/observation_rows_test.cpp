#include "estimate/observation_rows.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "estimator_scene.hpp"
#include "posed_egg.hpp"
#include "random.hpp"

namespace observation_rows_test {

using namespace pliant;

namespace {

Observation observation(std::uint16_t id, Vec2 x, Sym2 information = {4, 0, 4}, Cue cue = Cue::patch) {
  Observation o;
  o.id = id;
  o.x = x;
  o.information = information;
  o.cue = cue;
  return o;
}

/// Thirty points, and rows without model error unless asked for.
struct Rig {
  PosedEgg egg;
  InArena<SurfacePoints> points{std::size_t{30}, std::size_t{0}, egg.samples()};
  InArena<ObservationRows> rows{std::size_t{30}};

  explicit Rig(const RowPolicy& policy = {0x07, 0, 0.5f}) {
    points->clear(egg.samples());
    std::uint16_t id;
    for (int k = 0; k < 30; ++k)
      REQUIRE(points->add(PointKind::surface, {0.5f, 0.5f}, {}, egg.cascade.object, egg.state.q, &id) ==
              Status::ok);
    rows->start(policy);
  }
  void gather(std::vector<Observation>& o) { rows->gather({o.data(), o.size()}, points.object, 1); }
};

}  // namespace

TEST_CASE("consecutive observations of one point are one row; points count twice, lines once") {
  Rig rig;
  std::vector<Observation> o = {observation(3, {1, 1}), observation(5, {2, 2}, {4, 0, 0}, Cue::edge),
                                observation(5, {9, 2}, {4, 0, 0}, Cue::edge), observation(7, {3, 3})};
  o.push_back(observation(8, {0, 0}));
  o.back().reason = Reason::low_correlation;
  o.push_back(observation(9, {0, 0}));
  o.back().reason = Reason::not_visible;
  rig.gather(o);
  REQUIRE(rig.rows->count() == 3);
  CHECK(rig.rows.object[1].count == 2);
  CHECK(rig.rows.object[1].is_line);
  CHECK(rig.rows->equations() == 5);
  CHECK(rig.rows->searched() == 4);
  CHECK(rig.rows->patches_searched() == 3);
}

TEST_CASE("unusable observations are marked, and make no row") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Rig rig;
  std::vector<Observation> o = {observation(1, {nan, 1}),
                                observation(30, {1, 1}),
                                observation(2, {1, 1}, {-1, 0, 4}),
                                observation(3, {1, 1}, {0, 0, 0}),
                                observation(4, {1, 1}, {4, nan, 4}),
                                observation(6, {1, 1}, {1, 5, 1}),
                                observation(7, {1, 1}, {4, 0, 2e12f}),
                                observation(8, {1, 1}, {2e12f, 0, 4})};
  o.push_back(observation(5, {1, 1}));
  o.back().cue = static_cast<Cue>(200);
  rig.gather(o);
  CHECK(rig.rows->count() == 0);
  for (const Observation& each : o) CHECK(each.reason == Reason::not_visible);
  Rig without_flow({0x05, 0, 0});
  std::vector<Observation> flow = {observation(1, {1, 1}, {4, 0, 4}, Cue::flow)};
  without_flow.gather(flow);
  CHECK(without_flow.rows->count() == 0);
  CHECK(flow[0].reason == Reason::rejected);
}

TEST_CASE("lengths are in standard deviations; of alternatives the nearest counts") {
  Rig rig;
  std::vector<Observation> o = {observation(1, {10, 20}), observation(2, {0, 0}, {4, 0, 0}, Cue::edge),
                                observation(2, {8, 0}, {4, 0, 0}, Cue::edge),
                                observation(3, {3, -1}, {2, 2, 2}, Cue::edge)};
  rig.gather(o);
  rig.rows->measure(0, {13, 24});
  CHECK(rig.rows->length(0) == doctest::Approx(10));  // 5 px at a deviation of 0.5 px
  CHECK(rig.rows->residual(0).x == -3);
  CHECK(rig.rows->squared_px(0) == doctest::Approx(25));
  rig.rows->measure(1, {7, 50});
  CHECK(rig.rows.object[1].chosen == 1);
  CHECK(rig.rows->squared_px(1) == doctest::Approx(1));
  rig.rows->measure(1, {1, 50});
  CHECK(rig.rows.object[1].chosen == 0);
  rig.rows->measure(2, {0, 0});
  CHECK(rig.rows->squared_px(2) == doctest::Approx(2));  // across a line at 45 degrees: ((3 - 1) / sqrt 2)^2
}

TEST_CASE("one direction that weighs less than a thousandth of the other makes a line, whatever the size") {
  Rig rig;
  for (const float w : {0.04f, 4.0f, 400.0f}) {
    std::vector<Observation> o = {observation(1, {0, 0}, {w, 0, 0.5e-3f * w}),
                                  observation(2, {0, 0}, {w, 0, 2e-3f * w})};
    rig.gather(o);
    CHECK(rig.rows.object[0].is_line);
    CHECK_FALSE(rig.rows.object[1].is_line);
  }
}

TEST_CASE(
    "the cost is half the squared distances, in deviations, over the squared scale, of points and of lines") {
  Rig rig;
  std::vector<Observation> o = {observation(1, {3, 4}), observation(2, {2, 7}, {4, 0, 0}, Cue::edge)};
  rig.gather(o);
  for (std::size_t k = 0; k < 2; ++k) rig.rows->measure(k, {0, 0});
  const Sym2 w = rig.rows->information(1);  // with the edges' own model error
  const double of_line = double(w.xx) * 2 * 2;
  CHECK(rig.rows->cost(Loss::squares, 2, false) == doctest::Approx(0.5 * (10 * 10 + of_line) / 4));
  rig.rows.object[0].is_kept = false;
  CHECK(rig.rows->cost(Loss::squares, 2, true) == doctest::Approx(0.5 * of_line / 4));
}

TEST_CASE("the model error is added to the noise, and keeps lines lines") {
  Rig exact, inexact({0x07, 1, 0});
  std::vector<Observation> o = {observation(1, {0, 0}), observation(2, {0, 0}, {4, 0, 0}, Cue::edge)};
  exact.gather(o);
  inexact.gather(o);
  CHECK(exact.rows->information(0).xx == 4);
  CHECK(inexact.rows->information(0).xx == doctest::Approx(1 / (1 + 0.25)));
  CHECK(inexact.rows->information(1).yy == 0);
}

TEST_CASE("the more exact a line, the nearer its information is to that of the model error alone") {
  Rig rig({0x07, 1, 0});
  const float variance = kObservationRowsTuning.edge_error_mm * kObservationRowsTuning.edge_error_mm;
  for (const float w : {1e2f, 1e5f, 1e7f, 1e8f, 1e10f, 1e12f}) {
    std::vector<Observation> o = {observation(1, {0, 0}, {0.36f * w, 0.48f * w, 0.64f * w}, Cue::edge)};
    rig.gather(o);
    REQUIRE(rig.rows->count() == 1);
    const Sym2 found = rig.rows->information(0);
    const float expected = 1 / (1 / w + variance);
    CHECK(found.xx == doctest::Approx(static_cast<double>(0.36f * expected)).epsilon(0.03));
    CHECK(found.xy == doctest::Approx(static_cast<double>(0.48f * expected)).epsilon(0.03));
    CHECK(found.yy == doctest::Approx(static_cast<double>(0.64f * expected)).epsilon(0.03));
  }
}

TEST_CASE("normal residuals have scale 1, as points and as lines; few outliers do not change it") {
  for (const bool lines : {false, true}) {
    Rig rig;
    Random random(6);
    double sum = 0;
    for (int trial = 0; trial < 60; ++trial) {
      std::vector<Observation> o;
      for (std::uint16_t id = 0; id < 30; ++id)
        o.push_back(observation(id, {0.5f * random.normal(), 0.5f * random.normal()},
                                lines ? Sym2{4, 0, 0} : Sym2{4, 0, 4}, lines ? Cue::edge : Cue::patch));
      for (std::uint16_t id = 0; id < 4; ++id) o[id].x.x += 40;
      if (lines)
        for (Observation& each : o) each.information.xx = 4;
      rig.gather(o);
      for (std::size_t k = 0; k < rig.rows->count(); ++k) rig.rows->measure(k, {0, 0});
      sum += double(rig.rows->scale()) / 60;
      CHECK(rig.rows->outlier_fraction(1.5f) >= 4.0f / 30);
    }
    // Edges have a model error of their own, 1.7 px here.
    CHECK(sum == doctest::Approx(lines ? 1.0 : 1.15).epsilon(0.15));
  }
}

TEST_CASE("the scale of a cue grows with residuals larger than its stated noise, and needs eight rows") {
  Rig rig;
  Random random(7);
  const auto frame = [&](std::uint16_t rows) {
    std::vector<Observation> o;
    for (std::uint16_t id = 0; id < rows; ++id)
      o.push_back(observation(id, {1.5f * random.normal(), 1.5f * random.normal()}));
    rig.gather(o);
    for (std::size_t k = 0; k < rig.rows->count(); ++k) rig.rows->measure(k, {0, 0});
    rig.rows->update_cue_scales();
  };
  frame(7);
  CHECK(rig.rows->cue_scale(Cue::patch) == 1);
  for (int k = 0; k < 20; ++k) frame(30);
  CHECK(rig.rows->cue_scale(Cue::patch) == doctest::Approx(3).epsilon(0.25));
  CHECK(rig.rows->cue_scale(Cue::edge) == 1);
  const double scale = double(rig.rows->cue_scale(Cue::patch));
  frame(1);
  CHECK(rig.rows->information(0).xx == doctest::Approx(4 / (scale * scale)));
  rig.rows->start({0x07, 0, 0.5f});
  CHECK(rig.rows->cue_scale(Cue::patch) == 1);
}

TEST_CASE(
    "of alternatives, lines too, the one that counts is measured as it would be alone, and the first of "
    "equals") {
  const Observation one = observation(4, {3, 1}, {4, 0, 0}, Cue::edge),
                    other = observation(4, {-9, 1}, {1, 0, 0}, Cue::edge);
  for (const bool is_first : {false, true}) {
    Rig rig, alone;
    std::vector<Observation> o = {is_first ? one : other, is_first ? other : one}, single = {one};
    rig.gather(o);
    alone.gather(single);
    rig.rows->measure(0, {2, 0});
    alone.rows->measure(0, {2, 0});
    CHECK(rig.rows.object[0].chosen == (is_first ? 0 : 1));
    CHECK(rig.rows->length(0) == alone.rows->length(0));
    CHECK(rig.rows->information(0).xx == alone.rows->information(0).xx);
    CHECK(rig.rows->residual(0).x == 1);
  }
  Rig rig;
  std::vector<Observation> o = {one, one, one};
  o[0].reason = Reason::low_correlation;
  rig.gather(o);
  rig.rows->measure(0, {3, 0});
  CHECK(rig.rows.object[0].chosen == 1);
}

TEST_CASE("what one round rejected takes part in the next; what does not fit into the rows does not") {
  Rig rig;
  std::vector<Observation> o;
  for (int k = 0; k < 31; ++k) o.push_back(observation(static_cast<std::uint16_t>(k % 2), {1, 1}));
  o[3].reason = Reason::rejected;
  rig.gather(o);
  CHECK(rig.rows->count() == 30);
  CHECK(o[3].reason == Reason::found);
  CHECK(o[29].reason == Reason::found);
  CHECK(o[30].reason == Reason::not_visible);
}

TEST_CASE("of more than 255 alternatives the others are a row of their own") {
  Rig rig;
  std::vector<Observation> o(300, observation(2, {50, 0}));
  o[299].x = {1, 0};
  rig.gather(o);
  REQUIRE(rig.rows->count() == 2);
  CHECK(rig.rows.object[0].count == 255);
  CHECK(rig.rows.object[1].count == 45);
  for (std::size_t k = 0; k < 2; ++k) rig.rows->measure(k, {0, 0});
  CHECK(rig.rows->residual(0).x == 50);
  CHECK(rig.rows->residual(1).x == 1);
}

TEST_CASE("the scale is that of the rows that are kept, from 1 to 8") {
  const auto scale_of = [](float size, float size_of_others) {
    Rig rig;
    std::vector<Observation> o;
    for (std::uint16_t id = 0; id < 30; ++id)
      o.push_back(observation(id, {id < 10 ? size : size_of_others, 0}));
    rig.gather(o);
    for (std::size_t k = 0; k < 30; ++k) {
      rig.rows->measure(k, {0, 0});
      rig.rows.object[k].is_kept = k < 10;
    }
    return rig.rows->scale();
  };
  CHECK(scale_of(0, 5) == 1);
  CHECK(scale_of(1000, 0) == 8);
  const float usual = scale_of(2, 2);
  CHECK(usual > 1);
  CHECK(usual < 8);
  CHECK(scale_of(2, 0) == usual);
  CHECK(scale_of(2, 100) == usual);
}

TEST_CASE("keep_within keeps exactly the rows that fit, whether they were kept or not") {
  Rig rig;
  std::vector<Observation> o = {observation(1, {0, 0}), observation(2, {5, 0}), observation(3, {1, 0})};
  rig.gather(o);
  rig.rows.object[0].is_kept = false;
  for (std::size_t k = 0; k < 3; ++k) rig.rows->measure(k, {0, 0});
  rig.rows->keep_within(2);
  CHECK(rig.rows.object[0].is_kept);
  CHECK_FALSE(rig.rows.object[1].is_kept);
  CHECK(rig.rows.object[2].is_kept);
}

TEST_CASE("hostile observations are ignored: NaN, far away, unknown points, negative information") {
  estimator_scene::Scene scene;
  InArena<Estimator> e(scene.model, scene.limits);
  scene.start(e.object, 0.1f);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  e->begin(1);
  auto seen = scene.observe(0.1f, scene.q, 0);
  seen[0].x.x = nan;
  seen[1].id = 59;
  seen[2].id = 6000;
  seen[3].information.xx = -1;
  seen[4].information.xy = nan;
  seen[5].x.y = -1e20f;  // its square is infinite
  seen[6].score = nan;
  CHECK(is_finite(e->solve(estimator_scene::span(seen)).final_cost));
  const FrameResult result = e->end();
  CHECK(result.tracked == seen.size() - 7);
  CHECK(result.state == TrackState::tracking);
  CHECK(is_finite(result.score));
  for (int i = 0; i < 7; ++i) CHECK(seen[static_cast<std::size_t>(i)].reason == Reason::not_visible);
  CHECK(is_finite(result.pose));
}

}  // namespace observation_rows_test
