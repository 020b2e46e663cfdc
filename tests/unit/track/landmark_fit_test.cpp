// The fit of a start, on a model that has no identity: a sheet of paper.
#include "track/landmark_fit.hpp"

#include <doctest/doctest.h>

#include "sheet_model.hpp"

using namespace pliant;

namespace {

constexpr int kWidth = 640, kHeight = 480;

struct Paper {
  std::vector<std::uint32_t> words = sheet::sheet_model({}).table();
  Model model;
  Camera camera = centred_camera(kWidth, kHeight, 600);
  Pose pose{exp_rotation({0.3f, 0.2f, 0.1f}), {0, 0, 250}};
  std::vector<float> q = {0.8f, 0, 0};  // rolled

  Paper() { REQUIRE(Model::open(words.data(), 4 * words.size(), &model) == Status::ok); }
  Vec2 image(Vec2 uv) const {
    InArena<Cascade> cascade(model);
    Vec2 x;
    REQUIRE(Projector(view_of(pose, camera), true).project(cascade->surface_point(uv, q.data()), &x));
    return x;
  }
};

}  // namespace

TEST_CASE("nine points of a bent sheet give its bend: no prior meant for faces holds it back") {
  const Paper paper;
  std::vector<Correspondence> points;
  for (int k = 0; k < 9; ++k) {
    const Vec2 uv{0.05f + 0.45f * static_cast<float>(k % 3), 0.05f + 0.45f * static_cast<float>(k / 3)};
    points.push_back({uv, paper.image(uv)});
  }
  InArena<LandmarkFit> fit(paper.model, points.size());
  FitOptions options;
  options.width = kWidth;
  options.height = kHeight;
  options.focal_px = paper.camera.f;
  std::vector<float> q(3, 0.0f);
  REQUIRE(fit->fit({points.data(), points.size()}, options, q.data()) == Status::ok);
  MESSAGE("roll ", q[0], ", bowl ", q[1], ", wide ", q[2], ", rms ", fit->report().rms_px, " px");
  CHECK(magnitude(q[0] - paper.q[0]) < 0.1f * paper.q[0]);
  CHECK(fit->report().rms_px < 0.5f);
}
