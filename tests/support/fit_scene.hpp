#pragma once
// What tests of the fit start from.
#include <doctest/doctest.h>

#include "open_model.hpp"
#include "pliant/fit.hpp"
#include "random.hpp"

namespace fit_scene {

using namespace pliant;

/// An egg with random parameters at a random pose, and its landmarks' image positions with noise.
struct FitScene : OpenModel {
  std::vector<float> truth;
  View view;
  std::vector<Correspondence> points;

  explicit FitScene(std::uint64_t seed, float noise_px = 0, float turn = 0.5f) : OpenModel(egg_model(6)) {
    Random random(seed);
    for (const Parameter& p : model.parameters())
      truth.push_back(clamp(p.sd * random.normal(), p.minimum, p.maximum));
    view = view_of({exp_rotation({random.uniform(-turn, turn), random.uniform(-turn, turn),
                                  random.uniform(-turn, turn)}),
                    {random.uniform(-60, 60), random.uniform(-40, 40), random.uniform(500, 1200)}},
                   centred_camera(640, 480, 900));
    InArena<Cascade> cascade(model);
    for (const Landmark& l : model.landmarks()) {
      Vec2 x;
      REQUIRE(Projector(view, true).project(cascade->surface_point(l.uv(), truth.data()), &x));
      points.push_back(
          {l.uv(), x + Vec2{noise_px * random.normal(), noise_px * random.normal()}, max(noise_px, 0.1f)});
    }
  }
  Span<const Correspondence> all() const { return {points.data(), points.size()}; }
  FitOptions options(float focal) const {
    FitOptions o;
    o.width = 640;
    o.height = 480;
    o.focal_px = focal;
    return o;
  }
  float turn_error(const View& v) const { return length(log_rotation(v.q * conjugate(view.q))); }
};

}  // namespace fit_scene

using fit_scene::FitScene;
