#pragma once
// Visible surfaces in front of a camera: of an egg, and of any shape.
#include <doctest/doctest.h>

#include "estimate/visible_surface.hpp"
#include "model_builder.hpp"
#include "posed_egg.hpp"

/// A mesh that follows the view, by as many operations as it needs.
inline pliant::MeshPolicy following(const pliant::View& view, const pliant::Camera& camera,
                                    float tolerance_px) {
  pliant::MeshPolicy policy;
  policy.following = &pliant::kMeshFollowing;
  policy.operations = 100;
  policy.view = {pliant::pose_of(view), camera.f, camera.cx, camera.cy, 640, 480};
  policy.view.tolerance_px = tolerance_px;
  return policy;
}

/// The visible surface of an egg.
struct EggSurface {
  PosedEgg egg;
  InArena<pliant::VisibleSurface> surface;

  explicit EggSurface(float turn = 0, bool keeps_samples = true)
      : egg(turn),
        surface(egg.parameters(),
                pliant::VisibleSurfaceLimits{300, keeps_samples ? egg.samples() : std::size_t{0}, 16, {}}) {
    REQUIRE(surface->start(egg.model) == pliant::Status::ok);
    surface->adapt(egg.cascade.object, egg.state, {});
    update(0, 1);
  }
  void update(std::uint32_t frame, std::uint32_t interval) {
    surface->update(egg.cascade.object, egg.state, frame, interval, interval <= 1);
  }
  /// Vertices that lie where the surface is.
  std::size_t exact_count() {
    std::size_t n = 0;
    for (pliant::VertexId v : surface->mesh().vertices())
      n += length(surface->positions()[v] - egg.cascade->surface_point(surface->mesh().uv(v), egg.state.q)) <
           0.05f;
    return n;
  }
};

/// The surface p(u,v) of a shape, with one parameter that has no effect, seen from 2 m.
struct ShapedSurface {
  OpenModel built;
  InArena<pliant::Cascade> cascade;
  InArena<pliant::VisibleSurface> surface;
  float q = 0;
  pliant::ModelState state;

  template <class Shape>
  explicit ShapedSurface(const Shape& shape, int grid = 16, const pliant::MeshPolicy& policy = {})
      : built(model_of(shape, grid)),
        cascade(built.model),
        surface(built.model.parameters().count, pliant::VisibleSurfaceLimits{1000, 0, 16, {}}) {
    state.q = &q;
    state.view = pliant::view_of({{}, {0, 0, 2000}}, pliant::centred_camera(640, 480, 2000));
    REQUIRE(surface->start(built.model) == pliant::Status::ok);
    surface->adapt(cascade.object, state, policy);
  }
  template <class Shape>
  static ModelBuilder model_of(const Shape& shape, int grid) {
    ModelBuilder b;
    b.record(pliant::Operation::constant, {}, {}, b.field(3, 65, 9, shape));
    b.parameter("p", pliant::Group::expression, -1, 1, 1);
    b.grid_mesh(grid);
    b.landmark("p", 0.5f, 0.5f);
    return b;
  }
  bool project(pliant::Vec2 uv, pliant::Vec2* x) {
    return pliant::Projector(state.view, true).project(cascade->surface_point(uv, &q), x);
  }
};
