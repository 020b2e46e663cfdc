// One step of alignment: towards the landmarks, and no farther than the projection is near to linear.
#include "face/face_shape.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "open_model.hpp"

namespace face_shape_test {

using namespace pliant;

namespace {

/// The egg's landmarks as an aligner sees them.
struct Rig : OpenedEgg {
  InArena<FaceShape> shape;
  Lens lens;
  View start;

  Rig() : OpenedEgg(3), shape(model, model.landmarks().count, AlignerUse::alignment) {
    const Camera camera = centred_camera(320, 240, 448);
    REQUIRE(Lens::make(camera, 320, 240, &lens) == Status::ok);
    start = view_of({{}, {0, 0, 700}}, camera);
    for (std::size_t k = 0; k < model.landmarks().count; ++k)
      shape->set_landmark(k, model.landmarks()[k].uv());
    shape->set_landmark_count(model.landmarks().count);
  }
  /// One step towards where `move` takes the landmarks' offsets from the middle of the image.
  template <class Move>
  const View& step(Move&& move) {
    shape->start(start, q.data(), nullptr, lens);
    shape->begin();
    for (std::size_t k = 0; k < shape->landmark_count(); ++k)
      shape->add(start.c + move(shape->evaluate(k).x - start.c), {1, 0, 1});
    shape->finish(100);
    CHECK(shape->is_usable());
    return shape->view();
  }
  float growth(float by) {
    return step([by](Vec2 d) { return by * d; }).s / start.s;
  }
  float roll(float degrees) {
    const float c = 1 - degrees * degrees / 6566, s = degrees / 57.29578f;  // near enough
    const View& v = step([=](Vec2 d) { return Vec2{c * d.x - s * d.y, s * d.x + c * d.y}; });
    return log_rotation(v.q * conjugate(start.q)).z * 57.29578f;
  }
};

}  // namespace

TEST_CASE("a step goes where the landmarks are, when that is near") {
  Rig rig;
  CHECK(rig.growth(1) == doctest::Approx(1).epsilon(1e-3));
  CHECK(rig.growth(1.1f) == doctest::Approx(1.1).epsilon(0.02));
  CHECK(rig.growth(0.9f) == doctest::Approx(0.9).epsilon(0.02));
  CHECK(rig.roll(10) == doctest::Approx(10).epsilon(0.05));
  CHECK(rig.roll(-10) == doctest::Approx(-10).epsilon(0.05));
  const View& v = rig.step([](Vec2 d) { return d + Vec2{6, -4}; });
  CHECK(v.s * v.tau.x == doctest::Approx(6).epsilon(0.05));
  CHECK(v.s * v.tau.y == doctest::Approx(-4).epsilon(0.05));
}

TEST_CASE("a step changes scale and turn no more than its limits, however far the landmarks are") {
  Rig rig;
  const FaceShapeTuning& t = kFaceShapeTuning;
  const double most = std::exp(double(t.max_log_step));
  CHECK(rig.growth(20) == doctest::Approx(most).epsilon(1e-3));
  CHECK(rig.growth(0.01f) == doctest::Approx(1 / most).epsilon(1e-3));
  CHECK(rig.roll(80) <= 57.3f * t.max_turn_rad);
  CHECK(rig.roll(80) > 50.0f * t.max_turn_rad);
}

TEST_CASE("landmarks behind the camera and parameters that are held take no part in a step") {
  Rig rig;
  std::vector<std::uint8_t> held(rig.q.size(), 0);
  rig.q[0] = 0.7f;
  rig.shape->start(rig.start, rig.q.data(), held.data(), rig.lens);
  rig.shape->begin();
  for (std::size_t k = 0; k < rig.shape->landmark_count(); ++k)
    rig.shape->add(rig.shape->evaluate(k).x + Vec2{5, 0}, {1, 0, 1});
  rig.shape->finish(1);
  CHECK(rig.shape->view().tau.x > rig.start.tau.x);
  for (std::size_t k = 0; k < rig.q.size(); ++k) CHECK(rig.shape->q()[k] == rig.q[k]);
  const View near = view_of({{}, {0, 0, 50}}, centred_camera(320, 240, 448));  // the nose is behind it
  rig.shape->start(near, rig.q.data(), nullptr, rig.lens);
  rig.shape->begin();
  std::size_t behind = 0;
  for (std::size_t k = 0; k < rig.shape->landmark_count(); ++k) {
    const float weight = rig.shape->evaluate(k).weight;
    behind += weight == 0;
    if (weight == 0) rig.shape->add({1e6f, 1e6f}, {1, 0, 1});
  }
  CHECK(behind > 0);
  Vec2 x;
  CHECK_FALSE(rig.shape->project({0.5f, 0.45f}, &x));
  CHECK(rig.shape->project({0.02f, 0.02f}, &x));
  rig.shape->finish(1);
  CHECK(length(log_rotation(rig.shape->view().q * conjugate(near.q))) < 1e-3f);
}

}  // namespace face_shape_test
