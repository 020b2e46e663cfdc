// The fit of a start: a sheet of paper, which has no identity, and a face.
#include "track/landmark_fit.hpp"

#include <doctest/doctest.h>

#include "baked_face.hpp"
#include "open_model.hpp"
#include "sheet_model.hpp"
#include "track/offset_landmarks.hpp"

namespace landmark_fit_test {

using namespace pliant;

namespace {

constexpr int kWidth = 640, kHeight = 480;

struct Paper : OpenModel {
  Camera camera = centred_camera(kWidth, kHeight, 600);
  Pose pose{exp_rotation({0.3f, 0.2f, 0.1f}), {0, 0, 250}};
  std::vector<float> q = {0.8f, 0, 0};  // rolled

  Paper() : OpenModel(sheet::sheet_model({})) {}
  Vec2 image(Vec2 uv) const {
    InArena<Cascade> cascade(model);
    Vec2 x;
    REQUIRE(Projector(view_of(pose, camera), true).project(cascade->surface_point(uv, q.data()), &x));
    return x;
  }
};

/// Landmarks of the face with another identity, at rest, a little turned.
struct PosedFace {
  BakedModel& face = baked_face();
  Camera camera = centred_camera(kWidth, kHeight, 900);
  std::vector<Correspondence> points;
  FitOptions options;

  PosedFace() {
    const Projector projector(view_of({exp_rotation({0.1f, 0.2f, 0}), {0, 0, 500}}, camera), true);
    auto person = face.rest();
    const auto parameters = face.model.parameters();
    for (std::size_t k = 0; k < parameters.count; ++k)
      if (parameters[k].group == Group::identity) person[k] = k % 2 == 0 ? 1.0f : -1.0f;
    for (int k = 17; k < 68; ++k) {
      const std::string name = "ibug" + std::to_string(k);
      Vec2 x;
      REQUIRE(projector.project(face.at(name, person), &x));
      points.push_back({face.uv(name), x});
    }
    options.width = kWidth;
    options.height = kHeight;
    options.focal_px = camera.f;
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

TEST_CASE("a person at rest is given an identity rather than an expression") {
  const PosedFace posed;
  BakedModel& face = posed.face;
  const auto parameters = face.model.parameters();
  // Sum of the squares of the expressions, in standard deviations.
  const auto expression = [&](const std::uint8_t* is_free) {
    InArena<LandmarkFit> fit(face.model, posed.points.size());
    FitOptions options = posed.options;
    options.is_free = is_free;
    std::vector<Correspondence> own = posed.points;
    auto q = face.rest();
    REQUIRE(fit->fit({own.data(), own.size()}, options, q.data()) == Status::ok);
    CHECK(fit->report().rms_px < 1);
    float sum = 0;
    for (std::size_t k = 0; k < parameters.count; ++k)
      if (parameters[k].group == Group::expression)
        sum += q[k] * q[k] / (parameters[k].sd * parameters[k].sd);
    return sum;
  };
  const std::vector<std::uint8_t> all_at_once(parameters.count, 1);
  CHECK(expression(nullptr) < 0.7f * expression(all_at_once.data()));
}

TEST_CASE("samples of the base mesh do not change the fit") {
  const PosedFace posed;
  const auto fitted = [&](bool samples_base_mesh) {
    InArena<LandmarkFit> fit(posed.face.model, posed.points.size(), samples_base_mesh);
    std::vector<Correspondence> own = posed.points;
    auto q = posed.face.rest();
    REQUIRE(fit->fit({own.data(), own.size()}, posed.options, q.data()) == Status::ok);
    return q;
  };
  CHECK(fitted(false) == fitted(true));
}

TEST_CASE("the landmarks of jaw and cheeks, ibug00 to ibug16, lie on the silhouette, and no others") {
  for (int k = 0; k < 68; ++k) {
    const std::string name = (k < 10 ? "ibug0" : "ibug") + std::to_string(k);
    CAPTURE(name);
    CHECK(is_silhouette_landmark(name.c_str()) == (k <= 16));
  }
  for (const char* name : {"", "ibug", "ibug0", "ibug1", "ibug1x", "ibug0x", "ibug011", "nose_tip", "xbug03"})
    CHECK_FALSE(is_silhouette_landmark(name));
}

TEST_CASE("the degrees of freedom that a fit has used do not depend on how far the model may be off") {
  PosedFace scene;
  InArena<LandmarkFit> fit(scene.face.model, scene.points.size());
  const auto taken = [&](float misfit_mm) {
    scene.options.misfit_mm = misfit_mm;
    auto q = scene.face.rest();
    REQUIRE(fit->fit({scene.points.data(), scene.points.size()}, scene.options, q.data()) == Status::ok);
    return double(coordinates_taken(scene.face.model, fit->sd()));
  };
  const double exact = taken(0);
  CHECK(exact > 2 * kPoseUnknowns);
  CHECK(taken(3) == doctest::Approx(exact).epsilon(0.02));
}

}  // namespace landmark_fit_test
