#include "estimate/visible_surface.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "model_builder.hpp"
#include "pliant/estimator_options.hpp"
#include "random.hpp"
#include "surface_rig.hpp"

namespace visible_surface_test {

using namespace pliant;
using Rig = EggSurface;

namespace {

/// The surface of a person that changes while the mesh becomes coarser, `lead` frames after it has begun to. \return vertices that
/// are not on it when the mesh is fine again.
std::size_t count_old_vertices(std::uint32_t lead) {
  Rig rig;
  const MeshPolicy follows = following(rig.egg.state.view, rig.egg.camera, 0.005f);
  REQUIRE(rig.surface->start(rig.egg.model) == Status::ok);
  rig.surface->adapt(rig.egg.cascade.object, rig.egg.state, follows);
  rig.update(0, 1);
  const int fine = rig.surface->mesh().vertex_count();
  std::uint32_t frame = 1;
  const auto follow_at = [&](float distance_mm, std::uint32_t frames) {
    rig.egg.pose({{}, {0, 5, distance_mm}});
    for (const std::uint32_t end = frame + frames; frame < end; ++frame) {
      rig.surface->follow_view(rig.egg.cascade.object, rig.egg.state, frame);
      rig.update(frame, 4);
    }
  };
  follow_at(7000, lead);
  rig.egg.q[0] = 1;
  rig.egg.cascade->set_free(Group::expression);
  rig.surface->revise(rig.egg.state.q, {});
  CHECK(rig.exact_count() == 0);
  follow_at(7000, 64);
  CHECK(rig.surface->mesh().vertex_count() < fine - 50);
  follow_at(700, 64);
  CHECK(rig.surface->mesh().vertex_count() >= fine);
  rig.update(frame, 1);
  return static_cast<std::size_t>(rig.surface->mesh().vertex_count()) - rig.exact_count();
}

}  // namespace

TEST_CASE("all vertices lie on the surface after a full update, with samples and without") {
  for (const bool keeps_samples : {true, false}) {
    Rig rig(0.1f, keeps_samples);
    rig.egg.q[5] = 0.3f;
    rig.egg.q[3] = 0.5f;
    CHECK(rig.exact_count() < rig.surface->mesh().vertex_count());
    rig.update(1, 1);
    CHECK(rig.exact_count() == rig.surface->mesh().vertex_count());
    for (VertexId v : rig.surface->mesh().vertices())
      CHECK(length(rig.surface->images()[v] - rig.egg.image_of(rig.surface->mesh().uv(v))) < 0.2f);
  }
}

TEST_CASE("with the most vertices that a limit can name the mesh is refined too") {
  PosedEgg egg;
  InArena<VisibleSurface> surface(egg.parameters(), VisibleSurfaceLimits{65535, 0, 16, {}});
  REQUIRE(surface->start(egg.model) == Status::ok);
  const int base = surface->mesh().vertex_count();
  surface->adapt(egg.cascade.object, egg.state, {});
  CHECK(surface->mesh().vertex_count() > base);
}

TEST_CASE("adaptation takes no more memory than is stated, whatever the number of vertices") {
  for (const int vertices : {3, 4, 5, 511, 512, 2048, 10922, 10923, 21845, 65534}) {
    MeshLimits limits;
    limits.vertices = static_cast<std::uint16_t>(vertices);
    limits.faces = static_cast<std::uint16_t>(std::min(2 * vertices, int{MeshLimits::kMostFaces}));
    CHECK(measured_bytes<Adapter>(limits) <= adaptation_bytes(limits.vertices));
  }
}

TEST_CASE("a slow expression moves one vertex in the interval, a fast one all of them") {
  Rig rig;
  const auto moved_by = [&rig](float jaw) {
    std::vector<Vec3> before(rig.surface->positions(), rig.surface->positions() + 300);
    rig.egg.q[5] += jaw;
    rig.update(1, 4);
    std::size_t moved = 0;
    for (VertexId v : rig.surface->mesh().vertices())
      moved += length(rig.surface->positions()[v] - before[v]) > 0;
    return moved;
  };
  const std::size_t slow = moved_by(0.01f), fast = moved_by(0.3f);
  CHECK(slow > 0);
  CHECK(fast > 3 * slow);
  CHECK(rig.exact_count() == rig.surface->mesh().vertex_count());
}

TEST_CASE(
    "after a change of the person the vertices turn at once, and are sampled again some in each frame") {
  Rig rig;
  const std::vector<Vec3> before(rig.surface->positions(), rig.surface->positions() + 300);
  const Quat turn = exp_rotation({0.05f, 0.1f, -0.07f});
  rig.surface->revise(rig.egg.state.q, turn);
  View turned = rig.egg.state.view;
  turned.q = turned.q * turn;
  const Projector at_first(rig.egg.state.view, true), now(turned, true);
  for (VertexId v : rig.surface->mesh().vertices())  // what the camera sees stays
    CHECK(length(now.rotated(rig.surface->positions()[v]) - at_first.rotated(before[v])) < 0.01f);
  const auto all = static_cast<std::size_t>(rig.surface->mesh().vertex_count()), each = renewed_vertices(all);
  REQUIRE(all > each);
  // The egg has not turned: vertices that were sampled again lie where they were.
  for (std::uint32_t frame = 1; frame <= all / each + 1; ++frame) {
    rig.update(frame, 4);
    const std::size_t exact = rig.exact_count();
    CHECK(exact >= (frame * each < all ? frame * each : all));
    if (frame * each < all) CHECK(exact < all);
  }
  rig.surface->revise(rig.egg.state.q, turn);
  CHECK(rig.exact_count() < all);
  rig.update(9, 1);
  CHECK(rig.exact_count() == all);
}

TEST_CASE("a point behind the surface is hidden, a point in front of it is not") {
  Rig rig;
  rig.surface->draw_depth(rig.egg.state.view, 1);
  const Projector projector(rig.egg.state.view, true);
  for (VertexId v : rig.surface->mesh().vertices()) {
    const Vec2 uv = rig.surface->mesh().uv(v);
    if (magnitude(uv.x - 0.5f) > 0.3f || magnitude(uv.y - 0.5f) > 0.3f) continue;
    const Vec3 p = projector.rotated(rig.surface->positions()[v]);
    const Vec2 x = rig.surface->images()[v];
    CHECK_FALSE(rig.surface->hides(x, p));
    CHECK(rig.surface->hides(x, p + Vec3{0, 0, 30}));
    CHECK_FALSE(rig.surface->hides(x, p - Vec3{0, 0, 30}));
  }
}

TEST_CASE("a drawing moves along with a small shift, and is made again after a turn") {
  Rig rig;
  rig.surface->draw_depth(rig.egg.state.view, 1);
  const Projector projector(rig.egg.state.view, true);
  const Vec2 x = rig.egg.image_of({0.5f, 0.5f});
  const Vec3 behind =
      projector.rotated(rig.egg.cascade->surface_point({0.5f, 0.5f}, rig.egg.state.q)) + Vec3{0, 0, 30};
  View shifted = rig.egg.state.view;
  shifted.tau = shifted.tau + Vec2{300, 0};
  rig.surface->draw_depth(shifted, 2);
  CHECK_FALSE(rig.surface->hides(x, behind));
  CHECK(rig.surface->hides(x + shifted.s * Vec2{300, 0}, behind));
  Rig turned(0.6f);
  View view = turned.egg.state.view;
  rig.surface->draw_depth(view, 2);
  turned.surface->draw_depth(view, 2);
  Random random(8);
  int differ = 0;
  for (int k = 0; k < 200; ++k) {
    const Vec2 at{random.uniform(150, 500), random.uniform(100, 400)};
    const Vec3 p{0, 0, random.uniform(-60, 60)};
    differ += rig.surface->hides(at, p) != turned.surface->hides(at, p);
  }
  CHECK(differ == 0);
}

TEST_CASE("surface_at inverts the projection") {
  Rig rig(0.25f);
  Random random(5);
  for (int k = 0; k < 100; ++k) {
    const Vec2 uv{random.uniform(0.2f, 0.8f), random.uniform(0.2f, 0.8f)};
    Vec2 back;
    REQUIRE(rig.surface->surface_at(rig.egg.cascade.object, rig.egg.state, rig.egg.image_of(uv), &back) == 0);
    CHECK(length(back - uv) < 0.01f);
  }
  Vec2 uv;
  CHECK(rig.surface->surface_at(rig.egg.cascade.object, rig.egg.state, {5, 5}, &uv) > 50);
}

TEST_CASE(
    "where a fold shows two layers to the camera, a place is of the nearer one, whichever comes first in the "
    "chart") {
  for (const float slope_mm : {80.0f, -80.0f}) {
    const auto across = [](float u) { return 100 * (u - 0.5f) + 40 * std::sin(6.2832f * u); };
    ShapedSurface s([&](float u, float v) {  // from above an S
      return Vec3{across(u), 100 * (0.5f - v), slope_mm * u};
    });
    int two_layers = 0;
    for (float u = 0.02f; u < 0.2f; u += 0.01f) {
      float other = 0.8f;  // the layer at the other end that is seen at the same place, if there is one
      for (float t = 0.8f; t < 1; t += 0.0005f)
        if (magnitude(across(t) - across(u)) < magnitude(across(other) - across(u))) other = t;
      if (magnitude(across(other) - across(u)) > 0.2f) continue;
      ++two_layers;
      Vec2 x, uv;
      const float nearer = slope_mm > 0 ? other : u;
      REQUIRE(s.project({nearer, 0.47f}, &x));
      CHECK(s.surface->surface_at(s.cascade.object, s.state, x, &uv) == 0);
      CHECK(magnitude(uv.x - nearer) < 0.01f);
    }
    CHECK(two_layers > 5);
  }
}

TEST_CASE("a place is of the layer that faces the camera, also where the back of a flap is nearer") {
  ShapedSurface s([](float u, float v) {
    return Vec3{120 * std::sin(3.1416f * u) - 60, 100 * (0.5f - v), 80 * u};
  });
  for (float u = 0.1f; u < 0.4f; u += 0.02f) {
    Vec2 x, uv;
    REQUIRE(s.project({u, 0.47f}, &x));
    CHECK(s.surface->surface_at(s.cascade.object, s.state, x, &uv) == 0);
    CHECK(magnitude(uv.x - u) < 0.01f);
  }
}

TEST_CASE("a surface of some metres is seen as a small one is") {
  std::size_t on_surface[2];
  for (const bool is_large : {false, true}) {
    // A wall that is turned by 52 degrees about an edge that is far from the camera.
    ModelBuilder b;
    const float size = is_large ? 6000.0f : 300.0f;
    b.record(Operation::constant, {}, {}, b.field(3, 9, 9, [&](float u, float v) {
      return Vec3{size * u, size * (0.5f - v), 0};
    }));
    b.parameter("p", Group::expression, -1, 1, 1);
    b.grid_mesh(8);
    b.landmark("p", 0.5f, 0.5f);
    const OpenModel built(b);
    const Model& model = built.model;
    InArena<Cascade> cascade(model);
    InArena<VisibleSurface> surface(model.parameters().count, VisibleSurfaceLimits{300, 0, 16, {}});
    const Camera camera = centred_camera(640, 480, 500);
    float q = 0;
    ModelState state;
    state.q = &q;
    state.view = view_of({exp_rotation({0, 0.9f, 0}), {-0.3f * size, 0, 1.6f * size}}, camera);
    REQUIRE(surface->start(model) == Status::ok);
    surface->adapt(cascade.object, state, {});
    Random random(3);
    on_surface[is_large] = 0;
    for (int k = 0; k < 200; ++k) {
      const Vec2 uv{random.uniform(0.05f, 0.95f), random.uniform(0.05f, 0.95f)};
      Vec2 x, back;
      REQUIRE(Projector(state.view, true).project(cascade->surface_point(uv, &q), &x));
      on_surface[is_large] += surface->surface_at(cascade.object, state, x, &back) == 0;
    }
  }
  CHECK(on_surface[0] == 200);
  CHECK(on_surface[1] == 200);
}

TEST_CASE("the contour has no points of the open boundary") {
  Rig rig(1.0f);
  const Span<const SilhouettePoint> contour = rig.surface->find_contour(rig.egg.state.view, 1);
  REQUIRE(contour.count > 0);
  for (const SilhouettePoint& p : contour) {
    CHECK_FALSE(p.is_border);
    CHECK(length(p.normal) == doctest::Approx(1).epsilon(1e-3));
  }
}

TEST_CASE("a finer tolerance gives a finer mesh, and operations follow the view within the budget") {
  Rig rig;
  MeshPolicy coarse, fine;
  coarse.error_mm = 5;
  fine.error_mm = 0.1f;
  std::size_t count[2];
  for (std::size_t is_fine : {0u, 1u}) {
    REQUIRE(rig.surface->start(rig.egg.model) == Status::ok);
    rig.surface->adapt(rig.egg.cascade.object, rig.egg.state, is_fine == 1 ? fine : coarse);
    count[is_fine] = static_cast<std::size_t>(rig.surface->mesh().vertex_count());
  }
  CHECK(count[1] > count[0] + 20);
  MeshPolicy follows;
  follows.following = &kMeshFollowing;
  follows.operations = 20;
  follows.vertex_budget = 150;
  follows.view.pose = pose_of(rig.egg.state.view);
  follows.view.focal_px = rig.egg.camera.f;
  follows.view.tolerance_px = 0.1f;
  REQUIRE(rig.surface->start(rig.egg.model) == Status::ok);
  rig.surface->adapt(rig.egg.cascade.object, rig.egg.state, follows);
  rig.update(0, 1);
  for (std::uint32_t frame = 1; frame < 80; ++frame) {
    rig.egg.pose({exp_rotation({0, 0.01f * float(frame), 0}), {0, 5, 700}});
    rig.surface->follow_view(rig.egg.cascade.object, rig.egg.state, frame);
    CHECK(rig.surface->mesh().vertex_count() <= 150);
  }
  CHECK(rig.surface->mesh().validate().invariant == 0);
}

TEST_CASE("a vertex that is welded and split again while samples are renewed has none of the person before") {
  for (std::uint32_t lead = 0; lead < 32; ++lead) {
    CAPTURE(lead);
    CHECK(count_old_vertices(lead) == 0);
  }
}

}  // namespace visible_surface_test
