// Landmarks of the face's outline: at their own place while that faces the camera, then on the contour.
#include "fit/silhouette_matcher.hpp"

#include <doctest/doctest.h>

#include "open_model.hpp"
#include "random.hpp"

namespace silhouette_matcher_test {

using namespace pliant;

namespace {

struct Turned : OpenedEgg {
  View view;
  explicit Turned(float yaw_rad)
      : OpenedEgg(6),
        view(view_of({exp_rotation({0, yaw_rad, 0}), {0, 0, 800}}, centred_camera(640, 480, 900))) {}
};

/// Matches every landmark of the model, seen where its own place projects to.
template <class Check>
void match_all(const Turned& t, const Check& check) {
  InArena<Cascade> cascade(t.model);
  InArena<SilhouetteMatcher> matcher(t.model);
  REQUIRE(matcher->start(t.model) == Status::ok);
  const Projector projector(t.view, true);
  std::vector<Vec3> position;
  for (const Vec2 uv : t.model.base_uv()) position.push_back(cascade->surface_point(uv, t.q.data()));
  matcher->find_contour(position.data(), projector);
  for (const Landmark& l : t.model.landmarks()) {
    Correspondence c;
    c.uv = l.uv();
    c.is_silhouette = true;
    REQUIRE(projector.project(cascade->surface_point(c.uv, t.q.data()), &c.x));
    const SurfaceFrame own = cascade->surface_frame(c.uv, t.q.data());
    const Vec3 normal = projector.rotated(normalised(cross(own.pv, own.pu)));
    const bool is_turned_away =
        SilhouetteMatcher::is_turned_away(cascade.object, t.q.data(), projector, c.uv);
    check(c, -dot(normal, normalised(projector.to_camera(own.p))),
          is_turned_away ? matcher->nearest(c) : SilhouetteMatch{c.uv, {}});
  }
}

}  // namespace

TEST_CASE("a landmark whose place faces the camera stays there, one that turned away slides to the contour") {
  int stayed = 0, slid = 0;
  for (const float yaw : {-0.7f, -0.3f, 0.0f, 0.3f, 0.7f})
    match_all(Turned(yaw), [&](const Correspondence& c, float facing, const SilhouetteMatch& m) {
      const bool has_slid = dot(m.normal, m.normal) > 0;
      if (facing > 0.101f) CHECK_FALSE(has_slid);
      if (!has_slid) {
        ++stayed;
        CHECK(length(m.uv - c.uv) == 0);
        return;
      }
      ++slid;
      CHECK(length(m.normal) == doctest::Approx(1).epsilon(1e-4));
      CHECK(magnitude(m.uv.y - c.uv.y) <= 0.12f);
    });
  CHECK(stayed > 100);
  CHECK(slid > 10);
}

TEST_CASE("before a contour is found every landmark stays at its own place") {
  const Turned t(0.9f);
  InArena<SilhouetteMatcher> matcher(t.model);
  REQUIRE(matcher->start(t.model) == Status::ok);
  Correspondence c;
  c.uv = {0.02f, 0.5f};
  const SilhouetteMatch m = matcher->nearest(c);
  CHECK(length(m.uv - c.uv) == 0);
  CHECK(dot(m.normal, m.normal) == 0);
}

}  // namespace silhouette_matcher_test
