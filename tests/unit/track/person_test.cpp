// The estimate of the person: equations of which a frame's unknowns are eliminated, means a view, and rows of observations.
#include <doctest/doctest.h>

#include <cmath>

#include "face_film.hpp"
#include "model_builder.hpp"
#include "random.hpp"
#include "track/person_estimate.hpp"
#include "track/person_rows.hpp"

namespace person_test {

using namespace pliant;

namespace {

/// Random equations with a known solution.
struct Problem {
  InArena<PersonEquations> equations;
  std::vector<float> x;

  Problem(std::size_t unknowns, std::size_t rows, std::uint32_t seed) : equations(unknowns) {
    Random random(seed);
    for (std::size_t k = 0; k < unknowns; ++k) x.push_back(random.normal());
    equations->reset();
    std::vector<float> row(unknowns);
    for (std::size_t r = 0; r < rows; ++r) {
      float value = 0;
      for (std::size_t k = 0; k < unknowns; ++k) {
        row[k] = random.normal();
        value += row[k] * x[k];
      }
      equations->add(row.data(), value, 0.5f);
    }
  }
};

constexpr std::size_t kKept = 4;

/// A mean of views whose information says that unknown k has the value k + 1.
void add_view(PersonEstimate& estimate, std::size_t view, float weight, const std::vector<float>& now) {
  InArena<PersonEquations> frame{kKept};
  frame->reset();
  for (std::size_t k = 0; k < kKept; ++k) frame->add_prior(k, static_cast<float>(k + 1) - now[k], weight);
  estimate.add(view, frame.object, now.data());
}

std::vector<float> solved(const PersonEstimate& estimate) {
  InArena<PersonEquations> equations{kKept};
  equations->reset();
  const std::vector<float> sd(kKept, 1.0f), start(kKept, 0.0f);
  std::vector<float> x(kKept);
  REQUIRE(estimate.solve(start.data(), sd.data(), equations.object, x.data()));
  return x;
}

}  // namespace

TEST_CASE("unknowns that are eliminated leave the solution of the others as it is") {
  for (const std::size_t first : {std::size_t{0}, std::size_t{1}, std::size_t{7}}) {
    Problem p(10, 30, 5);
    p.equations->eliminate(first);
    std::vector<float> x(10 - first);
    REQUIRE(p.equations->solve(first, x.data()));
    for (std::size_t k = first; k < 10; ++k)
      CHECK(x[k - first] == doctest::Approx(double(p.x[k])).epsilon(1e-3));
  }
}

TEST_CASE("what nothing determines is left out by the elimination, and refused by the solution") {
  InArena<PersonEquations> e{std::size_t{3}};
  e->reset();
  e->add_prior(2, 5, 1);
  e->eliminate(2);
  float x[3];
  REQUIRE(e->solve(2, x));
  CHECK(x[0] == doctest::Approx(5));
  CHECK_FALSE(e->solve(0, x));
}

TEST_CASE("views are 15 degrees apart, to the left and to the right of the frontal one") {
  const auto view_at = [](float degrees) {
    const Vec3 d = Vec3{std::sin(degrees / 57.29578f), 0.2f, std::cos(degrees / 57.29578f)};
    return PersonEstimate::view_towards(d);
  };
  CHECK(view_at(0) == 4);
  CHECK(view_at(7) == 4);
  CHECK(view_at(8) == 5);
  CHECK(view_at(-8) == 3);
  CHECK(view_at(30) == 6);
  CHECK(view_at(-60) == 0);
  CHECK(view_at(60) == 8);
  CHECK(view_at(89) == 8);
}

TEST_CASE("frames of one view are averaged: a hundred say no more than one") {
  InArena<PersonEstimate> one{kKept}, many{kKept};
  one->clear();
  many->clear();
  const std::vector<float> now = {0, 0, 0, 0.5f};
  add_view(one.object, 4, 3, now);
  for (int k = 0; k < 100; ++k) add_view(many.object, 4, 3, now);
  CHECK(many->frames(4) == kPersonEstimateTuning.most_frames);
  const auto a = solved(one.object), b = solved(many.object);
  for (std::size_t k = 0; k < kKept; ++k) CHECK(a[k] == doctest::Approx(double(b[k])));
  // The prior has deviation 1, the frame information 3: 3/4 of the way.
  CHECK(a[3] == doctest::Approx(3.0));
  add_view(one.object, 7, 8, now);
  CHECK(solved(one.object)[3] == doctest::Approx(4.0 * 11 / 12));
}

TEST_CASE("an estimate agrees with what the equations know besides its views, counted from zero") {
  InArena<PersonEstimate> estimate{kKept};
  estimate->clear();
  add_view(estimate.object, 4, 1e6f, std::vector<float>(kKept, 0));  // unknown k is k + 1
  InArena<PersonEquations> equations{kKept};
  equations->reset();
  const std::vector<float> now(kKept, 10);
  for (std::size_t k = 0; k < kKept; ++k) equations->add_prior(k, -5, 3e6f);  // 5
  equations->count_from_zero(0, now.data());
  const std::vector<float> sd(kKept, 1.0f), start(kKept, 0.0f);
  std::vector<float> x(kKept);
  REQUIRE(estimate->solve(start.data(), sd.data(), equations.object, x.data()));
  for (std::size_t k = 0; k < kKept; ++k)
    CHECK(x[k] == doctest::Approx(0.25 * (static_cast<double>(k) + 1) + 0.75 * 5).epsilon(1e-3));
}

TEST_CASE("an estimate is used when there are two views, and is empty after clear") {
  InArena<PersonEstimate> e{kKept};
  e->clear();
  const std::vector<float> now(kKept, 0.0f);
  CHECK_FALSE(e->is_usable());
  add_view(e.object, 3, 1, now);
  add_view(e.object, 3, 1, now);
  CHECK_FALSE(e->is_usable());
  add_view(e.object, 4, 1, now);
  CHECK(e->is_usable());
  e->clear();
  CHECK_FALSE(e->is_usable());
  for (const float x : solved(e.object)) CHECK(x == 0);
}

namespace {

/// The face at a view turned against that of a key frame.
struct Views {
  const Model& model = baked_face().model;
  Cascade& cascade = baked_face().cascade;
  std::vector<float> q = baked_face().rest();
  View key, now;
  std::vector<unsigned char> memory = std::vector<unsigned char>(1 << 20);

  Views() {
    const Camera camera = centred_camera(320, 240, 400);
    Pose pose = frontal_pose(cascade, q.data(), camera, 240, 0.6f);
    key = view_of(pose, camera);
    pose.q = exp_rotation({0.1f, 0.5f, 0});
    now = view_of(pose, camera);
  }
  Vec2 image(const View& view, Vec2 uv, const std::vector<float>& at) {
    Vec2 x;
    REQUIRE(Projector(view, true).project(cascade.surface_point(uv, at.data()), &x));
    return x;
  }
  /// The (u,v) near `uv` that `view` sees at x: Newton's method with differences.
  Vec2 seen_at(const View& view, Vec2 x, Vec2 uv, const std::vector<float>& at) {
    for (int k = 0; k < 8; ++k) {
      const float h = 1e-3f;
      const Vec2 f = image(view, uv, at), a = (1 / h) * (image(view, uv + Vec2{h, 0}, at) - f),
                 b = (1 / h) * (image(view, uv + Vec2{0, h}, at) - f), r = x - f;
      const float area = a.x * b.y - a.y * b.x;
      uv = uv + Vec2{(r.x * b.y - r.y * b.x) / area, (a.x * r.y - a.y * r.x) / area};
    }
    return uv;
  }
};

/// Rows of the identity, without free expressions, in the turned view.
struct RowsAtView : Views {
  std::vector<std::uint8_t> is_free = std::vector<std::uint8_t>(q.size(), 0);
  Arena arena{memory.data(), memory.size()};
  PersonRows rows;
  PersonEquations equations;

  RowsAtView() {
    rows.lay_out(arena, model);
    rows.start(model, is_free.data());
    rows.begin(arena, model, now, q.data());
    equations.lay_out(arena, rows.count());
  }
};

}  // namespace

TEST_CASE("a template's row is the motion of the point that stays where its key frame shows it") {
  RowsAtView v;
  PersonRows& rows = v.rows;
  PersonEquations& e = v.equations;
  REQUIRE(rows.count() == kPoseUnknowns + rows.kept());
  int compared = 0;
  for (const std::string name : {"ibug33", "ibug42", "ibug48"}) {
    const Vec2 uv = baked_face().uv(name), at_key = v.image(v.key, uv, v.q), at = v.image(v.now, uv, v.q);
    for (std::size_t k = 0; k < rows.kept(); ++k) {
      const std::string parameter = k < 3 ? "" : v.model.parameters()[rows.identity(k - 3)].name;
      if (k >= 3 && parameter != "faceDepth" && parameter != "faceWidth") continue;  // of the whole face
      // Where the point goes for a small change of one unknown.
      const float step = k < 3 ? 0.01f : 0.1f;
      auto moved = v.q;
      View key = v.key, now = v.now;
      if (k < 3) {
        const Quat turn = exp_rotation({k == 0 ? step : 0, k == 1 ? step : 0, k == 2 ? step : 0});
        key.q = key.q * turn;
        now.q = now.q * turn;
      } else {
        moved[rows.identity(k - 3)] = step;
      }
      const Vec2 to = v.image(now, v.seen_at(key, at_key, uv, moved), moved);
      // An observation there: g of the unknown over its h is the step, if the row is right.
      Observation o;
      o.x = to;
      o.information = {1e6f, 0, 1e6f};
      e.reset();
      rows.add(o, uv, v.cascade.surface_frame(uv, v.q.data()), &v.key, e);
      const std::size_t unknown = kPoseUnknowns + k;
      if (length(to - at) < 0.04f) continue;
      ++compared;
      CAPTURE(name);
      CAPTURE(k);
      CHECK(e.g(unknown) / e.h(unknown, unknown) == doctest::Approx(double(step)).epsilon(0.15));
    }
  }
  CHECK(compared >= 5);
}

TEST_CASE("an edge's row is the motion of its place on the face, across the edge") {
  RowsAtView v;
  PersonRows& rows = v.rows;
  PersonEquations& e = v.equations;
  e.reset();
  const Vec2 uv = baked_face().uv("ibug57");
  Observation o;
  o.cue = Cue::edge;
  o.x = v.image(v.now, uv, v.q) + Vec2{5, 0.5f};  // 5 px along the edge say nothing
  o.information = {0, 0, 100};
  rows.add(o, uv, v.cascade.surface_frame(uv, v.q.data()), nullptr, e);
  int compared = 0;
  for (std::size_t k = 3; k < rows.kept(); ++k) {
    auto moved = v.q;
    moved[rows.identity(k - 3)] = 0.1f;
    const float across = 10 * (v.image(v.now, uv, moved).y - v.image(v.now, uv, v.q).y);
    const std::size_t unknown = kPoseUnknowns + k;
    if (magnitude(across) < 0.05f) continue;
    ++compared;
    CHECK(e.g(unknown) / e.h(unknown, unknown) == doctest::Approx(double(0.5f / across)).epsilon(0.05));
  }
  CHECK(compared >= 3);
}

TEST_CASE("a template near the silhouette says nothing of the person, an edge there does") {
  RowsAtView v;
  View turned = v.now;
  turned.q = exp_rotation({0, 1.3f, 0});  // 74 degrees
  const Vec2 uv = baked_face().uv("ibug30");
  Observation o;
  o.information = {100, 0, 100};
  const auto weight = [&](const View& view, Cue cue, const View* key) {
    Arena arena(v.memory.data() + v.memory.size() / 2, v.memory.size() / 2);
    v.rows.begin(arena, v.model, view, v.q.data());
    o.cue = cue;
    o.x = v.image(view, uv, v.q);
    v.equations.reset();
    v.rows.add(o, uv, v.cascade.surface_frame(uv, v.q.data()), key, v.equations);
    return v.equations.h(0, 0);
  };
  CHECK(weight(v.key, Cue::patch, &v.key) > 0);
  CHECK(weight(turned, Cue::patch, &v.key) == 0);
  CHECK(weight(turned, Cue::edge, nullptr) > 0);
}

TEST_CASE("expressions that are free are unknowns, and observations without information add nothing") {
  Views v;
  std::vector<std::uint8_t> is_free(v.q.size(), 1);
  Arena arena(v.memory.data(), v.memory.size());
  PersonRows rows;
  rows.lay_out(arena, v.model);
  rows.start(v.model, is_free.data());
  CHECK(rows.count() == kPoseUnknowns + 3 + v.q.size());
  PersonEquations e;
  e.lay_out(arena, rows.count());
  e.reset();
  Observation o;
  o.information = {};
  rows.begin(arena, v.model, v.now, v.q.data());
  rows.add(o, {0.5f, 0.5f}, v.cascade.surface_frame({0.5f, 0.5f}, v.q.data()), &v.key, e);
  for (std::size_t k = 0; k < rows.count(); ++k) CHECK(e.h(k, k) == 0);
}

}  // namespace person_test
