// What the camera sees of a surface that moves: the drawing of its depth, its contour and places; and a mesh that follows the view.
#include <doctest/doctest.h>

#include "random.hpp"
#include "surface_rig.hpp"

namespace surface_view_test {

using namespace pliant;
using Rig = EggSurface;

TEST_CASE("after a turn or a change of scale that shows, the drawing is that of the present view") {
  Rig rig;
  const auto view_at = [&rig](float turn, float distance_mm) {
    return view_of({exp_rotation({0, turn, 0}), {0, 5, distance_mm}}, rig.egg.camera);
  };
  std::uint32_t frame = 1;
  // Each is one of both away from the one before, and none of them from the first; all within the time of one drawing.
  for (const View& view : {view_at(0, 700), view_at(0.1f, 700), view_at(0.1f, 600), view_at(0.02f, 600)}) {
    Rig fresh;
    rig.surface->draw_depth(view, frame++);
    fresh.surface->draw_depth(view, 1);
    Random random(8);
    int differ = 0, hidden = 0;
    for (int k = 0; k < 2000; ++k) {
      const Vec2 at{random.uniform(200, 440), random.uniform(100, 380)};
      const Vec3 p{0, 0, random.uniform(-60, 60)};
      hidden += fresh.surface->hides(at, p);
      differ += rig.surface->hides(at, p) != fresh.surface->hides(at, p);
    }
    CHECK(hidden > 100);
    CHECK(differ == 0);
  }
}

TEST_CASE("a drawing that moves along with small shifts has moved by their sum") {
  Rig rig;
  View view = rig.egg.state.view;
  rig.surface->draw_depth(view, 1);
  const Projector projector(view, true);
  const Vec2 x = rig.egg.image_of({0.5f, 0.5f});
  const Vec3 behind =
      projector.rotated(rig.egg.cascade->surface_point({0.5f, 0.5f}, rig.egg.state.q)) + Vec3{0, 0, 30};
  for (int k = 1; k <= 2; ++k) {
    view.tau = view.tau + Vec2{200, 0};
    rig.surface->draw_depth(view, 2);
    const Vec2 moved = view.s * Vec2{200.0f * static_cast<float>(k), 0};
    CHECK(rig.surface->hides(x + moved, behind));
    CHECK_FALSE(rig.surface->hides(x + 1.5f * moved, behind));  // beside the egg, which is 150 mm wide
  }
}

TEST_CASE("a surface is not hidden by where it was, however fast it moves, and after a new start") {
  const std::uint32_t kNewStart = 0;
  for (const std::uint32_t frames : {kNewStart, 1u, 100u}) {
    CAPTURE(frames);
    Rig rig;
    rig.surface->draw_depth(rig.egg.state.view, 0);
    for (std::uint32_t frame = 1; frame <= frames; ++frame) {
      rig.egg.q[5] = 0.5f * static_cast<float>(frame) / static_cast<float>(frames);
      rig.update(frame, 4);
      rig.surface->draw_depth(rig.egg.state.view, frame);
    }
    if (frames == kNewStart) {
      rig.egg.q[5] = 0.5f;
      rig.surface->adapt(rig.egg.cascade.object, rig.egg.state, {});
      rig.surface->draw_depth(rig.egg.state.view, 0);
    }
    const Projector projector(rig.egg.state.view, true);
    int hidden = 0, judged = 0;
    for (float u = 0.3f; u < 0.71f; u += 0.05f)
      for (float v = 0.3f; v < 0.81f; v += 0.05f) {
        const Vec3 p = projector.rotated(rig.egg.cascade->surface_point({u, v}, rig.egg.state.q));
        const Vec2 x = rig.egg.image_of({u, v});
        hidden += rig.surface->hides(x, p);
        judged += !rig.surface->hides(x, p + Vec3{0, 0, 30});
      }
    CHECK(hidden == 0);
    CHECK(judged == 0);
  }
}

TEST_CASE("the contour is that of the present view, also where the drawing is of one before it") {
  Rig rig(1.0f), fresh(1.0f);
  rig.surface->draw_depth(rig.egg.state.view, 1);
  View shifted = rig.egg.state.view;  // by less than what the depth is drawn again for
  shifted.q = exp_rotation({0, 0.02f, 0}) * shifted.q;
  shifted.tau = shifted.tau + Vec2{15, 0};
  rig.surface->invalidate_images();
  fresh.surface->turn_to(shifted);
  const Span<const SilhouettePoint> contour = rig.surface->find_contour(shifted, 2),
                                    expected = fresh.surface->find_contour(shifted, 2);
  REQUIRE(contour.count > 10);
  CHECK(contour.count == expected.count);
  for (const SilhouettePoint& p : contour) {
    float nearest = 1e9f;
    for (const SilhouettePoint& e : expected) nearest = min(nearest, length(p.x - e.x));
    CHECK(nearest < 0.01f);
  }
}

TEST_CASE("a mesh that follows the view has all its vertices on the surface, with samples and without") {
  for (const bool keeps_samples : {true, false}) {
    Rig rig(0, keeps_samples);
    const MeshPolicy follows = following(rig.egg.state.view, rig.egg.camera, 0.005f);
    REQUIRE(rig.surface->start(rig.egg.model) == Status::ok);
    rig.egg.pose({{}, {0, 5, 7000}});
    rig.surface->adapt(rig.egg.cascade.object, rig.egg.state, follows);
    const int coarse = rig.surface->mesh().vertex_count();
    rig.egg.pose({{}, {0, 5, 300}});
    for (std::uint32_t frame = 1; frame < 64; ++frame) {
      rig.surface->follow_view(rig.egg.cascade.object, rig.egg.state, frame);
      CHECK(rig.exact_count() == rig.surface->mesh().vertex_count());
    }
    CHECK(rig.surface->mesh().vertex_count() > coarse + 20);
  }
}

TEST_CASE("a mesh follows the surface of the person who has changed: one whose surface is bent needs more") {
  ModelBuilder b;
  const auto bend = [](float u, float v) { return Vec3{0, 0, 60 * u * (1 - u) * v * (1 - v)}; };
  b.record(Operation::constant, {}, {}, b.field(3, 2, 2, [](float u, float v) {
    return Vec3{100 * u - 50, 50 - 100 * v, 0};
  }));
  const std::uint16_t p = b.parameter("bend", Group::identity, 0, 3, 1);
  b.record(Operation::add_vector, {b.last()}, {p}, b.field(3, 33, 33, bend));
  b.grid_mesh(4);
  b.landmark("p", 0.5f, 0.5f);
  const OpenModel built(b);
  InArena<Cascade> cascade(built.model);
  InArena<VisibleSurface> surface(std::size_t{1}, VisibleSurfaceLimits{300, 0, 16, {}});
  float q = 0;
  ModelState state;
  state.q = &q;
  const Camera camera = centred_camera(640, 480, 800);
  state.view = view_of({exp_rotation({0, 0.8f, 0}), {0, 0, 300}}, camera);
  const MeshPolicy follows = following(state.view, camera, 0.02f);
  REQUIRE(surface->start(built.model) == Status::ok);
  surface->adapt(cascade.object, state, follows);
  const int flat = surface->mesh().vertex_count();
  const auto follow = [&](std::uint32_t frame) {
    for (const std::uint32_t end = frame + 64; frame < end; ++frame)
      surface->follow_view(cascade.object, state, frame);
    return surface->mesh().vertex_count();
  };
  CHECK(follow(1) == flat);
  q = 3;
  surface->revise(state.q, {});
  CHECK(follow(100) > flat + 20);
  q = 0;
  surface->revise(state.q, {});
  CHECK(follow(200) == flat);
}

TEST_CASE("the image of a vertex behind the camera is the middle") {
  // A floor of 4 m, 100 mm below a camera that looks along it.
  ShapedSurface floor([](float u, float v) { return Vec3{4000 * (u - 0.5f), 0, 4000 * (v - 0.5f)}; });
  const View& view = floor.state.view = view_of({{}, {0, 100, 500}}, centred_camera(640, 480, 500));
  floor.surface->turn_to(view);
  const Projector projector(view, true);
  int behind = 0;
  for (VertexId v : floor.surface->mesh().vertices()) {
    Vec2 x;
    if (projector.project(floor.surface->positions()[v], &x)) continue;
    ++behind;
    CHECK(floor.surface->images()[v].x == view.c.x);
    CHECK(floor.surface->images()[v].y == view.c.y);
  }
  CHECK(behind > 20);
}

TEST_CASE(
    "beside an edge that bends inward a place of the flat mesh is not on the surface, and stays in the "
    "chart") {
  MeshPolicy stays;
  stays.error_mm = 0;
  // By 6 mm between two vertices, which are at 0 and 0.5.
  const auto narrower = [](float u) { return 96 * u * (0.5f - u); };
  ShapedSurface s(
      [&](float u, float v) {
        return Vec3{100 * (u - 0.5f), v * (narrower(u < 0.5f ? u : u - 0.5f) - 100), 0};
      },
      2, stays);
  REQUIRE(s.surface->mesh().vertex_count() == 9);
  Vec2 inside, edge, uv;
  REQUIRE(s.project({0.25f, 0.97f}, &inside));
  REQUIRE(s.project({0.25f, 1}, &edge));
  CHECK(s.surface->surface_at(s.cascade.object, s.state, inside, &uv) == 0);
  CHECK(length(uv - Vec2{0.25f, 0.97f}) < 0.001f);
  // 3 mm, as many px, from the edge, which is level there.
  const float off = s.surface->surface_at(s.cascade.object, s.state, edge + Vec2{0, 3}, &uv);
  CHECK(off == doctest::Approx(3).epsilon(0.02));
  CHECK(uv.y <= 1);
}

}  // namespace surface_view_test
